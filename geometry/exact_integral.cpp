#include "geometry/exact_integral.hpp"

#include <boost/multiprecision/mpfr.hpp>

#include "geometry/exact_overlap.hpp"

namespace apothem {
namespace {

using Real = boost::multiprecision::number<boost::multiprecision::mpfr_float_backend<100>,
                                           boost::multiprecision::et_off>;
using RealPoint = detail::Point<Real>;

Real real(const detail::ExactKernel::FT& x) {
  Real result;
  mpfr_set_q(result.backend().data(), CGAL::exact(x).backend().data(), MPFR_RNDN);
  return result;
}

// The polygon relative to `origin`; differences of doubles are exact in this precision.
std::vector<RealPoint> vertices(const Polygon& polygon, const Vec2& origin) {
  std::vector<RealPoint> result;
  for (const Vec2& v : polygon.vertices()) {
    result.push_back({Real(v.x()) - Real(origin.x()), Real(v.y()) - Real(origin.y())});
  }
  return result;
}

// Inradius of a convex polygon by the dual of max_x min_i n_i . (x - p_i): the least weighted mean
// of the distances of one point to three lines whose normals, with these weights, balance.
Real inradius(const std::vector<RealPoint>& p, const std::vector<RealPoint>& normal) {
  const size_t n = p.size();
  std::vector<Real> distance(n);
  for (size_t i = 0; i < n; ++i) distance[i] = dot(normal[i], p[0] - p[i]);
  bool found = false;
  Real least = 0;
  for (size_t i = 0; i < n; ++i) {
    for (size_t j = i + 1; j < n; ++j) {
      const Real wk = cross(normal[i], normal[j]);
      if (wk < 0) continue;
      for (size_t k = j + 1; k < n; ++k) {
        const Real wi = cross(normal[j], normal[k]);
        const Real wj = cross(normal[k], normal[i]);
        const Real sum = wi + wj + wk;
        if (wi < 0 || wj < 0 || sum == 0) continue;
        const Real value = (wi * distance[i] + wj * distance[j] + wk * distance[k]) / sum;
        if (!found || value < least) least = value;
        found = true;
      }
    }
  }
  return least;
}

detail::Side<Real> side(const Polygon& polygon, const Vec2& origin, const PotentialChoice& choice) {
  detail::Side<Real> result;
  detail::Lines<Real>& lines = result.lines;
  lines.p = vertices(polygon, origin);
  lines.capped = false;
  const size_t n = lines.p.size();
  Real area = 0;
  RealPoint first{0, 0};
  for (size_t i = 0; i < n; ++i) {
    const RealPoint& p = lines.p[i];
    const RealPoint& q = lines.p[i + 1 == n ? 0 : i + 1];
    const Real twice = cross(p - lines.p[0], q - lines.p[0]);
    area += twice / 2;
    first = first + (p + q + lines.p[0]) * Real(twice / 6);
    const RealPoint edge = q - p;
    lines.g.push_back(RealPoint{-edge.y, edge.x} * Real(1 / sqrt(dot(edge, edge))));
  }
  result.centroid = first * Real(1 / area);
  if (choice.kind == PotentialChoice::Kind::area) {
    for (size_t i = 0; i < n; ++i) {
      const RealPoint edge = lines.p[i + 1 == n ? 0 : i + 1] - lines.p[i];
      lines.g[i] = RealPoint{-edge.y, edge.x} * Real(3 / (2 * area));
    }
    return result;
  }
  const Real roof = inradius(lines.p, lines.g);
  Real reference = roof;
  if (choice.reference == PotentialChoice::Reference::length) {
    reference = choice.length;
    lines.capped = reference < roof;
  }
  for (RealPoint& g : lines.g) g = g * Real(1 / reference);
  return result;
}

}  // namespace

PairResult exact_method(const Polygon& a, const Polygon& b, const PotentialChoice& choice) {
  make_potential(a, choice);  // the same refusals as every other method
  make_potential(b, choice);
  const Vec2& origin = a.origin();
  std::vector<detail::Ring<Real>> rings;
  for (const detail::ExactOverlap& overlap : detail::exact_overlaps(a, b)) {
    detail::Ring<Real> ring;
    for (const auto& p : overlap.polygon) {
      ring.vertices.push_back({real(p.x() - origin.x()), real(p.y() - origin.y())});
    }
    ring.edges = overlap.edges;
    rings.push_back(std::move(ring));
  }
  const detail::Side<Real> side_a = side(a, origin, choice);
  const detail::Side<Real> side_b = side(b, origin, choice);
  return detail::Eq8<Real>(side_a, side_b, rings).result();
}

}  // namespace apothem
