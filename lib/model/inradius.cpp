#include "lib/model/inradius.hpp"

#include "lib/mesh/boundary.hpp"

namespace apothem {

double inradius_of(const Model& model, BodyIndex body) {
  const auto rigid = static_cast<BodyIndex>(model.bodies.size());
  if (body < rigid) return model.bodies[body].inradius;
  const Mesh& mesh = model.deformables[body - rigid].mesh;
  return mesh_inradius(mesh, boundary(mesh));
}

}  // namespace apothem
