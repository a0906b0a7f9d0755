// CGAL's straight skeletons, made by the helper program. This header is private to the construction
// of the straight skeleton.
#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "geometry/polygon/polygon_with_holes.hpp"
#include "geometry/skeleton/skeleton_parts.hpp"

namespace apothem {

/// Thrown if the helper program does not do its work although it was asked several times. What it
/// would have answered is not known then, and there is no other answer.
class HelperFailure : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// What CGAL has found.
struct CgalAnswer {
  std::optional<SkeletonParts> parts;
  std::string failure;  ///< what went wrong if there are no parts
};

/// Asks CGAL for the skeleton of a polygon: a simple counter-clockwise ring, and the clockwise ones
/// of its holes. CGAL may crash, return nothing or a wrong skeleton. It is killed after `seconds`
/// of processor time, and if `progress` throws. The answer follows from the rings alone: a helper
/// that stalls or is kept from its work is asked again unchanged. Throws HelperFailure where that
/// does not help.
CgalAnswer ask_cgal(const Rings& polygon, bool exact, double seconds, const Progress& progress);

/// Asks CGAL for the skeletons of many polygons, with up to `processes` helpers at the same time.
/// The time limit holds for each polygon, and one on which a helper fails takes no other one with
/// it.
std::vector<CgalAnswer> ask_cgal(const std::vector<Rings>& polygons, bool exact, double seconds,
                                 int processes, const Progress& progress);

}  // namespace apothem
