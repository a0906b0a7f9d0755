// The space in which blocks are placed: a region with holes, obstacles, and the blocks so far. A
// block is taken only where it keeps its distance from all of them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/polygon/polygon.hpp"

namespace apothem {

class PackingSpace {
 public:
  /// Blocks stay inside the outline and outside the holes, and at least `gap` (m) away from each
  /// other and from everything else; in any case 1e-9 of `size` (m), the size of a typical block,
  /// so that the rounding of coordinates cannot make them overlap.
  PackingSpace(const Polygon& outline, const std::vector<Polygon>& holes, double gap, double size);

  /// Keeps blocks away from a simple ring and from all that is inside it.
  void add_obstacle(const std::vector<Vec2>& ring) { add_obstacle(PolygonWithHoles{ring, {}}); }
  /// Keeps blocks away from a polygon. They may lie in its holes.
  void add_obstacle(const PolygonWithHoles& polygon);
  /// True if a block may lie there. The block of number `except` is not in the way.
  [[nodiscard]] bool is_free(std::span<const Vec2> ring, int except = -1) const;
  /// The same, but the border of the region does not count.
  [[nodiscard]] bool is_clear(std::span<const Vec2> ring, int except = -1) const;
  /// Puts a block there, which must be free. Blocks are numbered from 0. Later ones may lie in its
  /// holes.
  void add(std::span<const Vec2> ring, const Rings& holes = {});
  /// Moves a block without holes to where it may lie. The ring has as many vertices as it had.
  void move(int block, std::span<const Vec2> ring);
  /// Takes all blocks out.
  void clear();

  [[nodiscard]] const Box& box() const { return box_; }
  /// Of the region without its holes, m^2.
  [[nodiscard]] double area() const { return area_; }
  /// What is kept between two blocks, m.
  [[nodiscard]] double clearance() const { return clearance_; }
  [[nodiscard]] std::span<const Vec2> block(int i) const { return ring(fixed_ + i); }

 private:
  struct Cells {
    int x0, x1, y0, y1;
    bool operator==(const Cells&) const = default;
  };
  [[nodiscard]] bool keeps_off_border(std::span<const Vec2> ring, const Box& box) const;
  [[nodiscard]] bool keeps_off(std::span<const Vec2> ring, const Box& box, bool convex,
                               int solid) const;
  [[nodiscard]] bool keeps_off_holes(std::span<const Vec2> ring, const Box& box,
                                     const Rings& holes) const;
  [[nodiscard]] std::span<const Vec2> ring(int solid) const {
    return {points_.data() + first_[solid], points_.data() + first_[solid + 1]};
  }
  void enter(int solid);
  void leave(int solid);
  /// The cells of the grid that a box touches.
  [[nodiscard]] Cells cells_of(const Box& box) const;
  template <class F>
  void each_cell(const Cells& cells, F&& f) const;

  std::vector<Vec2> outline_;
  Box box_;
  double area_, clearance_, cell_;
  int columns_, rows_;
  // Of holes and obstacles, then of blocks.
  std::vector<Vec2> points_;      // vertices of all rings, one ring behind the other
  std::vector<size_t> first_{0};  // per ring its first vertex, and the number of all
  std::vector<Box> boxes_;
  std::vector<char> convex_;
  int fixed_ = 0;               // number of holes and obstacles
  std::vector<Rings> hollows_;  // holes of obstacles and blocks, up to the last that has any
  std::vector<std::vector<int>> cells_;
  mutable std::vector<int> in_the_way_;      // per solid: what has been in its way last, or -1
  mutable std::vector<std::uint64_t> seen_;  // by which question each solid was looked at last
  mutable std::uint64_t question_ = 0;
};

}  // namespace apothem
