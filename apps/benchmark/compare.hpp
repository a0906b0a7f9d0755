// Private header: two builds of the program, timed alternately.
#pragma once

#include <string>
#include <vector>

#include "apps/benchmark/bench.hpp"
#include "apps/commands.hpp"
#include "lib/output/curves.hpp"

namespace apothem {

/// A case that both programs have.
struct ComparedCase {
  std::string name, item;
  std::vector<double> here, other;  ///< ns, of each turn

  /// Median of this program's times over that of the other one's; below 1 this one is faster.
  [[nodiscard]] double ratio() const;
  /// The same of each turn by itself, in ascending order.
  [[nodiscard]] std::vector<double> ratios() const;
};

/// Names of the cases that a program has. Throws UsageError if it cannot be asked.
std::vector<std::string> cases_of(const std::string& program);

/// Times a case in both programs: as often as asked, first one and then the other, and the next
/// time the other way round. Throws std::runtime_error if a program fails.
ComparedCase compare_case(const BenchmarkCase& benchmark, const BenchmarkOptions& options);

std::string compared_heading();
std::string compared_row(const ComparedCase& c);
std::string compared_csv(const std::vector<ComparedCase>& cases);
CurveFigure compared_figure(const std::vector<ComparedCase>& cases);

}  // namespace apothem
