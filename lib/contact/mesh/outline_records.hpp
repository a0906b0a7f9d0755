// The output of the contact of outlines: the patches, and the pressure on every edge.
#pragma once

#include <vector>

#include "lib/contact/law/contact.hpp"
#include "lib/contact/mesh/edge_face.hpp"
#include "lib/contact/mesh/outline_slopes.hpp"
#include "lib/contact/mesh/saturated_regions.hpp"

namespace apothem {

/// The contacts of outlines at their present positions.
struct OutlineState {
  const OutlineSlopes& slopes;
  const std::vector<EdgeFaceContact>& contacts;  ///< ascending by edge and face
  const SaturatedRegions& saturated;
  [[nodiscard]] const OutlineSurfaces& outlines() const { return slopes.outlines; }
};

/// Adds a record for every patch, in ascending order of the pairs of bodies.
void add_patch_records(const OutlineState& state, std::vector<ContactRecord>& records);

/// Adds a record for every edge of the outlines.
void add_surface_records(const OutlineState& state, std::vector<SurfaceRecord>& records);

}  // namespace apothem
