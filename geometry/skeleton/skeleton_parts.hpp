// The nodes and faces from which a skeleton is assembled. This header is private to the
// construction of the straight skeleton.
#pragma once

#include <vector>

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

/// The nodes of the face of an edge of n, from its edge on, given its other borders. Empty if its
/// borders do not form one loop.
std::vector<int> face_of(int edge, int n, std::vector<FaceBorder>& borders);

/// Derives the arcs and the height of the roof from the nodes and faces. Where two faces do not fit
/// together, the result has an arc that breaks a law.
Skeleton assemble(SkeletonParts parts);

}  // namespace apothem
