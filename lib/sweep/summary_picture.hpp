// The picture of a study: estimates with their intervals.
#pragma once

#include "lib/output/curves.hpp"
#include "lib/sweep/summary_table.hpp"

namespace apothem {

/// One panel for each column, over the first path; one line for each combination of the others. It
/// has no panels if nothing but seeds varies, or if there are no measures.
CurveFigure summary_figure(const SummaryTable& table);

}  // namespace apothem
