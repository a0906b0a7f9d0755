#include "geometry/exact/exact_integral.hpp"

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <boost/multiprecision/eigen.hpp>

#include "geometry/exact/exact_overlap.hpp"
#include "geometry/polygon/cyclic.hpp"

namespace apothem {
namespace {

using namespace overlap_detail;
using Wide = boost::multiprecision::cpp_bin_float_100;
using WideVec = Vec<Wide>;

WideVec widened(const Vec2& p) { return {Wide(p.x()), Wide(p.y())}; }

struct Moments {
  Wide area;
  WideVec centroid;
};

// The moments of a polygon with the vertices v.
Moments moments(const Polygon& polygon, const std::vector<WideVec>& v) {
  Wide twice_area = 0;
  WideVec first(0, 0);
  for (int i = 0; i < polygon.size(); ++i) {
    const WideVec &p = v[i], &q = v[polygon.next(i)];
    const Wide twice = cross<Wide>(p - v[0], q - v[0]);
    twice_area += twice;
    first += twice * (p + q - 2 * v[0]);
  }
  return {twice_area / 2, v[0] + first / (3 * twice_area)};
}

// Adds the nodes of the skeleton to phi. Each inner node is computed again as the point where the
// planes of three of its faces meet; the three with the largest determinant are taken. Of the
// skeleton, only the information which faces meet is used.
void add_nodes(Envelope<Wide>& phi, const std::vector<WideVec>& v, const Roof& roof) {
  std::vector<std::vector<size_t>> faces_at(roof.points.size());
  for (size_t e = 0; e < roof.faces.size(); ++e) {
    for (const int node : roof.faces[e]) faces_at[node].push_back(e);
  }
  phi.roof = &roof;
  for (size_t i = 0; i < roof.points.size(); ++i) {
    if (i < v.size()) {
      phi.x.push_back(v[i].x());
      phi.y.push_back(v[i].y());
      phi.values.push_back(0);
      continue;
    }
    const std::vector<size_t>& at = faces_at[i];
    // All planes may be parallel to one line, for collinear edges on one side of a level ridge.
    // Then the position along that line has no effect on the roof, and the rounded node is used.
    Wide best = 1e-9;
    WideVec point = v[0] + widened(roof.points[i]);
    Wide value = phi.lines[at[0]](point);
    for (size_t a = 0; a < at.size(); ++a) {
      for (size_t b = a + 1; b < at.size(); ++b) {
        for (size_t c = b + 1; c < at.size(); ++c) {
          const Line<Wide>&p = phi.lines[at[a]], &q = phi.lines[at[b]], &r = phi.lines[at[c]];
          const WideVec u = q.gradient - p.gradient;
          const WideVec w = r.gradient - p.gradient;
          const Wide determinant = cross<Wide>(u, w);
          if (abs(determinant) <= best) continue;
          best = abs(determinant);
          const Wide du = p.height - q.height;
          const Wide dw = p.height - r.height;
          point = WideVec((du * w.y() - dw * u.y()) / determinant,
                          (u.x() * dw - w.x() * du) / determinant);
          value = p(point);
        }
      }
    }
    phi.x.push_back(point.x());
    phi.y.push_back(point.y());
    phi.values.push_back(value);
  }
}

Envelope<Wide> envelope(const Polygon& polygon, const Potential& potential, const Vec2& origin,
                        const PotentialChoice& choice) {
  const bool distance = choice.kind == PotentialChoice::Kind::distance;
  std::vector<WideVec> v;
  for (const Vec2& p : polygon.vertices()) v.push_back(widened(p) - widened(origin));
  const auto [area, centroid] = moments(polygon, v);

  // The gradients are inward unit normals for the distance potential. For the area potential they
  // have the length 3 / altitude = 3 length / (2 area).
  Envelope<Wide> phi{{}, false, centroid};
  phi.links = polygon.links();
  for (int i = 0; i < polygon.size(); ++i) {
    const WideVec d = v[polygon.next(i)] - v[i];
    const Wide length = distance ? sqrt(Wide(d.squaredNorm())) : Wide(2 * area / 3);
    const WideVec gradient(-d.y() / length, d.x() / length);
    phi.lines.push_back({gradient, -gradient.dot(v[i])});
  }
  if (distance) {
    Wide roof_height = 0;
    using Reference = PotentialChoice::Reference;
    if (potential.roof) {
      add_nodes(phi, v, *potential.roof);
      roof_height = *std::max_element(phi.values.begin(), phi.values.end());
    } else if (potential.distance && choice.reference == Reference::roof) {
      const Potential roof = make_potential(polygon, {});
      Envelope<Wide> other = phi;
      add_nodes(other, v, *roof.roof);
      roof_height = *std::max_element(other.values.begin(), other.values.end());
    } else if (!potential.distance) {
      for (const Corner<Wide>& corner : corners(phi.lines, v)) {
        roof_height = std::max(roof_height, corner.height);
      }
    }
    const bool given = choice.reference == Reference::length;
    // The largest inscribed circle of a polygon that is not convex is known in double precision
    // only.
    const bool convex = !potential.roof && !potential.distance;
    const Wide reference = given ? Wide(choice.length)
                           : !convex && choice.reference == Reference::inscribed_circle
                               ? Wide(1 / potential.steepest)
                               : roof_height;
    for (Line<Wide>& line : phi.lines) {
      line.gradient /= reference;
      line.height /= reference;
    }
    for (Wide& value : phi.values) value /= reference;
    phi.capped = potential.distance ? potential.capped() : given && roof_height > reference;
    if (potential.distance) phi.set_distance(*potential.distance, v, 1 / reference);
  }
  return phi;
}

}  // namespace

PairResult exact_method(const Polygon& a, const Polygon& b, const PotentialChoice& choice) {
  const Vec2& origin = a.origin();
  const Potential potential_a = make_potential(a, choice);
  const Potential potential_b = make_potential(b, choice);
  const Envelope<Wide> phi_a = envelope(a, potential_a, origin, choice);
  const Envelope<Wide> phi_b = envelope(b, potential_b, origin, choice);
  return integrate(exact_regions<Wide>(a, b, origin), phi_a, phi_b);
}

}  // namespace apothem
