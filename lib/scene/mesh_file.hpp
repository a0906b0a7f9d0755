// Reads meshes that stand in files of their own.
#pragma once

#include <string>

#include "lib/mesh/check.hpp"
#include "lib/mesh/mesh.hpp"

namespace apothem {

/// Whether the name of the file ends in .msh.
bool is_mesh_file(const std::string& file);

/// Reads a file made by gmsh, see parse_gmsh(). Throws SceneError.
Mesh read_mesh_file(const std::string& file, const MeshRules& rules = {});

}  // namespace apothem
