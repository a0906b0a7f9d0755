// Renumbers a mesh so that neighbours are close in memory.
#pragma once

#include "lib/mesh/mesh.hpp"

namespace apothem {

/// The permutation that a renumbering has applied.
struct Reordering {
  std::vector<int> nodes;     ///< the old number of each new node
  std::vector<int> elements;  ///< the old number of each new element
};

/// Orders the elements along a Hilbert curve through the means of their corners (see hilbert_order)
/// and the nodes in the order in which elements first use them; unused nodes come last. The nodes
/// and elements of groups are sorted again, and their edges keep their order. An element keeps its
/// first corner.
Reordering reorder_along_curve(Mesh& mesh);

}  // namespace apothem
