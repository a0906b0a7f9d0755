// Plots of the histories and ledgers of a run over time.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "lib/output/canvas.hpp"
#include "lib/output/curves.hpp"

namespace apothem {

/// What can be plotted: the ledgers; of history.csv, the bodies and points, or the regions.
inline constexpr std::array kRunPlots{"energy", "momentum", "history", "regions"};

/// The plot of that name of the run in a folder. If `columns` are given, only these: each is a name
/// as in the header of the file, or the part behind the last point of it. Columns that are constant
/// are left out unless they are asked for. Throws ResultsError.
CurveFigure plot_of(const std::string& folder, const std::string& plot,
                    const std::vector<std::string>& columns = {});

/// The figure as the bytes of a picture, or nothing if gnuplot is not installed. Throws
/// std::runtime_error if it fails.
std::optional<std::string> draw_curves(const CurveFigure& figure, PictureFormat format);

}  // namespace apothem
