// Private header: the bodies of a frame, and the lines around them, for the files of frames.
#pragma once

#include <map>
#include <vector>

#include "lib/output/frame_grid.hpp"
#include "lib/output/frames.hpp"

namespace apothem {

/// A rigid body is a cell, and so is an element, or several if it is not convex. `rigid_cells` are
/// those of the rigid bodies that are not convex. Cell data: which body and part it is, the
/// quantities of bodies, and the stresses of elements.
FrameGrid body_grid(const Model& model, const FrameContents& frame,
                    const std::map<RigidIndex, Cells>& rigid_cells);

/// The lines around all bodies: around the polygon of a rigid one, and along each of the `loops`
/// around a mesh. Each edge is a cell, because not all readers know lines of several edges.
FrameGrid outline_grid(const Model& model, const State& state, const std::vector<Cells>& loops);

}  // namespace apothem
