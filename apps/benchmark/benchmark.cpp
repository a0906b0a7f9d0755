// apothem benchmark: times of kernels and scenes on this machine, or two builds of the program side
// by side.

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <regex>

#include "apps/benchmark/compare.hpp"
#include "apps/benchmark/report.hpp"
#include "apps/commands.hpp"
#include "apps/process/status_line.hpp"
#include "lib/output/files.hpp"

namespace apothem {
namespace {

constexpr double kSeconds = .1, kQuickSeconds = .01;  // of a repetition, at least

std::vector<BenchmarkCase> chosen_cases(const BenchmarkOptions& options) {
  std::vector<BenchmarkCase> cases = benchmark_cases();
  if (options.filter.empty()) {
    if (!options.list) std::erase_if(cases, [](const BenchmarkCase& c) { return c.on_request; });
    return cases;
  }
  std::regex filter;
  try {
    filter = std::regex(options.filter);
  } catch (const std::regex_error&) {
    throw UsageError("--filter", fmt::format("\"{}\" is no regular expression", options.filter));
  }
  std::erase_if(cases, [&](const BenchmarkCase& c) { return !std::regex_search(c.name, filter); });
  if (cases.empty()) {
    throw UsageError("--filter", fmt::format("\"{}\" finds no case; apothem benchmark --list "
                                             "names all of them",
                                             options.filter));
  }
  return cases;
}

int list_cases(const std::vector<BenchmarkCase>& cases, bool json) {
  if (json) {
    nlohmann::ordered_json list{{"cases", nlohmann::ordered_json::array()}};
    for (const BenchmarkCase& c : cases) {
      list["cases"].push_back(
          {{"name", c.name}, {"item", c.item}, {"about", c.about}, {"on_request", c.on_request}});
    }
    fmt::print("{}\n", list.dump(2));
    return exit_code::done;
  }
  for (const BenchmarkCase& c : cases) {
    fmt::print("{:<36} {:<10} {}{}\n", c.name, c.item, c.about,
               c.on_request ? " (only with --filter)" : "");
  }
  return exit_code::done;
}

void say_plotted(Plotted plotted, const std::string& folder, const std::string& table, bool quiet) {
  if (plotted == Plotted::failed) {
    throw std::runtime_error(folder + "/picture.gnuplot: gnuplot failed, see its message");
  }
  if (quiet) return;
  fmt::print("results in {}: {}{}\n", folder, table,
             plotted == Plotted::yes ? ", picture.png, picture.svg" : "");
  if (plotted == Plotted::no_gnuplot) {
    fmt::print("no picture: install gnuplot-nox, then run gnuplot picture.gnuplot in {}\n", folder);
  }
}

void write_results(const std::string& folder, const std::string& name, const std::string& table,
                   const CurveFigure& figure, bool quiet) {
  create_folder(folder);
  write_file(folder + "/" + name, table);
  if (figure.panels.empty()) {
    if (!quiet) fmt::print("results in {}: {}\n", folder, name);
    return;
  }
  std::vector<std::string> curves;
  say_plotted(write_curves(folder, figure, curves), folder, name, quiet);
}

int measure(const std::vector<BenchmarkCase>& cases, const BenchmarkOptions& options) {
  const Timing timing{options.repetitions, options.quick ? kQuickSeconds : kSeconds,
                      options.threads};
  BenchmarkResults results;
  results.threads = options.threads;
  // Of one core: they say nothing of several threads.
  if (options.threads == 1) results.limits = machine_limits(timing);
  if (!options.json) {
    if (results.limits) {
      fmt::print("one core of this machine: {:.3g} GB/s, {:.3g} GFlop/s\n\n",
                 1e-9 * results.limits->bandwidth, 1e-9 * results.limits->arithmetic);
    }
    fmt::print("{}", table_heading());
  }
  {
    StatusLine line;
    for (const BenchmarkCase& c : cases) {
      line.show(fmt::format("{} of {}: {}", results.cases.size() + 1, cases.size(), c.name));
      results.cases.push_back({c, time_case(c, timing)});
      line.clear();
      if (!options.json) fmt::print("{}", table_row(results.cases.back(), results.limits));
      std::fflush(stdout);
    }
  }
  if (options.json) {
    fmt::print("{}\n", benchmark_json(results));
  } else {
    const std::vector<Growth> all = growths(results.cases);
    if (!all.empty()) fmt::print("\n");
    for (const Growth& g : all) {
      fmt::print("{}: the whole time grows with the power {:.2f} of the size, {:g} to {:g}\n",
                 g.family, g.exponent, g.from, g.to);
    }
  }
  if (!options.folder.empty()) {
    write_results(options.folder, "benchmark.csv", benchmark_csv(results),
                  benchmark_figure(results), options.json);
  }
  return exit_code::done;
}

int compare(std::vector<BenchmarkCase> cases, const BenchmarkOptions& options) {
  const std::vector<std::string> known = cases_of(options.compare);
  std::vector<std::string> missing;
  std::erase_if(cases, [&](const BenchmarkCase& c) {
    if (std::ranges::find(known, c.name) != known.end()) return false;
    missing.push_back(c.name);
    return true;
  });
  for (const std::string& name : missing) {
    fmt::print(stderr, "apothem: warning: {} has no case {}\n", options.compare, name);
  }
  if (cases.empty()) throw UsageError("--compare", options.compare + " has none of these cases");
  std::vector<ComparedCase> compared;
  nlohmann::ordered_json json{{"cases", nlohmann::ordered_json::array()}};
  if (!options.json) fmt::print("{}", compared_heading());
  {
    StatusLine line;
    for (const BenchmarkCase& c : cases) {
      line.show(fmt::format("{} of {}: {}", compared.size() + 1, cases.size(), c.name));
      compared.push_back(compare_case(c, options));
      const ComparedCase& last = compared.back();
      line.clear();
      if (!options.json) fmt::print("{}", compared_row(last));
      std::fflush(stdout);
      json["cases"].push_back({{"name", last.name},
                               {"item", last.item},
                               {"here", last.here},
                               {"other", last.other},
                               {"ratio", last.ratio()}});
    }
  }
  if (options.json) fmt::print("{}\n", json.dump(2));
  if (!options.folder.empty()) {
    write_results(options.folder, "compare.csv", compared_csv(compared), compared_figure(compared),
                  options.json);
  }
  return exit_code::done;
}

}  // namespace

int benchmark_command(const BenchmarkOptions& options) {
  std::vector<BenchmarkCase> cases = chosen_cases(options);
  if (options.list) return list_cases(cases, options.json);
  return options.compare.empty() ? measure(cases, options) : compare(std::move(cases), options);
}

}  // namespace apothem
