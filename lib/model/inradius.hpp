// The size of a body that depths of contact are compared with.
#pragma once

#include "apothem/model/model.hpp"

namespace apothem {

/// Radius of the largest circle inside a body as the scene gives it, m. Of a body with a mesh: the
/// largest distance of a node or of an element's centre from the boundary, which is smaller by up
/// to the size of an element. The time grows with the nodes times the edges of the boundary.
double inradius_of(const Model& model, BodyIndex body);

}  // namespace apothem
