#include "geometry/packing/packing_space.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/polygon/cyclic.hpp"
#include "geometry/polygon/predicates.hpp"
#include "geometry/polygon/segment.hpp"
#include "geometry/spatial/boxes.hpp"

namespace apothem {
namespace {

constexpr double kLeastClearance = 1e-9;  // of the size of a block
constexpr double kMostCells = 4e6;

double square_distance(const Vec2& point, const Vec2& a, const Vec2& b) {
  return nearest_on_segment(point - a, b - a).distance2;
}

// Rounding may hide a crossing only where an end lies on the other segment, and then that end is
// nearer than any clearance.
bool nearer(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d, double distance) {
  const Vec2 ab = b - a, cd = d - c;
  const bool crosses_ab = (cross(ab, Vec2(c - a)) > 0) != (cross(ab, Vec2(d - a)) > 0);
  const bool crosses_cd = (cross(cd, Vec2(a - c)) > 0) != (cross(cd, Vec2(b - c)) > 0);
  if (crosses_ab && crosses_cd) return true;
  const double least = std::min({square_distance(a, c, d), square_distance(b, c, d),
                                 square_distance(c, a, b), square_distance(d, a, b)});
  return least < distance * distance;
}

bool borders_nearer(std::span<const Vec2> a, const Box& box_a, std::span<const Vec2> b,
                    double distance) {
  const Box reach = box_a.grown(distance);
  for (size_t j = 0; j < b.size(); ++j) {
    const Vec2& from = b[j];
    const Vec2& to = after(b, j);
    const Box edge = box_of(from, to);
    if (apart(edge, reach)) continue;
    const Box near = edge.grown(distance);
    for (size_t i = 0; i < a.size(); ++i) {
      const Vec2& p = a[i];
      const Vec2& q = after(a, i);
      if (!apart(near, box_of(p, q)) && nearer(p, q, from, to, distance)) return true;
    }
  }
  return false;
}

enum class Between { nothing, line, strip };

// What separates a convex ring from another ring and is parallel to one of its edges: a strip wider
// than `distance`, or at least a line.
Between edge_between(std::span<const Vec2> convex, std::span<const Vec2> other, double distance) {
  Between found = Between::nothing;
  for (size_t i = 0; i < convex.size(); ++i) {
    const Vec2& p = convex[i];
    const Vec2 edge = after(convex, i) - p;
    double least = std::numeric_limits<double>::infinity();
    for (const Vec2& v : other) {
      least = std::min(least, cross(Vec2(v - p), edge));
      if (least <= 0) break;
    }
    if (least <= 0) continue;
    if (least * least > distance * distance * edge.squaredNorm()) return Between::strip;
    found = Between::line;
  }
  return found;
}

}  // namespace

PackingSpace::PackingSpace(const Polygon& outline, const std::vector<Polygon>& holes, double gap,
                           double size)
    : outline_(outline.vertices()),
      box_(bounding_box(outline)),
      area_(area_moments(outline).area),
      clearance_(std::max(gap, kLeastClearance * size)) {
  const double width = box_.x1 - box_.x0, height = box_.y1 - box_.y0;
  cell_ = std::max(size, std::sqrt(width * height / kMostCells));
  columns_ = static_cast<int>(std::ceil(width / cell_)) + 1;
  rows_ = static_cast<int>(std::ceil(height / cell_)) + 1;
  cells_.resize(static_cast<size_t>(columns_) * static_cast<size_t>(rows_));
  for (const Polygon& hole : holes) {
    add_obstacle(hole.vertices());
    area_ -= area_moments(hole).area;
  }
}

PackingSpace::Cells PackingSpace::cells_of(const Box& box) const {
  const auto index = [&](double x, double from, int count) {
    return static_cast<int>(std::clamp((x - from) / cell_, 0., count - 1.));
  };
  return {index(box.x0, box_.x0, columns_), index(box.x1, box_.x0, columns_),
          index(box.y0, box_.y0, rows_), index(box.y1, box_.y0, rows_)};
}

template <class F>
void PackingSpace::each_cell(const Cells& cells, F&& f) const {
  for (int y = cells.y0; y <= cells.y1; ++y) {
    for (int x = cells.x0; x <= cells.x1; ++x) {
      f(static_cast<size_t>(y) * static_cast<size_t>(columns_) + x);
    }
  }
}

void PackingSpace::enter(int solid) {
  each_cell(cells_of(boxes_[solid]), [&](size_t cell) { cells_[cell].push_back(solid); });
}

void PackingSpace::leave(int solid) {
  each_cell(cells_of(boxes_[solid]), [&](size_t cell) { std::erase(cells_[cell], solid); });
}

void PackingSpace::add_obstacle(const PolygonWithHoles& polygon) {
  const Box box = box_of(polygon.outer);
  if (apart(box, box_.grown(clearance_))) return;
  add(polygon.outer, polygon.holes);
  ++fixed_;
}

void PackingSpace::add(std::span<const Vec2> ring, const Rings& holes) {
  points_.insert(points_.end(), ring.begin(), ring.end());
  first_.push_back(points_.size());
  boxes_.push_back(box_of(ring));
  convex_.push_back(smallest_turn(ring) >= 0);
  in_the_way_.push_back(-1);
  seen_.push_back(0);
  enter(static_cast<int>(boxes_.size()) - 1);
  if (holes.empty()) return;
  convex_.back() = 0;
  hollows_.resize(boxes_.size());
  hollows_.back() = holes;
}

void PackingSpace::move(int block, std::span<const Vec2> ring) {
  const int i = fixed_ + block;
  const Box box = box_of(ring);
  const bool same_cells = cells_of(box) == cells_of(boxes_[i]);
  if (!same_cells) leave(i);
  boxes_[i] = box;
  std::ranges::copy(ring, points_.begin() + static_cast<std::ptrdiff_t>(first_[i]));
  if (!same_cells) enter(i);
}

void PackingSpace::clear() {
  for (int i = fixed_; i < static_cast<int>(boxes_.size()); ++i) leave(i);
  boxes_.resize(fixed_);
  convex_.resize(fixed_);
  in_the_way_.resize(fixed_);
  seen_.resize(fixed_);
  first_.resize(fixed_ + 1);
  points_.resize(first_.back());
  hollows_.resize(std::min(hollows_.size(), boxes_.size()));
}

bool PackingSpace::keeps_off_border(std::span<const Vec2> ring, const Box& box) const {
  if (!contains(box_, box) || borders_nearer(ring, box, outline_, clearance_)) return false;
  return strictly_inside(outline_, ring.front());
}

bool PackingSpace::is_free(std::span<const Vec2> ring, int except) const {
  const Box box = box_of(ring);
  return contains(box_, box) && is_clear(ring, except) && keeps_off_border(ring, box);
}

// Whether a ring, whose box may meet that of a solid, keeps its distance from it.
bool PackingSpace::keeps_off(std::span<const Vec2> ring, const Box& box, bool convex,
                             int solid) const {
  const std::span<const Vec2> other = this->ring(solid);
  if (convex) {
    const Between there = edge_between(ring, other, clearance_);
    if (there == Between::strip) return true;
    if (convex_[solid] != 0) {
      const Between here = edge_between(other, ring, clearance_);
      if (here == Between::strip) return true;
      // Two convex rings without a line between them that is parallel to an edge overlap.
      if (there == Between::nothing && here == Between::nothing) return false;
    }
  }
  if (borders_nearer(ring, box, other, clearance_)) return false;
  if (contains(boxes_[solid], box) && strictly_inside(other, ring.front())) {
    const auto i = static_cast<size_t>(solid);
    return i < hollows_.size() && keeps_off_holes(ring, box, hollows_[i]);
  }
  return !(contains(box, boxes_[solid]) && strictly_inside(ring, other.front()));
}

// Whether a ring inside the outer ring of a solid lies in one of its holes.
bool PackingSpace::keeps_off_holes(std::span<const Vec2> ring, const Box& box,
                                   const Rings& holes) const {
  return std::ranges::any_of(holes, [&](const std::vector<Vec2>& hole) {
    return strictly_inside(hole, ring.front()) && !borders_nearer(ring, box, hole, clearance_);
  });
}

bool PackingSpace::is_clear(std::span<const Vec2> ring, int except) const {
  const Box box = box_of(ring);
  const Box reach = box.grown(clearance_);
  const int own = except < 0 ? -1 : fixed_ + except;
  const bool convex = own < 0 ? smallest_turn(ring) >= 0 : convex_[own] != 0;
  // What was in the way of a block is likely to be there again.
  if (own >= 0 && in_the_way_[own] >= 0) {
    const int last = in_the_way_[own];
    if (!apart(reach, boxes_[last]) && !keeps_off(ring, box, convex, last)) return false;
  }
  ++question_;
  bool clear = true;
  each_cell(cells_of(reach), [&](size_t cell) {
    if (!clear) return;
    for (const int i : cells_[cell]) {
      if (i == own || apart(reach, boxes_[i]) || seen_[i] == question_) continue;
      seen_[i] = question_;
      if (keeps_off(ring, box, convex, i)) continue;
      clear = false;
      if (own >= 0) in_the_way_[own] = i;
      return;
    }
  });
  return clear;
}

}  // namespace apothem
