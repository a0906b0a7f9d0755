// Private header: contact patches and the boundaries of bodies in contact, for VTK.
#pragma once

#include <vector>

#include "lib/model/model.hpp"
#include "lib/model/statistics.hpp"
#include "lib/output/vtk_grid.hpp"

namespace apothem {

/// A vertex for every contact patch, at its loading point.
vtkNew<vtkUnstructuredGrid> contact_patches(const Model& model,
                                            const std::vector<ContactRecord>& contacts);

/// A line for every boundary edge, with the pressure and the traction on it.
vtkNew<vtkUnstructuredGrid> contact_surfaces(const Model& model,
                                             const std::vector<SurfaceRecord>& surfaces);

}  // namespace apothem
