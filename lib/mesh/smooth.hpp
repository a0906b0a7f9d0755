// Better-shaped elements by moving inner nodes.
#pragma once

#include "mesh/mesh.hpp"

namespace apothem {

/// Moves nodes that are not on the boundary, one after the other, to the mean of the nodes at the
/// other ends of their edges or half-way there, if that makes the smallest sine of a corner of the
/// elements around larger (L. Freitag, Trends in Unstructured Mesh Generation, ASME 1997: smart
/// Laplacian smoothing). At most `sweeps` times; ends early once no node moves. For convex
/// elements.
void smooth_nodes(Mesh& mesh, int sweeps);

}  // namespace apothem
