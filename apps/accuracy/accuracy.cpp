// apothem accuracy: compares speed and error of all methods for the contact force.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/accuracy/cases.hpp"
#include "apps/accuracy/methods.hpp"
#include "apps/cases/hard_pairs.hpp"
#include "apps/commands.hpp"
#include "lib/output/files.hpp"
#include "lib/output/gnuplot.hpp"
#include "lib/text/csv.hpp"
#include "lib/text/error.hpp"

namespace apothem {
namespace {

// An error above this share of W, the weight of the contact (see Errors), counts as a failure.
constexpr double kWrong = 1e-2;
// The goal: error of the force over the length of the own boundary inside the other polygon.
constexpr double kGoal = 1e-12;
// Place of the method that the times of all others are compared with.
constexpr size_t kEdge = 1;
static_assert(kAccuracyMethods[kEdge].name == "edge");

// The error figures of docs/theory.md for one pair, against the exact force F. W is the integral of
// phi over both boundaries inside the other polygon.
struct Errors {
  double of_weight = 0;  // |dF| / W, where W is at least kGoal times the own boundary length
  double of_length = 0;  // |dF| / own boundary length
  double scaled = 0;     // |dF| / |F| x depth / (eps X), with the pairs' size X
  double moment = 0;     // |dM| / (own boundary length x X)
};

Errors errors(const PreparedPair& pair, const PairIntegral& result, const PairIntegral& exact) {
  const double own = exact.own_length_a + exact.own_length_b;
  const double length = own > 0 ? own : pair.size;  // the polygons only touch
  const double error = (result.force - exact.force).norm();
  Errors e;
  e.of_weight = error / std::max(exact.weight, kGoal * length);
  e.of_length = error / length;
  if (exact.weight > 0) {
    // The mean depth of the boundary inside. Where the tractions cancel, W takes the place of |F|.
    const double depth =
        exact.weight / own / std::max(pair.potential_a.steepest, pair.potential_b.steepest);
    const double force = exact.force.norm();
    e.scaled = error / (force > .1 * exact.weight ? force : exact.weight) * depth /
               (std::numeric_limits<double>::epsilon() * pair.size);
  }
  e.moment = std::max(std::abs(result.moment_a - exact.moment_a),
                      std::abs(result.moment_b - exact.moment_b)) /
             (length * pair.size);
  return e;
}

struct Worst {
  double value = 0;
  std::string pair;
  void include(double x, const std::string& name) {
    if (!(x > value)) return;
    value = x;
    pair = name;
  }
};

struct Range {
  double least = std::nan(""), most = std::nan("");
  void include(double x) {
    least = std::fmin(least, x);
    most = std::fmax(most, x);
  }
  // Both ends to two digits, or one number where they agree to two digits.
  [[nodiscard]] std::string text() const {
    const std::string from = digits(least), to = digits(most);
    return from == to ? from : from + " to " + to;
  }

 private:
  static std::string digits(double x) {
    if (!(std::abs(x) > 0) || !std::isfinite(x)) return fmt::format("{}", x);
    const double unit = std::pow(10, std::floor(std::log10(std::abs(x))) - 1);
    return fmt::format("{:.4g}", std::round(x / unit) * unit);
  }
};

struct Row {
  std::string case_name;
  std::string_view method;
  bool random = false;  // random pairs, not hard ones
  size_t pairs = 0;
  int refused = 0;
  int failures = 0;
  Range time;                    // per pair, ns, of the repetitions
  Range ratio;                   // of this time to that of edge in the same repetition
  double median = 0, worst = 0;  // of |dF| / W
  Worst of_length, scaled;
};

class Accuracy {
 public:
  explicit Accuracy(const AccuracyOptions& options) : options_(options) {}

  int execute() {
    const std::vector<AccuracyCase> cases = accuracy_cases(options_.cases);
    if (std::ranges::all_of(cases, [](const AccuracyCase& c) { return c.pairs.empty(); })) {
      throw UsageError("accuracy", "no pair is left to evaluate");
    }
    create_folder(options_.folder);
    fmt::print("Errors of the force: of W, and of stiffness x own boundary length.\n");
    fmt::print("{:<20} {:<16} {:>5} {:>12} {:>12} {:>12} {:>12} {:>8}\n", "case", "method", "pairs",
               "ns per pair", "median of W", "worst of W", "of length", "failures");
    for (const AccuracyCase& c : cases) {
      if (!c.pairs.empty()) measure(c);
    }
    write_results(cases);
    return compared_ > agreed_ ? exit_code::missed : exit_code::done;
  }

