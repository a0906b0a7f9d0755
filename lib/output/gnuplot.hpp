// Curves through gnuplot, which is optional at run time.
#pragma once

#include <string>

namespace apothem {

enum class Plotted { yes, no_gnuplot, failed };

/// Runs `gnuplot script` inside `folder` with the variable `output` set to a name beside `picture`,
/// and renames the result to it: the picture is complete or not there.
Plotted plot_with_gnuplot(const std::string& folder, const std::string& script,
                          const std::string& picture);

}  // namespace apothem
