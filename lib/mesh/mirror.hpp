// Mirrors a mesh.
#pragma once

#include "lib/mesh/mesh.hpp"

namespace apothem {

/// Mirrors the mesh at the line on which coordinate `axis` (0: x, 1: y) has the value `at`, m. The
/// numbers of nodes and elements stay; the elements run counter-clockwise again and keep their
/// first corner.
void mirror(Mesh& mesh, int axis, double at);

}  // namespace apothem
