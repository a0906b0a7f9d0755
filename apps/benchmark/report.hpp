// Private header: what `apothem benchmark` has measured, as lines, JSON, CSV and picture.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/benchmark/bench.hpp"
#include "lib/output/curves.hpp"

namespace apothem {

/// A case and what was measured of it.
struct CaseResult {
  BenchmarkCase benchmark;
  Timed timed;
};

/// What all cases share. Without limits, ratios to them are left out.
struct BenchmarkResults {
  std::optional<MachineLimits> limits;
  int threads = 1;
  std::vector<CaseResult> cases;
};

std::string table_heading();
/// A line for a case, and a second one if it tells more than its time.
std::string table_row(const CaseResult& result, const std::optional<MachineLimits>& limits);

/// How the time of a whole step or evaluation grows with the number of bodies or elements, in each
/// family of which several sizes were timed.
struct Growth {
  std::string family;
  double from, to;  ///< sizes
  double exponent;
};
std::vector<Growth> growths(const std::vector<CaseResult>& cases);

std::string benchmark_csv(const BenchmarkResults& results);
std::string benchmark_json(const BenchmarkResults& results);
/// Times over sizes, and the ratios to the machine's limits; without panels if there is nothing to
/// draw.
CurveFigure benchmark_figure(const BenchmarkResults& results);

}  // namespace apothem
