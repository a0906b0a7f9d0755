// The nodes and faces from which a skeleton is assembled. This header is private to the
// construction of the straight skeleton.
#pragma once

#include <optional>
#include <vector>

#include "geometry/polygon/polygon.hpp"
#include "geometry/skeleton/skeleton.hpp"

namespace apothem {

/// The nodes and faces of a skeleton, see Skeleton.
struct SkeletonParts {
  std::vector<Skeleton::Node> nodes;
  std::vector<std::vector<int>> faces;
};

/// A border of a face, from one node to the next one, counter-clockwise.
struct FaceBorder {
  int from, to;
};

/// The parts with the faces that these borders form: one per edge of the polygon, by its borders
/// besides the edge itself. Nothing if those of a face do not form one loop.
std::optional<SkeletonParts> joined(std::vector<Skeleton::Node> nodes,
                                    std::vector<std::vector<FaceBorder>>& borders,
                                    const Polygon& polygon);

/// Derives the arcs and the height of the roof from the nodes and faces. Where two faces do not fit
/// together, the result has an arc that breaks a law.
Skeleton assemble(SkeletonParts parts, const Polygon& polygon);

}  // namespace apothem
