// The player: a run as one HTML file that a browser plays without a network.
#pragma once

#include <string>

#include "lib/output/run_folder.hpp"

namespace apothem {

/// The page as the text of an HTML file. `title` is its heading, `made_by` names the program.
///
/// Places are rounded to a step of at most 1/131072 of the longer side of the picture and at most
/// 1/1024 of the size of the smallest body; values of quantities to 0.05 % (see rounded()). Throws
/// ResultsError.
std::string player_page(const RunFolder& run, const std::string& title, const std::string& made_by);

}  // namespace apothem
