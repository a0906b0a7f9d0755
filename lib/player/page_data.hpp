// Private header: what the page of the player holds of a run.
#pragma once

#include <string>

#include "lib/player/plots.hpp"
#include "lib/player/recording.hpp"

namespace apothem {

/// The two texts of a page.
struct PageData {
  std::string description;  ///< JSON, which no browser takes for the end of a script
  std::string data;         ///< the arrays that it describes, see DataBlock
};
/// `made_by` names the program.
PageData page_data(const Recording& run, const Plots& plots, const std::string& made_by);

}  // namespace apothem
