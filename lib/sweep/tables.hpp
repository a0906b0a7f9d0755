// The tables of a study on disk: runs.csv, summary.csv and summary.png.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lib/output/gnuplot.hpp"
#include "lib/sweep/summary_table.hpp"

namespace apothem {

/// The text of runs.csv: a row for each run of the plan.
std::string runs_csv(const Plan& plan, const std::vector<RunRecord>& records);

/// The text of summary.csv: a row for each combination without the seeds. Estimates that cannot be
/// made are empty cells.
std::string summary_csv(const SummaryTable& table);

/// Writes both, and the picture as summary.png and summary.svg, into the folder of the study; each
/// replaces its predecessor at once, also if several processes do this at the same time. Returns
/// whether gnuplot has made the picture; nothing if there is nothing to draw. Throws SystemFailure,
/// and SceneError as summarise() does; runs.csv is written then.
std::optional<Plotted> write_tables(const Study& study, const std::vector<RunRecord>& records,
                                    const std::optional<SurvivalChoice>& survival);

}  // namespace apothem
