// The runs of a study by what was varied, repetitions with different seeds taken together.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "lib/sweep/record.hpp"
#include "lib/sweep/statistics.hpp"

namespace apothem {

/// A measure that runs of a study have.
struct MeasureName {
  std::string name;
  bool yes_no;  ///< each value is yes, no or missing; or else a number
};

/// The measures of all records, in the order in which they first appear.
std::vector<MeasureName> measure_names(const std::vector<RunRecord>& records);

/// An exponential fit of survival: see RateEstimate.
struct SurvivalChoice {
  std::string measure;  ///< exposure, a number measure
  std::string event;    ///< yes/no measure: whether the event has happened; empty: always
};

/// One column of estimates.
struct SummaryColumn {
  enum class Kind : std::uint8_t { mean, proportion, rate };
  Kind kind;
  std::string measure;
};

/// The estimate of one column for one combination.
struct SummaryCell {
  size_t n = 0;        ///< values
  size_t missing = 0;  ///< runs without a value
  size_t count = 0;    ///< of yes, or of events
  double value = 0;    ///< mean, proportion or rate; NaN if it cannot be estimated, as are these:
  double standard_error = 0;  ///< of a mean
  Interval interval{};        ///< 95 %
};

/// The runs that differ only in seeds.
struct SummaryRow {
  std::vector<std::string> values;  ///< JSON, one for each path
  size_t runs = 0, done = 0;
  std::vector<SummaryCell> cells;  ///< one for each column
};

struct SummaryTable {
  std::vector<std::string> paths;  ///< of the plan, without those of seeds
  std::vector<SummaryColumn> columns;
  std::vector<SummaryRow> rows;  ///< in the order of the plan
};

/// `records`: one for each run of the plan; only those of runs that are done have values. Throws
/// SceneError if the measures of the survival are not there, are of the wrong kind, or if an
/// exposure is negative.
SummaryTable summarise(const Plan& plan, const std::vector<RunRecord>& records,
                       const std::optional<SurvivalChoice>& survival);

}  // namespace apothem
