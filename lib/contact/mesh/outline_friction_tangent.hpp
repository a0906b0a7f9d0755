// The tangent stiffness of friction between outlines: the forces of the springs of a trial with
// their derivatives. These go along the chain of the law: from the vertices to the sums over the
// contacts of each spring (MovingEdgeFace), from the sums of a neighbourhood to the force of the
// spring (CommonNormals and follow_slip with numbers that carry derivatives), and back to the
// vertices.
#pragma once

#include <span>
#include <vector>

#include "lib/contact/mesh/common_normals.hpp"
#include "lib/contact/mesh/edge_face_blocks.hpp"
#include "lib/contact/surface/outline_surfaces.hpp"
#include "lib/solver/tangent.hpp"

namespace apothem {

/// What the last update of the springs has found.
struct TriedOutlineFriction {
  const OutlineSurfaces& outlines;
  const EdgeFaceBlocks& blocks;
  std::span<const SpringContact> contacts;  ///< one for each group of the blocks
  std::span<const double> velocities;       ///< x and y of each vertex, m/s
  double dt;                                ///< s
};

/// Adds minus the derivatives of the friction forces; see add_edge_face_tangent.
void add_friction_tangent(const TriedOutlineFriction& tried, size_t first_node, Tangent& tangent);

}  // namespace apothem
