#include "lib/scene/mesh_file.hpp"

#include "lib/mesh/gmsh.hpp"
#include "lib/scene/json.hpp"
#include "lib/text/file.hpp"

namespace apothem {

bool is_mesh_file(const std::string& file) { return file.ends_with(".msh"); }

Mesh read_mesh_file(const std::string& file, const MeshRules& rules) {
  try {
    return parse_gmsh(read_text(file), rules);
  } catch (const BadMeshText& error) {
    throw SceneError(file, error.line(), "", error.what());
  }
}

}  // namespace apothem
