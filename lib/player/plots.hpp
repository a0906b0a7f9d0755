// Private header: the histories of a run as the curves that the player plots.
#pragma once

#include <string>
#include <vector>

#include "lib/output/run_folder.hpp"

namespace apothem {

/// A curve: two columns of Plots::columns.
struct PlotLine {
  std::string label;
  size_t time, column;
  double offset;  ///< to be added to the column
};
/// Curves that share axes.
struct PlotChoice {
  std::string title, unit;
  std::vector<PlotLine> lines;
};
/// A plot, in which one choice at a time is shown.
struct PlotGroup {
  std::string title;
  std::vector<PlotChoice> choices;
};

/// All plots of a run.
struct Plots {
  std::vector<std::vector<float>> columns;
  std::vector<PlotGroup> groups;
};

/// The ledger of energy, regions, tracked bodies and points, the ledger of momentum. Of more than
/// 2000 rows only the least and the largest value of each of 1000 spans of time are kept, which
/// look the same. Throws ResultsError.
Plots read_plots(const RunFolder& run);

}  // namespace apothem
