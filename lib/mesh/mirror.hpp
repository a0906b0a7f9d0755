// The mirror image of a mesh.
#pragma once

#include "mesh/mesh.hpp"

namespace apothem {

/// Mirrors at the line where coordinate `axis` (0: x, 1: y) is `at`, m. Numbers stay; elements run
/// counter-clockwise again and keep their first corner.
void mirror(Mesh& mesh, int axis, double at);

}  // namespace apothem
