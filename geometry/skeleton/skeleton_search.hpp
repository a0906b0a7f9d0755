// The search for a skeleton in parts, so that CGAL can be asked about many polygons at once. This
// header is private to the construction of straight skeletons.
#pragma once

#include <optional>
#include <vector>

#include "geometry/skeleton/cgal_skeleton.hpp"
#include "geometry/skeleton/skeleton.hpp"

namespace apothem {

/// The first question of straight_skeleton to CGAL, if it begins with one.
struct FirstQuestion {
  Rings rings;     ///< counter-clockwise outside and clockwise around holes
  double seconds;  ///< time limit, s
};
std::optional<FirstQuestion> first_question(const Polygon& polygon);

/// As straight_skeleton, with the answer to the first question if it is known already.
Skeleton straight_skeleton(const Polygon& polygon, std::optional<CgalAnswer> first_answer,
                           const Progress& progress);

}  // namespace apothem
