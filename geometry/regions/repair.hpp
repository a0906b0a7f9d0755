// Repairs outlines: makes valid polygons with holes out of rings that cross, touch or repeat
// themselves, and simplifies them.
#pragma once

#include <string>
#include <vector>

#include "geometry/polygon/polygon_with_holes.hpp"
#include "geometry/regions/ring_faults.hpp"

namespace apothem {

struct Repaired {
  std::vector<PolygonWithHoles> polygons;
  std::vector<RingFault> faults;  ///< of the rings as they were given
  /// What simplification has done: vertices left out, an upper bound of the Hausdorff distance
  /// between the boundaries before and after (m), and parts that were thinner than the tolerance,
  /// with their area (m^2).
  int simplified_vertices = 0;
  double hausdorff_distance = 0;
  int thin_parts = 0;
  double thin_area = 0;
};

/// The set that the rings of one outline surround by the even-odd rule, see even_odd_polygons(),
/// with its boundary simplified by `tolerance` (m): vertices are left out as long as the Hausdorff
/// distance stays below it and the polygons stay valid. With a tolerance of 0 no vertex moves and
/// the area is that of the even-odd rule. Throws InvalidPolygon for coordinates that are not
/// finite, or beyond 1e60.
Repaired repair(const Rings& rings, double tolerance = 0);

}  // namespace apothem
