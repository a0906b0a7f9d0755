#include "apps/benchmark/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "lib/text/csv.hpp"
#include "version.hpp"

namespace apothem {
namespace {

constexpr double kNanoseconds = 1e9;
constexpr double kGiga = 1e-9;

std::string family_of(const BenchmarkCase& c) { return c.name.substr(0, c.name.rfind('/')); }

// What a case makes of the machine's limits, if it knows its bytes and operations.
struct Use {
  std::optional<double> bandwidth, arithmetic;        // per s
  std::optional<double> of_bandwidth, of_arithmetic;  // of the limits
};

Use use_of(const CaseResult& r, const std::optional<MachineLimits>& limits) {
  Use use;
  const double time = r.timed.median();
  if (r.timed.bytes > 0) use.bandwidth = r.timed.bytes / time;
  if (r.timed.operations > 0) use.arithmetic = r.timed.operations / time;
  if (!limits) return use;
  if (use.bandwidth) use.of_bandwidth = *use.bandwidth / limits->bandwidth;
  if (use.arithmetic) use.of_arithmetic = *use.arithmetic / limits->arithmetic;
  return use;
}

std::string percent(const std::optional<double>& share) {
  return share ? fmt::format("{:.3g} %", 100 * *share) : "";
}

// Four digits, without the power of ten where there need be none.
std::string four_digits(double x) {
  return x >= 1000 && x < 1e9 ? fmt::format("{:.0f}", x) : fmt::format("{:.4g}", x);
}

// The families of which several sizes were timed, in their order.
std::vector<std::vector<const CaseResult*>> families(const std::vector<CaseResult>& cases) {
  std::vector<std::vector<const CaseResult*>> found;
  for (const CaseResult& r : cases) {
    if (!(r.benchmark.size > 0)) continue;
    const auto same = std::ranges::find_if(found, [&](const auto& family) {
      return family_of(family.front()->benchmark) == family_of(r.benchmark);
    });
    if (same == found.end()) {
      found.push_back({&r});
    } else {
      same->push_back(&r);
    }
  }
  std::erase_if(found, [](const auto& family) { return family.size() < 2; });
  return found;
}

Curve with_bars(const std::string& label, size_t colour) {
  Curve curve;
  curve.label = label;
  curve.style = CurveStyle::error_bars;
  curve.colour = static_cast<int>(colour);
  return curve;
}

void add_point(Curve& curve, double x, double y, double low, double high) {
  curve.x.push_back(x), curve.y.push_back(y);
  curve.low.push_back(low), curve.high.push_back(high);
}

CurvePanel growth_panel(const std::vector<CaseResult>& cases, const std::string& item) {
  CurvePanel panel;
  panel.title = "Time over size";
  panel.x_label = fmt::format("number of {}", item == "body" ? "bodies" : item + "s");
  panel.y_label = fmt::format("time per {} [ns]", item);
  panel.x_logarithmic = panel.y_logarithmic = true;
  for (const auto& family : families(cases)) {
    if (family.front()->benchmark.item != item) continue;
    Curve curve = with_bars(family_of(family.front()->benchmark), panel.curves.size());
    for (const CaseResult* r : family) {
      add_point(curve, r->benchmark.size, kNanoseconds * r->timed.median(),
                kNanoseconds * r->timed.least(), kNanoseconds * r->timed.largest());
    }
    panel.curves.push_back(std::move(curve));
  }
  return panel;
}

// Operations per second over operations per byte, below what the machine can do (S. Williams,
// A. Waterman, D. Patterson, Comm. ACM 52 (2009) 65-76).
CurvePanel roofline_panel(const std::vector<CaseResult>& cases, const MachineLimits& limits) {
  CurvePanel panel;
  panel.title = "Arithmetic of one core, and its limits";
  panel.x_label = "operations per byte of memory";
  panel.y_label = "GFlop/s";
  panel.x_logarithmic = panel.y_logarithmic = true;
  const double ridge = limits.arithmetic / limits.bandwidth;
  Curve roof;
  roof.label = "limit";
  roof.style = CurveStyle::dashed;
  for (const double x : {ridge / 30, ridge, 10 * ridge}) {
    roof.x.push_back(x);
    roof.y.push_back(kGiga * std::min(limits.arithmetic, x * limits.bandwidth));
  }
  for (const CaseResult& r : cases) {
    const double operations = r.timed.operations;
    if (!(r.timed.bytes > 0) || !(operations > 0)) continue;
    // The largest of a family: the smaller ones lie beside it, and may fit into the caches.
    const bool larger_follows = std::ranges::any_of(cases, [&](const CaseResult& o) {
      return family_of(o.benchmark) == family_of(r.benchmark) &&
             o.benchmark.size > r.benchmark.size;
    });
    if (larger_follows) continue;
    Curve curve = with_bars(r.benchmark.name, panel.curves.size() + 1);
    add_point(curve, operations / r.timed.bytes, kGiga * operations / r.timed.median(),
              kGiga * operations / r.timed.largest(), kGiga * operations / r.timed.least());
    panel.curves.push_back(std::move(curve));
  }
  if (!panel.curves.empty()) panel.curves.push_back(std::move(roof));
  return panel;
}

}  // namespace

std::string table_heading() {
  return fmt::format("{:<36} {:<10} {:>10} {:>10} {:>10} {:>10} {:>9} {:>10}\n", "case", "item",
                     "ns, median", "least", "largest", "items/s", "of memory", "of arithm.");
}

std::string table_row(const CaseResult& r, const std::optional<MachineLimits>& limits) {
  const Use use = use_of(r, limits);
  std::string text = fmt::format(
      "{:<36} {:<10} {:>10} {:>10} {:>10} {:>10.3g} {:>9} {:>10}\n", r.benchmark.name,
      r.benchmark.item, four_digits(kNanoseconds * r.timed.median()),
      four_digits(kNanoseconds * r.timed.least()), four_digits(kNanoseconds * r.timed.largest()),
      1 / r.timed.median(), percent(use.of_bandwidth), percent(use.of_arithmetic));
  std::string more;
  for (const NamedExtra& named : kExtras) {
    for (const Extra& e : r.timed.extras) {
      if (e.name != named.name) continue;
      const bool share = named.unit == "share";
      more += fmt::format("{}{} {:.3g}{}", more.empty() ? "" : ", ", e.name,
                          share ? 100 * e.value : e.value,
                          share                ? " %"
                          : named.unit.empty() ? ""
                                               : fmt::format(" {}", named.unit));
    }
  }
  return more.empty() ? text : text + "    " + more + "\n";
}

std::vector<Growth> growths(const std::vector<CaseResult>& cases) {
  std::vector<Growth> all;
  for (const auto& family : families(cases)) {
    const auto [first, last] = std::minmax_element(
        family.begin(), family.end(),
        [](const auto* a, const auto* b) { return a->benchmark.size < b->benchmark.size; });
    const double from = (*first)->benchmark.size, to = (*last)->benchmark.size;
    const double each = (*last)->timed.median() / (*first)->timed.median();
    all.push_back(
        {family_of((*first)->benchmark), from, to, 1 + std::log(each) / std::log(to / from)});
  }
  return all;
}

std::string benchmark_csv(const BenchmarkResults& results) {
  std::string text =
      "case,item,size,threads,repetitions,median [ns],least [ns],largest [ns],rate [1/s],"
      "bytes per item,operations per item,bandwidth [GB/s],arithmetic [GFlop/s],"
      "of bandwidth limit,of arithmetic limit";
  for (const NamedExtra& named : kExtras) {
    text += fmt::format(",{}", named.name);
    if (!named.unit.empty()) text += fmt::format(" [{}]", named.unit);
  }
  text += "\n";
  const auto cell = [](const std::optional<double>& x, double scale = 1) {
    return x ? fmt::format("{}", scale * *x) : "";
  };
  const auto known = [](double x) { return x > 0 ? std::optional(x) : std::nullopt; };
  for (const CaseResult& r : results.cases) {
    const Use use = use_of(r, results.limits);
    std::vector<std::string> row{r.benchmark.name,
                                 r.benchmark.item,
                                 cell(known(r.benchmark.size)),
                                 fmt::format("{}", results.threads),
                                 fmt::format("{}", r.timed.times.size()),
                                 cell(r.timed.median(), kNanoseconds),
                                 cell(r.timed.least(), kNanoseconds),
                                 cell(r.timed.largest(), kNanoseconds),
                                 cell(1 / r.timed.median()),
                                 cell(known(r.timed.bytes)),
                                 cell(known(r.timed.operations)),
                                 cell(use.bandwidth, kGiga),
                                 cell(use.arithmetic, kGiga),
                                 cell(use.of_bandwidth),
                                 cell(use.of_arithmetic)};
    for (const NamedExtra& named : kExtras) {
      const auto& extras = r.timed.extras;
      const auto found =
          std::ranges::find_if(extras, [&](const Extra& e) { return e.name == named.name; });
      row.push_back(found == extras.end() ? "" : cell(found->value));
    }
    text += csv_row(row);
  }
  return text;
}

std::string benchmark_json(const BenchmarkResults& results) {
  nlohmann::ordered_json json{{"version", kVersion}, {"threads", results.threads}};
  if (results.limits) {
    json["limits"] = {{"bandwidth", results.limits->bandwidth},
                      {"arithmetic", results.limits->arithmetic}};
  }
  json["cases"] = nlohmann::ordered_json::array();
  for (const CaseResult& r : results.cases) {
    std::vector<double> times = r.timed.times;
    for (double& t : times) t *= kNanoseconds;
    nlohmann::ordered_json entry{{"name", r.benchmark.name},
                                 {"item", r.benchmark.item},
                                 {"times", times},
                                 {"median", kNanoseconds * r.timed.median()},
                                 {"rate", 1 / r.timed.median()}};
    if (r.benchmark.size > 0) entry["size"] = r.benchmark.size;
    if (r.timed.bytes > 0) entry["bytes"] = r.timed.bytes;
    if (r.timed.operations > 0) entry["operations"] = r.timed.operations;
    const Use use = use_of(r, results.limits);
    if (use.of_bandwidth) entry["of_bandwidth"] = *use.of_bandwidth;
    if (use.of_arithmetic) entry["of_arithmetic"] = *use.of_arithmetic;
    for (const Extra& e : r.timed.extras) entry["extras"][std::string(e.name)] = e.value;
    json["cases"].push_back(std::move(entry));
  }
  for (const Growth& g : growths(results.cases)) {
    json["growth"].push_back(
        {{"family", g.family}, {"from", g.from}, {"to", g.to}, {"exponent", g.exponent}});
  }
  return json.dump(2);
}

CurveFigure benchmark_figure(const BenchmarkResults& results) {
  CurveFigure figure;
  figure.title = fmt::format("apothem {} benchmark", kVersion);
  for (const char* item : {"body", "element", "cell"}) {
    CurvePanel panel = growth_panel(results.cases, item);
    if (!panel.curves.empty()) figure.panels.push_back(std::move(panel));
  }
  if (results.limits) {
    CurvePanel panel = roofline_panel(results.cases, *results.limits);
    if (!panel.curves.empty()) figure.panels.push_back(std::move(panel));
  }
  return figure;
}

}  // namespace apothem
