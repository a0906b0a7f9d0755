#include "apps/benchmark/compare.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <nlohmann/json.hpp>

#include "apps/process/child_program.hpp"
#include "lib/text/csv.hpp"

namespace apothem {
namespace {

using Json = nlohmann::json;

// A regular expression that finds this name and no other.
std::string exactly(const std::string& name) {
  std::string pattern = "^";
  for (const char c : name) {
    if (std::strchr("\\^$.|?*+()[]{}", c) != nullptr) pattern += '\\';
    pattern += c;
  }
  return pattern + "$";
}

std::string last_line(std::string text) {
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return text.substr(text.rfind('\n') + 1);
}

double time_in(const std::string& program, const BenchmarkCase& benchmark,
               const BenchmarkOptions& options) {
  std::vector<std::string> words{
      program,    "benchmark", "--filter",  exactly(benchmark.name),
      "--repeat", "1",         "--threads", fmt::format("{}", options.threads),
      "--json"};
  if (options.quick) words.emplace_back("--quick");
  const ProgramResult result = run_program(words);
  const std::string who = program == kProgramItself ? "this program" : program;
  if (result.start_error != 0) {
    throw std::runtime_error(fmt::format("{}: {}", who, std::strerror(result.start_error)));
  }
  if (result.code != 0) {
    throw std::runtime_error(fmt::format("{} failed in {} ({}): {}", who, benchmark.name,
                                         result.code, last_line(result.err)));
  }
  try {
    return Json::parse(result.out).at("cases").at(0).at("median").get<double>();
  } catch (const Json::exception&) {
    throw std::runtime_error(fmt::format("{} printed no time of {}", who, benchmark.name));
  }
}

}  // namespace

double ComparedCase::ratio() const { return median_of(here) / median_of(other); }

std::vector<double> ComparedCase::ratios() const {
  std::vector<double> all;
  for (size_t i = 0; i < here.size(); ++i) all.push_back(here[i] / other[i]);
  std::ranges::sort(all);
  return all;
}

std::vector<std::string> cases_of(const std::string& program) {
  const ProgramResult result = run_program({program, "benchmark", "--list", "--json"});
  if (result.start_error != 0) {
    throw UsageError("--compare", fmt::format("\"{}\" cannot be run: {}", program,
                                              std::strerror(result.start_error)));
  }
  try {
    if (result.code != 0) throw UsageError("");
    std::vector<std::string> names;
    const Json list = Json::parse(result.out);
    for (const Json& entry : list.at("cases")) names.push_back(entry.at("name"));
    return names;
  } catch (const std::exception&) {
    throw UsageError("--compare",
                     fmt::format("\"{}\" has no command benchmark that lists cases", program));
  }
}

ComparedCase compare_case(const BenchmarkCase& benchmark, const BenchmarkOptions& options) {
  ComparedCase c{benchmark.name, benchmark.item, {}, {}};
  for (int turn = 0; turn < options.repetitions; ++turn) {
    for (const bool first : {true, false}) {
      const bool this_one = first == (turn % 2 == 0);
      const double time = time_in(this_one ? kProgramItself : options.compare, benchmark, options);
      (this_one ? c.here : c.other).push_back(time);
    }
  }
  return c;
}

std::string compared_heading() {
  return fmt::format("{:<36} {:<10} {:>12} {:>12} {:>8} {:>8} {:>8}\n", "case", "item",
                     "ns, this one", "ns, other", "ratio", "least", "largest");
}

std::string compared_row(const ComparedCase& c) {
  const std::vector<double> ratios = c.ratios();
  return fmt::format("{:<36} {:<10} {:>12.4g} {:>12.4g} {:>8.3f} {:>8.3f} {:>8.3f}\n", c.name,
                     c.item, median_of(c.here), median_of(c.other), c.ratio(), ratios.front(),
                     ratios.back());
}

std::string compared_csv(const std::vector<ComparedCase>& cases) {
  std::string text = csv_row({"case", "item", "turns", "median here [ns]", "median other [ns]",
                              "ratio", "least ratio", "largest ratio"});
  for (const ComparedCase& c : cases) {
    const std::vector<double> ratios = c.ratios();
    text += csv_row({c.name, c.item, fmt::format("{}", ratios.size()),
                     fmt::format("{}", median_of(c.here)), fmt::format("{}", median_of(c.other)),
                     fmt::format("{}", c.ratio()), fmt::format("{}", ratios.front()),
                     fmt::format("{}", ratios.back())});
  }
  return text;
}

CurveFigure compared_figure(const std::vector<ComparedCase>& cases) {
  CurvePanel panel;
  panel.title = "Below 1 this program is faster";
  panel.x_label = "case";
  panel.y_label = "time of this program / time of the other one";
  Curve bars;
  bars.style = CurveStyle::error_bars;
  for (const ComparedCase& c : cases) {
    const std::vector<double> ratios = c.ratios();
    panel.x_names.push_back(c.name);
    bars.x.push_back(static_cast<double>(panel.x_names.size()));
    bars.y.push_back(c.ratio());
    bars.low.push_back(ratios.front());
    bars.high.push_back(ratios.back());
  }
  panel.curves.push_back(std::move(bars));
  return {.title = "Ratio of the medians of alternating runs", .panels = {std::move(panel)}};
}

}  // namespace apothem
