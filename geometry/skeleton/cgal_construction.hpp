// CGAL's construction of straight skeletons. It may crash or never return, so only the helper
// program calls it (skeleton_program.cpp).
#pragma once

#include <vector>

#include "geometry/polygon/polygon_with_holes.hpp"
#include "geometry/skeleton/skeleton.hpp"

namespace apothem {

/// A skeleton as numbers: the number n of faces; the number of nodes; three numbers per node (x, y,
/// height); then for every face the number of its nodes and their indices. Empty if CGAL found no
/// skeleton.
using SkeletonMessage = std::vector<double>;

/// The skeleton of a polygon, with CGAL's exact or inexact constructions: a simple
/// counter-clockwise ring, and the clockwise ones of its holes.
SkeletonMessage cgal_skeleton(const Rings& polygon, bool exact);

}  // namespace apothem
