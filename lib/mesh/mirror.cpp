#include "lib/mesh/mirror.hpp"

#include <algorithm>

namespace apothem {

void mirror(Mesh& mesh, int axis, double at) {
  for (Vec2& p : mesh.nodes) p[axis] = at + (at - p[axis]);
  for (int e = 0; e < mesh.element_count(); ++e) {
    std::reverse(mesh.corners.begin() + mesh.first[e] + 1,
                 mesh.corners.begin() + mesh.first[e + 1]);
  }
  for (MeshGroup& group : mesh.groups) {
    for (auto& [a, b] : group.edges) std::swap(a, b);
  }
}

}  // namespace apothem
