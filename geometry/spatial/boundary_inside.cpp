#include "geometry/spatial/boundary_inside.hpp"

#include <CGAL/Exact_rational.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "geometry/spatial/ring_tree.hpp"

namespace apothem {
namespace {

// (q - p) x (v - p), with the right sign, 0 only if v lies on the line through p and q, and few
// wrong digits.
double side(const Vec2& p, const Vec2& q, const Vec2& v) {
  const Vec2 e = q - p;
  const Vec2 d = v - p;
  const double left = e.x() * d.y();
  const double right = e.y() * d.x();
  const double value = left - right;
  if (std::abs(value) > 0x1p-8 * (std::abs(left) + std::abs(right))) return value;
  using Rational = CGAL::Exact_rational;
  const Rational px(p.x());
  const Rational py(p.y());
  return CGAL::to_double(Rational((Rational(q.x()) - px) * (Rational(v.y()) - py) -
                                  (Rational(q.y()) - py) * (Rational(v.x()) - px)));
}

// Of a polygon's size: more than the round-off of a place on a line.
constexpr double kSlack = 1e-9;

// Which of the two sides of an edge is asked about.
enum class Side { inner, outer };

// A polygon that lines cut. A line runs immediately beside an edge of the other polygon: on its
// inner side, which is the left one, vertices on the line through the edge count as points on its
// right; on its outer side they count as points on its left.
class CutPolygon {
 public:
  explicit CutPolygon(const Polygon& polygon) : polygon_(polygon), box_(bounding_box(polygon)) {
    for (std::vector<Vec2>& ring : rings_of(polygon)) trees_.emplace_back(std::move(ring));
  }

  // A place on the line: the foot of the perpendicular from a vertex that is near, and the rest of
  // the way. So the distance of two places has few wrong digits however small it is.
  struct Place {
    double along;
    const Vec2* near;
    double rest;
  };
  struct Part {
    Place from, to;
    [[nodiscard]] double length(const Vec2& direction) const {
      return std::max(0.0, direction.dot(*to.near - *from.near) + (to.rest - from.rest));
    }
  };

  // The parts of the segment pq that have points of the polygon immediately on one side, in their
  // order, in memory that the next call uses again.
  const std::vector<Part>& parts(const Vec2& p, const Vec2& q, Side side_of_edge) {
    parts_.clear();
    if (apart(box_of(p, q), box_)) return parts_;
    crossings_.clear();
    const Vec2 direction = (q - p).normalized();
    const Place from = at(direction, p, 0);
    const Place to = at(direction, q, 0);
    for (int k = 0; k < polygon_.rings(); ++k) {
      cross_ring(p, q, side_of_edge, polygon_.ring(k), trees_[static_cast<size_t>(k)]);
    }
    // Those behind q are left out; one of them ends the last part.
    if (crossings_.size() % 2 != 0) {
      crossings_.push_back({std::numeric_limits<double>::infinity(), &q, 0});
    }
    std::sort(crossings_.begin(), crossings_.end(), before);
    for (size_t i = 0; i + 1 < crossings_.size(); i += 2) {
      const Place& first = std::max(crossings_[i], from, before);
      const Place& last = std::min(crossings_[i + 1], to, before);
      if (first.along <= last.along) parts_.push_back({first, last});
    }
    return parts_;
  }

  static bool before(const Place& x, const Place& y) { return x.along < y.along; }

 private:
  [[nodiscard]] Place at(const Vec2& direction, const Vec2& near, double rest) const {
    return {direction.dot(near - polygon_[0]) + rest, &near, rest};
  }

