#include "geometry/polygon/predicates.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_2_algorithms.h>

#include "geometry/polygon/cyclic.hpp"

namespace apothem {
namespace {

using Point = CGAL::Exact_predicates_inexact_constructions_kernel::Point_2;

Point cgal(const Vec2& p) { return {p.x(), p.y()}; }

// True if c lies on the closed segment ab; c has to lie on the line through a and b.
bool between(const Vec2& a, const Vec2& b, const Vec2& c) {
  return std::min(a.x(), b.x()) <= c.x() && c.x() <= std::max(a.x(), b.x()) &&
         std::min(a.y(), b.y()) <= c.y() && c.y() <= std::max(a.y(), b.y());
}

}  // namespace

int orientation(const Vec2& a, const Vec2& b, const Vec2& c) {
  return static_cast<int>(CGAL::orientation(cgal(a), cgal(b), cgal(c)));
}

int smallest_turn(std::span<const Vec2> ring) {
  int smallest = 1;
  for (size_t i = 0; i < ring.size() && smallest >= 0; ++i) {
    smallest = std::min(smallest, orientation(before(ring, i), ring[i], after(ring, i)));
  }
  return smallest;
}

bool segments_meet(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  const int abc = orientation(a, b, c);
  const int abd = orientation(a, b, d);
  const int cda = orientation(c, d, a);
  const int cdb = orientation(c, d, b);
  if (abc * abd < 0 && cda * cdb < 0) return true;
  return (abc == 0 && between(a, b, c)) || (abd == 0 && between(a, b, d)) ||
         (cda == 0 && between(c, d, a)) || (cdb == 0 && between(c, d, b));
}

bool is_simple(const std::vector<Vec2>& ring) {
  std::vector<Point> points;
  points.reserve(ring.size());
  for (const Vec2& v : ring) points.push_back(cgal(v));
  return CGAL::is_simple_2(points.begin(), points.end(),
                           CGAL::Exact_predicates_inexact_constructions_kernel());
}

int side_of_ring(std::span<const Vec2> ring, const Vec2& p) {
  // The ray from p to the right is tested for crossings with all edges. Each edge counts with its
  // lower end but without its upper one, so that a vertex on the ray is counted correctly.
  bool inside = false;
  for (size_t i = 0; i < ring.size(); ++i) {
    const Vec2& a = ring[i];
    const Vec2& b = after(ring, i);
    if (std::max(a.y(), b.y()) < p.y() || std::min(a.y(), b.y()) > p.y()) continue;
    const int side = orientation(a, b, p);
    if (side == 0 && between(a, b, p)) return 0;
    if (a.y() <= p.y() && p.y() < b.y() && side > 0) inside = !inside;
    if (b.y() <= p.y() && p.y() < a.y() && side < 0) inside = !inside;
  }
  return inside ? 1 : -1;
}

}  // namespace apothem
