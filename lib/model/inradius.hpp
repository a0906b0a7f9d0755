// The size of a body that depths of contact are compared with.
#pragma once

#include "lib/model/model.hpp"

namespace apothem {

/// The inradius of a body as the scene gives it, m: of a rigid one RigidBody::inradius, of a mesh
/// mesh_inradius.
double inradius_of(const Model& model, BodyIndex body);

}  // namespace apothem
