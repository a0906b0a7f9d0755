// CGAL's straight skeletons, made by the helper program. This header is private to the construction
// of the straight skeleton.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apothem/geometry/polygon/point.hpp"
#include "apothem/geometry/skeleton/skeleton_parts.hpp"

namespace apothem {

/// What CGAL has found.
struct CgalAnswer {
  std::optional<SkeletonParts> parts;
  std::string failure;  ///< what went wrong if there are no parts
};

/// Asks CGAL for the skeleton of a simple counter-clockwise ring. CGAL may crash, return nothing or
/// a wrong skeleton. It is killed after `seconds` of processor time, and if `progress` throws.
CgalAnswer ask_cgal(const std::vector<Vec2>& ring, bool exact, double seconds,
                    const Progress& progress);

/// Asks CGAL for the skeletons of many rings, with up to `processes` helpers at the same time. The
/// time limit holds for each ring, and a ring on which a helper fails takes no other ring with it.
std::vector<CgalAnswer> ask_cgal(const std::vector<std::vector<Vec2>>& rings, bool exact,
                                 double seconds, int processes, const Progress& progress);

}  // namespace apothem
