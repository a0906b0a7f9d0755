// What a run takes beside its steps: files, room on the disk, time to write, memory.
#pragma once

#include <string>
#include <vector>

#include "lib/scene/scene.hpp"

namespace apothem {

/// What the results of a run take, to within a factor of about two.
struct OutputCost {
  double frames = 0;   ///< number, with that of the start
  double files = 0;    ///< number
  double bytes = 0;    ///< of frames and histories
  double seconds = 0;  ///< to write them
};

/// `steps`: of the whole run. No more frames or rows are written than there are steps.
OutputCost output_cost(const Scene& scene, double steps);

/// A sentence for each cost that nobody wants: more than a hundred thousand files, more than 20 GB
/// or a day to write, more than half of the memory there is.
std::vector<std::string> excessive_costs(const Scene& scene, double steps);

}  // namespace apothem
