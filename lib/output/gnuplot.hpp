// Runs gnuplot, which need not be installed.
#pragma once

#include <string>

namespace apothem {

/// Whether gnuplot made a picture: yes, it is not installed, or it failed.
enum class Plotted { yes, no_gnuplot, failed };

/// Runs gnuplot with the file `script` in `folder`. The script writes to the file that the variable
/// `output` names; it is renamed to `picture` afterwards, so that the picture is complete or
/// absent.
Plotted plot_with_gnuplot(const std::string& folder, const std::string& script,
                          const std::string& picture);

}  // namespace apothem
