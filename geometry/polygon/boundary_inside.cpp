#include "apothem/geometry/polygon/boundary_inside.hpp"

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
    Box box;
    box.include(p.x(), p.y());
    box.include(q.x(), q.y());
    if (apart(box, box_)) return 0;
    crossings_.clear();
    const Vec2 edge = q - p;
    const double length2 = edge.squaredNorm();
    const auto along = [&](const Vec2& v) { return edge.dot(v - p) / length2; };
    const Vec2* a = &polygon_[polygon_.size() - 1];
    double side_a = side(p, q, *a);
    for (int i = 0; i < polygon_.size(); ++i) {
      const Vec2* b = &polygon_[i];
      const double side_b = side(p, q, *b);
      if ((side_a > 0) != (side_b > 0)) {
        const double share = side_a / (side_a - side_b);
        const double start = along(*a);
        crossings_.push_back(start + share * (along(*b) - start));
      }
      a = b;
      side_a = side_b;
    }
    std::sort(crossings_.begin(), crossings_.end());
    double sum = 0;
    for (size_t i = 0; i + 1 < crossings_.size(); i += 2) {
      sum += std::max(0.0, std::min(crossings_[i + 1], 1.0) - std::max(crossings_[i], 0.0));
    }
    return sum * std::hypot(edge.x(), edge.y());
  }

 private:
  const Polygon& polygon_;
  const Box box_;
  std::vector<double> crossings_;
};

}  // namespace

double boundary_inside(const Polygon& polygon, const Polygon& other) {
  Line line(other);
  double sum = 0;
  for (int i = 0; i < polygon.size(); ++i) sum += line.inside(polygon[i], polygon.after(i));
  return sum;
}

}  // namespace apothem
