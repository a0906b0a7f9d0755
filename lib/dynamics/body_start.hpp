// Where a body begins, if another run says so and not its scene.
#pragma once

#include <vector>

#include "lib/archive/archive.hpp"
#include "lib/mesh/indices.hpp"

namespace apothem {

/// Where a body begins instead of where its scene puts it: x, y and angle of the mass centre, or
/// the displacements of the nodes; and their rates.
struct BodyStart {
  BodyIndex body = 0;
  std::vector<double> x, v;
  int absent = 0;  ///< see State
  void fields(Archive& archive) { archive("body", body)("x", x)("v", v)("absent", absent); }
};

}  // namespace apothem
