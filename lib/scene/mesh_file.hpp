// Meshes in files of their own.
#pragma once

#include <string>

#include "apothem/mesh/check.hpp"
#include "apothem/mesh/mesh.hpp"

namespace apothem {

/// True for names that end in .msh.
bool is_mesh_file(const std::string& file);

/// A gmsh file, see parse_gmsh. Throws SceneError.
Mesh read_mesh_file(const std::string& file, const MeshRules& rules = {});

}  // namespace apothem
