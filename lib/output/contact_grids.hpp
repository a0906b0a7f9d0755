// Private header: contact patches and the boundaries of bodies in contact, as grids.
#pragma once

#include <vector>

#include "lib/model/model.hpp"
#include "lib/model/statistics.hpp"
#include "lib/output/frame_grid.hpp"

namespace apothem {

/// A vertex for every contact patch, at its loading point.
FrameGrid contact_patches(const Model& model, const std::vector<ContactRecord>& contacts);

/// A line for every boundary edge, with the pressure and the traction on it.
FrameGrid contact_surfaces(const Model& model, const std::vector<SurfaceRecord>& surfaces);

}  // namespace apothem