  // Adds the crossings of the line through p and q with a ring, up to q. Of those far before p only
  // their number counts, and it is even or odd as that of one line from the start of a run of edges
  // to its end.
  void cross_ring(const Vec2& p, const Vec2& q, Side side_of_edge, std::span<const Vec2> ring,
                  const RingTree& tree) {
    const Vec2 e = q - p, direction = e.normalized();
    const bool inner = side_of_edge == Side::inner;
    const auto left = [&](double value) { return inner ? value > 0 : value >= 0; };
    // A box is on one side of the line if the corners are that are farthest to the left and right.
    const double slack = kSlack * box_.extent();
    const auto judge = [&](const Box& box) {
      const Vec2 farthest(e.x() > 0 ? box.x1 : box.x0, e.y() > 0 ? box.y1 : box.y0);
      const Vec2 nearest(e.x() > 0 ? box.x0 : box.x1, e.y() > 0 ? box.y0 : box.y1);
      if (direction.dot(nearest - q) > slack) return RunUse::none;
      const Vec2 leftmost(e.y() > 0 ? box.x0 : box.x1, e.x() > 0 ? box.y1 : box.y0);
      const Vec2 rightmost(e.y() > 0 ? box.x1 : box.x0, e.x() > 0 ? box.y0 : box.y1);
      if (!left(side(p, q, leftmost)) || left(side(p, q, rightmost))) return RunUse::none;
      return direction.dot(farthest - p) < -slack ? RunUse::whole : RunUse::edges;
    };
    size_t last = ring.size();  // the vertex at the end of the line before
    double side_b = 0;
    tree.each_line(judge, [&](size_t i, size_t k) {
      const Vec2 &a = ring[i], &b = ring[k];
      const double side_a = i == last ? side_b : side(p, q, a);
      side_b = side(p, q, b);
      last = k;
      if (left(side_a) == left(side_b)) return;
      const double along = direction.dot(b - a) / (side_a - side_b);
      crossings_.push_back(std::abs(side_a) < std::abs(side_b) ? at(direction, a, side_a * along)
                                                               : at(direction, b, side_b * along));
    });
  }

  const Polygon& polygon_;
  const Box box_;
  std::vector<RingTree> trees_;
  std::vector<Place> crossings_;
  std::vector<Part> parts_;
};

// The length that two lists of parts of a segment have in common.
double common_length(const std::vector<CutPolygon::Part>& first,
                     const std::vector<CutPolygon::Part>& second, const Vec2& direction) {
  double sum = 0;
  for (size_t i = 0, k = 0; i < first.size() && k < second.size();) {
    const CutPolygon::Part both{std::max(first[i].from, second[k].from, CutPolygon::before),
                                std::min(first[i].to, second[k].to, CutPolygon::before)};
    if (both.from.along <= both.to.along) sum += both.length(direction);
    CutPolygon::before(first[i].to, second[k].to) ? ++i : ++k;
  }
  return sum;
}

}  // namespace

double boundary_inside(const Polygon& polygon, const Polygon& other) {
  CutPolygon cut(other);
  double sum = 0;
  for (int i = 0; i < polygon.size(); ++i) {
    const Vec2 &p = polygon[i], &q = polygon.after(i);
    const Vec2 direction = (q - p).normalized();
    for (const CutPolygon::Part& part : cut.parts(p, q, Side::inner)) {
      sum += part.length(direction);
    }
  }
  return sum;
}

double area_inside(const Polygon& a, const Polygon& b) {
  const Box of_a = bounding_box(a), of_b = bounding_box(b);
  const Vec2 middle((std::max(of_a.x0, of_b.x0) + std::min(of_a.x1, of_b.x1)) / 2,
                    (std::max(of_a.y0, of_b.y0) + std::min(of_a.y1, of_b.y1)) / 2);
  double twice = 0;
  // An edge counts with its length inside the other polygon and its distance from the middle. Where
  // edges lie on each other, those of b have a on one side at most.
  const auto add = [&](const Polygon& polygon, const Polygon& other, bool both_sides) {
    CutPolygon cut(other);
    for (int i = 0; i < polygon.size(); ++i) {
      const Vec2 &p = polygon[i], &q = polygon.after(i);
      const Vec2 direction = (q - p).normalized();
      const std::vector<CutPolygon::Part> inner = cut.parts(p, q, Side::inner);
      if (inner.empty()) continue;
      const double length =
          common_length(inner, both_sides ? cut.parts(p, q, Side::outer) : inner, direction);
      twice += cross(Vec2(p - middle), direction) * length;
    }
  };
  add(a, b, false);
  add(b, a, true);
  return twice / 2;
}

}  // namespace apothem
