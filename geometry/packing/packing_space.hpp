// The space in which blocks are placed: a region with holes, obstacles, and the blocks so far. A
// block is taken only where it keeps its distance from all of them.
#pragma once

#include <vector>

#include "apothem/geometry/polygon/polygon.hpp"

namespace apothem {

class PackingSpace {
 public:
  /// Blocks stay inside the outline and outside the holes, and at least `gap` (m) away from each
  /// other and from everything else; in any case 1e-9 of `size` (m), the size of a typical block,
  /// so that the rounding of coordinates cannot make them overlap.
  PackingSpace(const Polygon& outline, const std::vector<Polygon>& holes, double gap, double size);

  /// Keeps blocks away from a simple ring and from all that is inside it.
  void add_obstacle(const std::vector<Vec2>& ring);
  /// True if a block may lie there. The block of number `except` is not in the way.
  [[nodiscard]] bool is_free(const std::vector<Vec2>& ring, int except = -1) const;
  /// The same, but the border of the region does not count.
  [[nodiscard]] bool is_clear(const std::vector<Vec2>& ring, int except = -1) const;
  /// Puts a block there, which must be free. Blocks are numbered from 0.
  void add(std::vector<Vec2> ring);
  /// Moves a block to where it may lie.
  void move(int block, std::vector<Vec2> ring);
  /// Takes all blocks out.
  void clear();

  [[nodiscard]] const Box& box() const { return box_; }
  /// Of the region without its holes, m^2.
  [[nodiscard]] double area() const { return area_; }
  /// What is kept between two blocks, m.
  [[nodiscard]] double clearance() const { return clearance_; }
  [[nodiscard]] const std::vector<Vec2>& block(int i) const { return rings_[fixed_ + i]; }

 private:
  struct Cells {
    int x0, x1, y0, y1;
    bool operator==(const Cells&) const = default;
  };
  [[nodiscard]] bool keeps_off_border(const std::vector<Vec2>& ring, const Box& box) const;
  void enter(size_t solid);
  void leave(size_t solid);
  /// The cells of the grid that a box touches.
  [[nodiscard]] Cells cells_of(const Box& box) const;
  template <class F>
  void each_cell(const Cells& cells, F&& f) const;

  std::vector<Vec2> outline_;
  Box box_;
  double area_, clearance_, cell_;
  int columns_, rows_;
  // Of holes and obstacles, then of blocks.
  std::vector<std::vector<Vec2>> rings_;
  std::vector<Box> boxes_;
  size_t fixed_ = 0;  // number of holes and obstacles
  std::vector<std::vector<size_t>> cells_;
  mutable std::vector<size_t> seen_;  // by which question each solid was looked at last
  mutable size_t question_ = 0;
};

}  // namespace apothem
