#include "geometry/exact_integral.hpp"

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <boost/multiprecision/eigen.hpp>

#include "geometry/exact_overlap.hpp"

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

Moments moments(const std::vector<WideVec>& v) {
  Wide twice_area = 0;
  WideVec first(0, 0);
  for (size_t i = 2; i < v.size(); ++i) {
    const Wide twice = cross<Wide>(v[i - 1] - v[0], v[i] - v[0]);
    twice_area += twice;
    first += twice * (v[i - 1] + v[i] - 2 * v[0]);
  }
  return {twice_area / 2, v[0] + first / (3 * twice_area)};
}

Envelope<Wide> envelope(const Polygon& polygon, const Vec2& origin, const PotentialChoice& choice) {
  const bool distance = choice.kind == PotentialChoice::Kind::distance;
  if (const auto reflex = polygon.first_reflex_vertex(); reflex && distance) {
    const int i = polygon.input_index(*reflex);
    throw InvalidPolygon(
        "vertex " + std::to_string(i) + " is reflex: contact needs convex polygons", i);
  }
  if (!distance && polygon.size() != 3) {
    throw InvalidPolygon("has " + std::to_string(polygon.size()) +
                             " vertices: the area potential is defined for triangles only",
                         3);
  }
  std::vector<WideVec> v;
  for (const Vec2& p : polygon.vertices()) v.push_back(widened(p) - widened(origin));
  const auto [area, centroid] = moments(v);

  // Inward normals of unit length, or with slope 3 / altitude = 3 length / (2 area).
  Envelope<Wide> phi{{}, false, centroid};
  for (size_t i = 0; i < v.size(); ++i) {
    const WideVec d = v[i + 1 == v.size() ? 0 : i + 1] - v[i];
    const Wide length = distance ? sqrt(Wide(d.squaredNorm())) : Wide(2 * area / 3);
    const WideVec gradient(-d.y() / length, d.x() / length);
    phi.lines.push_back({gradient, -gradient.dot(v[i])});
  }
  if (distance) {
    Wide inradius = 0;
    for (const Corner<Wide>& corner : corners(phi.lines, v)) {
      inradius = std::max(inradius, corner.height);
    }
    const bool given = choice.reference == PotentialChoice::Reference::length;
    const Wide reference = given ? Wide(choice.length) : inradius;
    for (Line<Wide>& line : phi.lines) {
      line.gradient /= reference;
      line.height /= reference;
    }
    phi.capped = given && inradius > reference;
  }
  return phi;
}

}  // namespace

PairResult exact_method(const Polygon& a, const Polygon& b, const PotentialChoice& choice) {
  const Vec2& origin = a.origin();
  const Envelope<Wide> phi_a = envelope(a, origin, choice);
  const Envelope<Wide> phi_b = envelope(b, origin, choice);
  return integrate(exact_regions<Wide>(a, b, origin), phi_a, phi_b);
}

}  // namespace apothem
