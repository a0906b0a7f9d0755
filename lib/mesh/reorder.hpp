// Numbering a mesh so that neighbours are close in memory.
#pragma once

#include "mesh/mesh.hpp"

namespace apothem {

struct Reordering {
  std::vector<int> nodes;     ///< the old number of each node
  std::vector<int> elements;  ///< the old number of each element
};

/// Elements come in the order of a Hilbert curve through the means of their corners (see
/// hilbert_order), nodes in the order in which elements first use them, unused ones last. Groups
/// follow: their nodes ascend again, their edges keep their order. An element keeps its first
/// corner.
Reordering reorder_along_curve(Mesh& mesh);

}  // namespace apothem
