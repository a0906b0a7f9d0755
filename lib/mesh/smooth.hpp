// Improves the shape of elements by moving inner nodes.
#pragma once

#include "lib/mesh/mesh.hpp"

namespace apothem {

/// Smart Laplacian smoothing (L. Freitag, Trends in Unstructured Mesh Generation, ASME 1997): moves
/// each node that is not on the boundary to the mean of its neighbours along edges, or half-way
/// there, if that increases the smallest sine of a corner of the elements around it. Nodes move one
/// after the other, in at most `sweeps` passes; the function ends early once no node moves. All
/// elements must be convex.
void smooth_nodes(Mesh& mesh, int sweeps);

}  // namespace apothem
