// The straight skeletons of many polygons.
//
// CGAL constructs them in a few helper processes that run at the same time. The time limit is that
// of a single polygon; if a helper fails on one polygon, another one goes on with the next one. All
// that this program does itself is done by as many threads. The result is the same for any number
// of either.
//
// The skeleton of a copy of a polygon is the image of the skeleton of the original: its faces are
// the same, and its inner nodes are mapped by the similarity and then corrected with the lines of
// the copy's own edges. Its vertices are those of the copy to the last bit.
#pragma once

#include <exception>
#include <optional>
#include <variant>
#include <vector>

#include "geometry/polygon/similar_shapes.hpp"
#include "geometry/skeleton/skeleton.hpp"

namespace apothem {

/// A skeleton, or the exception that straight_skeleton would have thrown.
using SkeletonOrFailure = std::variant<Skeleton, std::exception_ptr>;

/// Constructs the straight skeleton of each polygon as straight_skeleton does, with up to
/// `processes` helper processes, and threads, at the same time. `progress` is called by the calling
/// thread alone.
std::vector<SkeletonOrFailure> straight_skeletons(const std::vector<const Polygon*>& polygons,
                                                  int processes, const Progress& progress = {});

/// Returns the image of a skeleton for a copy of its polygon, or nothing if that image does not
/// obey the laws of skeletons.
std::optional<Skeleton> copied_skeleton(const Skeleton& original, const Similarity& map,
                                        const Polygon& copy);

}  // namespace apothem
