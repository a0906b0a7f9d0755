#include "geometry/polygon/boundary_inside.hpp"

#include <CGAL/Exact_rational.h>

#include <algorithm>
#include <cmath>
#include <vector>

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

// A point on the left of the line through an edge is on the inner side of the edge. Vertices on the
// line count as points on its right. So the polygon is crossed as if by a parallel line that runs
// immediately inside the edge.
class Line {
 public:
  explicit Line(const Polygon& polygon) : polygon_(polygon), box_(bounding_box(polygon)) {}

  // Length of the segment pq inside.
  double inside(const Vec2& p, const Vec2& q) {
    if (apart(box_of(p, q), box_)) return 0;
    crossings_.clear();
    const Vec2 direction = (q - p).normalized();
    const Place from = at(direction, p, 0);
    const Place to = at(direction, q, 0);
    for (int k = 0; k < polygon_.rings(); ++k) cross_ring(p, q, direction, polygon_.ring(k));
    const auto before = [](const Place& x, const Place& y) { return x.along < y.along; };
    std::sort(crossings_.begin(), crossings_.end(), before);
    double sum = 0;
    for (size_t i = 0; i + 1 < crossings_.size(); i += 2) {
      const Place& first = std::max(crossings_[i], from, before);
      const Place& last = std::min(crossings_[i + 1], to, before);
      const double length = direction.dot(*last.near - *first.near) + (last.rest - first.rest);
      if (first.along <= last.along) sum += std::max(0.0, length);
    }
    return sum;
  }

 private:
  // A place on the line: the foot of the perpendicular from a vertex that is near, and the rest of
  // the way. So the distance of two places has few wrong digits however small it is.
  struct Place {
    double along;
    const Vec2* near;
    double rest;
  };
  [[nodiscard]] Place at(const Vec2& direction, const Vec2& near, double rest) const {
    return {direction.dot(near - polygon_[0]) + rest, &near, rest};
  }

  // Adds the crossings of the line through p and q with a ring.
  void cross_ring(const Vec2& p, const Vec2& q, const Vec2& direction, std::span<const Vec2> ring) {
    const Vec2* a = &ring.back();
    double side_a = side(p, q, *a);
    for (const Vec2& end : ring) {
      const Vec2* b = &end;
      const double side_b = side(p, q, *b);
      if ((side_a > 0) != (side_b > 0)) {
        const double along = direction.dot(*b - *a) / (side_a - side_b);
        crossings_.push_back(std::abs(side_a) < std::abs(side_b)
                                 ? at(direction, *a, side_a * along)
                                 : at(direction, *b, side_b * along));
      }
      a = b;
      side_a = side_b;
    }
  }

  const Polygon& polygon_;
  const Box box_;
  std::vector<Place> crossings_;
};

}  // namespace

double boundary_inside(const Polygon& polygon, const Polygon& other) {
  Line line(other);
  double sum = 0;
  for (int i = 0; i < polygon.size(); ++i) sum += line.inside(polygon[i], polygon.after(i));
  return sum;
}

}  // namespace apothem
