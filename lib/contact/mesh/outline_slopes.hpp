// The slopes of the potentials of outlines: the pressure per depth between two bodies, or in one
// body that touches itself.
#pragma once

#include "lib/contact/law/pair_table.hpp"
#include "lib/contact/mesh/edge_face.hpp"
#include "lib/contact/surface/outline_surfaces.hpp"

namespace apothem {

struct OutlineSlopes {
  const OutlineSurfaces& outlines;
  const PairTable& table;
  double thickness;  ///< m

  /// k_n thickness / r of the potential of a body against another body, N/m^2.
  [[nodiscard]] double operator()(BodyIndex potential, BodyIndex other) const {
    return table.between(potential, other).normal_stiffness * thickness /
           outlines.bodies[potential].reference;
  }
  /// The slope of the face of a candidate against the body of its edge.
  [[nodiscard]] double of(const EdgeFace& pair) const {
    return (*this)(outlines.body[pair.face], outlines.body[pair.edge]);
  }
};

}  // namespace apothem