 private:
  void measure(const AccuracyCase& c) {
    std::vector<AccuracyRun> runs;
    for (const AccuracyMethod& method : kAccuracyMethods) {
      runs.push_back(run_method(method.name, c.pairs));
    }
    compare_with_expected(c, runs[0]);
    // The methods take turns, so that what else the machine does meets all of them.
    std::vector<std::array<double, kAccuracyMethods.size()>> times(options_.repetitions);
    for (auto& turn : times) {
      for (size_t m = 0; m < turn.size(); ++m) {
        turn[m] = time_method(kAccuracyMethods[m].name, c.pairs, runs[m]);
      }
    }
    for (size_t m = 0; m < runs.size(); ++m) {
      Range time, ratio;
      for (const auto& turn : times) {
        time.include(turn[m]);
        ratio.include(turn[m] / turn[kEdge]);
      }
      add_row(c, kAccuracyMethods[m].name, runs[m], runs[0], time, ratio);
    }
    std::fflush(stdout);
  }

  void add_row(const AccuracyCase& c, std::string_view method, const AccuracyRun& run,
               const AccuracyRun& reference, const Range& time, const Range& ratio) {
    Row row{c.name, method, c.random, c.pairs.size(), c.refused, 0, time, ratio, 0, 0, {}, {}};
    std::vector<double> of_weight;
    for (size_t i = 0; i < c.pairs.size(); ++i) {
      const std::string& name = c.pairs[i].name;
      std::string status = run.outcomes[i].failure;
      Errors e;
      if (status.empty() && reference.outcomes[i].failure.empty()) {
        e = errors(c.pairs[i], run.outcomes[i].integral, reference.outcomes[i].integral);
        if (e.of_weight <= kWrong) {
          of_weight.push_back(e.of_weight);
          row.of_length.include(e.of_length, name);
          row.scaled.include(e.scaled, name);
        } else {
          status = "wrong";
        }
      } else if (status.empty()) {
        status = "no reference";
      }
      if (!status.empty() && status != "no reference") ++row.failures;
      pairs_ +=
          fmt::format("{},{},{},{},{},{},{},{}\n", csv_cell(name), csv_cell(c.name), method,
                      status.empty() ? "ok" : status, e.of_weight, e.of_length, e.scaled, e.moment);
    }
    row.median = row.worst = std::nan("");
    if (!of_weight.empty()) {
      std::ranges::sort(of_weight);
      row.median = of_weight[of_weight.size() / 2];
      row.worst = of_weight.back();
    }
    fmt::print("{:<20} {:<16} {:>5} {:>12.0f} {:>12.1e} {:>12.1e} {:>12.1e} {:>8}\n", row.case_name,
               row.method, row.pairs, row.time.least, row.median, row.worst, row.of_length.value,
               row.failures);
    rows_.push_back(row);
  }

  void compare_with_expected(const AccuracyCase& c, const AccuracyRun& reference) {
    for (size_t i = 0; i < c.pairs.size(); ++i) {
      if (!c.expected[i]) continue;
      const ExpectedContact& x = *c.expected[i];
      const AccuracyOutcome& r = reference.outcomes[i];
      const double size = c.pairs[i].size;
      const double length = x.own_length > 0 ? x.own_length : size;
      const double off = std::max({(r.integral.force - x.force).norm() / length,
                                   std::abs(r.integral.moment_a - x.moment_a) / (length * size),
                                   std::abs(r.integral.moment_b - x.moment_b) / (length * size),
                                   std::abs(r.volume.energy - x.energy) / (size * size),
                                   std::abs(r.volume.overlap_area - x.overlap_area) / (size * size),
                                   r.failure.empty() ? 0 : HUGE_VAL});
      ++compared_;
      if (off <= x.tolerance) {
        ++agreed_;
        furthest_ = std::max(furthest_, off);
      } else {
        fmt::print(stderr, "apothem: {}\n",
                   SceneError(c.pairs[i].name,
                              fmt::format("the expected values of the file are off by {:.2g}", off))
                       .what());
      }
    }
  }

