// Private header: what carries force between bodies, as lines.
#pragma once

#include "lib/output/frame_grid.hpp"
#include "lib/output/frames.hpp"

namespace apothem {

/// Force chains: a line for every contact patch, from the mass centre of each body that is free to
/// the loading point, with the sizes of the forces as cell data.
FrameGrid force_chains(const Model& model, const FrameContents& frame);

/// Rose diagrams: a closed line for every region, about the middle of its box, whose distance from
/// there in a direction is proportional to the number of contact patches with that normal, over
/// sectors of 10 degrees. If all directions were equally frequent, it would be a circle with a
/// quarter of the root of the region's area as its radius. Point data: how frequent the direction
/// is and how large its mean normal force, both over the mean of all directions.
FrameGrid roses(const Model& model, const FrameContents& frame);

}  // namespace apothem
