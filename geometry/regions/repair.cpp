#include "geometry/regions/repair.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/polygon/cyclic.hpp"
#include "geometry/polygon/segment.hpp"
#include "geometry/regions/boolean.hpp"

namespace apothem {
namespace {

using Ring = std::vector<Vec2>;

struct Simplified {
  std::vector<PolygonWithHoles> polygons;
  int vertices = 0;
  double distance = 0;
  int thin_parts = 0;
  double thin_area = 0;
};

// The largest distance of the vertices between two of a ring from the segment between these. The
// line along the ring is connected, so no point of the segment is farther from it than that: this
// is the Hausdorff distance.
double distance_from_chord(const Ring& ring, size_t first, size_t last) {
  const size_t n = ring.size();
  const Vec2 along = ring[last % n] - ring[first];
  double farthest2 = 0;
  for (size_t i = first + 1; i < last; ++i) {
    farthest2 = std::max(farthest2, nearest_on_segment(ring[i] - ring[first], along).distance2);
  }
  return std::sqrt(farthest2);
}

// Leaves out vertices as long as they stay within the tolerance of the chord over them, beginning
// at the first vertex.
Ring simplified(const Ring& ring, double tolerance, double& distance) {
  Ring result;
  const size_t n = ring.size();
  for (size_t first = 0; first < n;) {
    result.push_back(ring[first]);
    size_t last = first + 1;
    double reached = 0;
    while (last < n) {
      const double further = distance_from_chord(ring, first, last + 1);
      if (further > tolerance) break;
      reached = further;
      ++last;
    }
    distance = std::max(distance, reached);
    first = last;
  }
  return result;
}

Simplified simplified(const std::vector<PolygonWithHoles>& polygons, double tolerance) {
  Simplified result;
  const auto leave_out = [&](const Ring& ring) {
    ++result.thin_parts;
    result.thin_area += std::abs(ring_area(ring));
  };
  for (const PolygonWithHoles& polygon : polygons) {
    PolygonWithHoles kept{simplified(polygon.outer, tolerance, result.distance), {}};
    if (kept.outer.size() < 3) {
      leave_out(polygon.outer);
      continue;
    }
    result.vertices += static_cast<int>(polygon.outer.size() - kept.outer.size());
    for (const Ring& hole : polygon.holes) {
      Ring ring = simplified(hole, tolerance, result.distance);
      if (ring.size() < 3) {
        leave_out(hole);
        continue;
      }
      result.vertices += static_cast<int>(hole.size() - ring.size());
      kept.holes.push_back(std::move(ring));
    }
    result.polygons.push_back(std::move(kept));
  }
  return result;
}

// Whether these are polygons as the even-odd rule gives them, so that none of their rings meet.
bool are_valid(const std::vector<PolygonWithHoles>& polygons) {
  const Rings rings = rings_of(polygons);
  const std::vector<PolygonWithHoles> again = even_odd_polygons(rings);
  const auto sizes = [](const std::vector<PolygonWithHoles>& list) {
    std::vector<size_t> numbers{list.size()};
    for (const Ring& ring : rings_of(list)) numbers.push_back(ring.size());
    std::sort(numbers.begin() + 1, numbers.end());
    return numbers;
  };
  if (sizes(again) != sizes(polygons)) return false;
  return std::all_of(rings.begin(), rings.end(),
                     [](const Ring& ring) { return faults_of({ring}).empty(); });
}

}  // namespace

Repaired repair(const Rings& rings, double tolerance) {
  Repaired result;
  result.polygons = even_odd_polygons(rings);
  result.faults = faults_of(rings);
  constexpr double kLeast = 1. / 1024;  // of the tolerance
  for (double share = 1; tolerance > 0 && share >= kLeast; share /= 2) {
    Simplified simple = simplified(result.polygons, share * tolerance);
    if (!are_valid(simple.polygons)) continue;
    result.polygons = std::move(simple.polygons);
    result.simplified_vertices = simple.vertices;
    result.hausdorff_distance = simple.distance;
    result.thin_parts = simple.thin_parts;
    result.thin_area = simple.thin_area;
    break;
  }
  return result;
}

}  // namespace apothem