  void write_results(const std::vector<AccuracyCase>& cases) {
    std::string table =
        "case,method,pairs,refused,failures,time [ns],median_error [W],worst_error [W],"
        "worst_error [own_length],worst_scaled_error [eps size/depth],largest_time [ns],"
        "least_ratio [time of edge],largest_ratio [time of edge]\n";
    for (const Row& r : rows_) {
      table +=
          fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{}\n", csv_cell(r.case_name), r.method,
                      r.pairs, r.refused, r.failures, r.time.least, r.median, r.worst,
                      r.of_length.value, r.scaled.value, r.time.most, r.ratio.least, r.ratio.most);
    }
    write_file(options_.folder + "/accuracy.csv", table);
    write_file(options_.folder + "/pairs.csv",
               "pair,case,method,status,error [W],error [own_length],"
               "scaled_error [eps size/depth],moment_error [own_length size]\n" +
                   pairs_);
    write_file(options_.folder + "/accuracy.gnuplot", plot_script());
    fmt::print("\n");
    for (const std::string_view method : {"edge", "overlap"}) print_goals(method);
    print_times();
    print_failures();
    if (compared_ > 0) {
      fmt::print("expected values: {} of {} agree with the reference, to {:.1g}\n", agreed_,
                 compared_, furthest_);
    }
    int refused = 0;
    for (const AccuracyCase& c : cases) refused += c.refused;
    if (refused > 0) fmt::print("refused pairs: {}\n", refused);
    const Plotted plotted = plot_with_gnuplot(options_.folder, "accuracy.gnuplot", "accuracy.png");
    fmt::print("results in {}: accuracy.csv, pairs.csv{}\n", options_.folder,
               plotted == Plotted::yes ? ", accuracy.png" : "");
    if (plotted == Plotted::no_gnuplot) {
      fmt::print("no picture: install gnuplot-nox, then run gnuplot accuracy.gnuplot in {}\n",
                 options_.folder);
    }
    if (plotted == Plotted::failed) {
      throw std::runtime_error(options_.folder + "/accuracy.png: gnuplot failed, see its message");
    }
  }

  void print_goals(std::string_view method) const {
    Worst of_length, scaled;
    int failures = 0;
    for (const Row& r : rows_) {
      if (r.method != method) continue;
      of_length.include(r.of_length.value, r.of_length.pair);
      scaled.include(r.scaled.value, r.scaled.pair);
      failures += r.failures;
    }
    fmt::print(
        "{}: worst |dF| / own boundary length {:.1e} ({}), worst scaled error {:.2g} ({}), {} "
        "failures\n",
        method, of_length.value, of_length.pair, scaled.value, scaled.pair, failures);
  }

  // Times of the random pairs, each method beside edge.
  void print_times() const {
    for (const Row& edge : rows_) {
      if (!edge.random || edge.method != kAccuracyMethods[kEdge].name) continue;
      fmt::print("{}: edge takes {} ns per pair", edge.case_name, edge.time.text());
      for (const Row& r : rows_) {
        if (r.case_name != edge.case_name || &r == &edge) continue;
        fmt::print(", {} {} times as long", r.method, r.ratio.text());
      }
      fmt::print("\n");
    }
  }

  // Failures on the pairs that are not random.
  void print_failures() const {
    std::string text;
    size_t pairs = 0;
    for (const AccuracyMethod& method : kAccuracyMethods) {
      int failures = 0;
      pairs = 0;
      for (const Row& r : rows_) {
        if (r.random || r.method != method.name) continue;
        failures += r.failures;
        pairs += r.pairs;
      }
      text += fmt::format("{}{} {}", text.empty() ? "" : ", ", method.name, failures);
    }
    fmt::print("failures on {} pairs that are not random: {}\n", pairs, text);
  }

  [[nodiscard]] std::string plot_script() const;

  const AccuracyOptions& options_;
  std::vector<Row> rows_;
  std::string pairs_;
  int compared_ = 0, agreed_ = 0;
  double furthest_ = 0;
};

std::string Accuracy::plot_script() const {
  std::string script = R"gp(# Speed against error of contact methods: gnuplot accuracy.gnuplot
if (!exists("output")) output = 'accuracy.png'
set terminal pngcairo size 1100,650 font 'DejaVu Sans,11' background 'white'
set output output
set datafile separator ','
set title "Contact force of two polygons: error against time, one dot per method and case"
set logscale xy
set format '10^{%T}'
set xlabel 'time per pair [ns]'
set ylabel 'worst error of the force [k_n × own boundary length]' noenhanced
set ytics add ("≤10^{-18}" 1e-18, 'failed' 1)
set yrange [2e-19:8]
set grid lc rgb '#cccccc' lt 1 lw .5
set border 3
set tics nomirror
set key outside right center reverse Left spacing 1.5 samplen 1
shown(e) = e > 1e-18 ? e : 1e-18
error(m) = (strcol(2) eq m ? shown(column(9)) : NaN)
failed(m) = (strcol(2) eq m && column(5) > 0 ? 1 : NaN)
plot )gp";
  script +=
      fmt::format("{} with lines lc rgb '#000000' dt 2 lw 1.5 title 'goal: 10^{{-12}}'", kGoal);
  // One colour per method, in the order of kAccuracyMethods.
  constexpr std::array kColours{"#777777", "#4477aa", "#228833", "#ee6677", "#aa3377", "#ccbb44"};
  for (size_t m = 0; m < kAccuracyMethods.size(); ++m) {
    const std::string_view name = kAccuracyMethods[m].name;
    int failures = 0;
    for (const Row& r : rows_) failures += r.method == name ? r.failures : 0;
    script += fmt::format(
        ", \\\n  'accuracy.csv' every ::1 using 6:(error('{0}')) with points pt 7 ps 1.3 lc rgb "
        "'{1}' title '{0}{2}', \\\n  '' every ::1 using 6:(failed('{0}')) with points pt 2 ps 1.5 "
        "lw 2 lc rgb '{1}' notitle",
        name, kColours[m], failures == 0 ? "" : fmt::format(" ({} failed)", failures));
  }
  return script + "\n";
}

// Writes the hard pairs with force and moments to 17 digits, one pair per line.
void write_cases(const std::string& file) {
  std::string text =
      "{\"about\": \"Hard pairs of polygons and their contact: distance potential, reference roof, "
      "unit "
      "stiffness, moments about the centroids, tolerance as a share of own_length. Expected values "
      "by the 100-digit oracle. Written by: apothem accuracy --write-cases FILE\",\n\"pairs\": [\n";
  std::vector<PreparedPair> pairs;
  std::vector<std::string> kinds;
  for (const HardPair& pair : hard_pairs()) {
    pairs.emplace_back(pair.name, pair.a, pair.b);
    kinds.push_back(pair.kind);
  }
  const auto ring = [](const Polygon& polygon) {
    std::string list;
    for (const Vec2& v : polygon.vertices()) {
      list += fmt::format("{}[{},{}]", list.empty() ? "" : ",", v.x(), v.y());
    }
    return "[" + list + "]";
  };
  const AccuracyRun exact = run_method(kAccuracyMethods[0].name, pairs);
  // Forces and moments that vanish do so to the last digit of the oracle only.
  const auto clean = [](double x, double scale) { return std::abs(x) < 1e-60 * scale ? 0 : x; };
  for (size_t i = 0; i < pairs.size(); ++i) {
    const PreparedPair& pair = pairs[i];
    const auto& [r, volume, failure] = exact.outcomes[i];
    if (!failure.empty()) throw std::runtime_error(pair.name + ": the oracle " + failure);
    // An error of one ulp in the coordinates changes phi by this much; it counts where it exceeds
    // the goal.
    const double tolerance =
        std::max(kGoal, std::numeric_limits<double>::epsilon() * pair.size *
                            std::max(pair.potential_a.steepest, pair.potential_b.steepest));
    text += fmt::format(
        "{{\"name\": \"{}\", \"kind\": \"{}\",\n \"a\": {},\n \"b\": {},\n \"expected\": "
        "{{\"force\": "
        "[{},{}], \"moment_a\": {}, \"moment_b\": {}, \"weight\": {}, \"energy\": {}, "
        "\"overlap_area\": {}, \"own_length\": {}, \"tolerance\": {:.2g}}}}}{}\n",
        pair.name, kinds[i], ring(pair.a), ring(pair.b), clean(r.force.x(), r.weight),
        clean(r.force.y(), r.weight), clean(r.moment_a, r.weight), clean(r.moment_b, r.weight),
        r.weight, volume.energy, volume.overlap_area, r.own_length_a + r.own_length_b, tolerance,
        i + 1 < pairs.size() ? "," : "");
  }
  write_file(file, text + "]}\n");
  fmt::print("{}: {} pairs\n", file, pairs.size());
}

}  // namespace

int accuracy_command(const AccuracyOptions& options) {
  if (!options.write_cases.empty()) {
    write_cases(options.write_cases);
    return exit_code::done;
  }
  return Accuracy(options).execute();
}

}  // namespace apothem
