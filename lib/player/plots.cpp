#include "lib/player/plots.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "lib/text/words.hpp"

namespace apothem {
namespace {

constexpr size_t kSpans = 1000;

// Rows that are kept of a column, see read_plots; of the time their ends.
std::vector<float> thinned(const std::vector<double>& values, bool is_time, double offset = 0) {
  std::vector<float> kept;
  const auto keep = [&](double value) { kept.push_back(static_cast<float>(value - offset)); };
  if (values.size() <= 2 * kSpans) {
    for (const double value : values) keep(value);
    return kept;
  }
  for (size_t i = 0; i < kSpans; ++i) {
    const auto begin = values.begin() + static_cast<std::ptrdiff_t>(values.size() * i / kSpans);
    const auto end = values.begin() + static_cast<std::ptrdiff_t>(values.size() * (i + 1) / kSpans);
    auto [least, most] = std::minmax_element(begin, end);
    if (is_time) least = begin, most = end - 1;
    if (most < least) std::swap(least, most);
    keep(*least);
    keep(*most);
  }
  return kept;
}

// Values that differ little have the digits of their differences only without what they have in
// common.
double offset_of(const std::vector<double>& values) {
  constexpr double kFar = 1e3;
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  const double size = std::max(std::abs(*least), std::abs(*most));
  return size > kFar * (*most - *least) ? *least : 0;
}

bool is_zero(const std::vector<double>& values) {
  return std::ranges::all_of(values, [](double v) { return v == 0; });
}

// A file of histories and where its columns are among those of the plots.
class Source {
 public:
  Source(const RunFolder& run, const char* file, Plots& plots) : plots_(plots) {
    table_.columns.resize(1);
    if (!run.has(file)) return;
    table_ = run.table(file);
    if (table_.columns[0].empty()) return;
    time_ = plots_.columns.size();
    plots_.columns.push_back(thinned(table_.columns[0], true));
  }
  [[nodiscard]] size_t columns() const {
    return table_.columns[0].empty() ? 0 : table_.names.size();
  }
  [[nodiscard]] const std::string& name(size_t column) const { return table_.names[column]; }
  [[nodiscard]] const std::string& unit(size_t column) const { return table_.units[column]; }
  [[nodiscard]] std::set<std::string> regions() const { return table_.regions(); }
  [[nodiscard]] bool has_values(size_t column) const { return !is_zero(table_.columns[column]); }
  PlotLine line(size_t column, std::string label) {
    const double offset = offset_of(table_.columns[column]);
    plots_.columns.push_back(thinned(table_.columns[column], false, offset));
    return {std::move(label), time_, plots_.columns.size() - 1, offset};
  }

 private:
  HistoryTable table_;
  Plots& plots_;
  size_t time_ = 0;
};

// Ledgers: a choice for each unit, and one for each column of what is unaccounted for.
void add_ledger(Source source, const std::string& title, Plots& plots) {
  PlotGroup group{title, {}};
  const std::string balance = lower_case(title);
  const auto choice = [&](const std::string& name, const std::string& unit) -> PlotChoice& {
    for (PlotChoice& known : group.choices) {
      if (known.title == name && known.unit == unit) return known;
    }
    return group.choices.emplace_back(PlotChoice{name, unit, {}});
  };
  for (size_t c = 1; c < source.columns(); ++c) {
    if (!source.has_values(c)) continue;
    const std::string& name = source.name(c);
    const bool error = name.ends_with("error");
    choice(error ? "unaccounted for" : balance, source.unit(c))
        .lines.push_back(source.line(c, name));
  }
  if (!group.choices.empty()) plots.groups.push_back(std::move(group));
}

// Columns OWNER.quantity, of regions or of all else: a choice for each quantity, with a line for
// each owner.
void add_histories(Source& source, const std::string& title, bool of_regions, Plots& plots) {
  PlotGroup group{title, {}};
  const std::set<std::string> regions = source.regions();
  std::map<std::string, size_t> choice_of;
  for (size_t c = 1; c < source.columns(); ++c) {
    const ColumnName name(source.name(c));
    if (name.owner.empty() || (regions.count(name.owner) > 0) != of_regions) continue;
    const auto [known, added] = choice_of.try_emplace(name.quantity, group.choices.size());
    if (added) group.choices.push_back({name.quantity, source.unit(c), {}});
    group.choices[known->second].lines.push_back(source.line(c, name.owner));
  }
  if (!group.choices.empty()) plots.groups.push_back(std::move(group));
}

}  // namespace

Plots read_plots(const RunFolder& run) {
  Plots plots;
  add_ledger(Source(run, "energy.csv", plots), "Energy", plots);
  Source history(run, "history.csv", plots);
  add_histories(history, "Regions", true, plots);
  add_histories(history, "Tracked bodies and points", false, plots);
  add_ledger(Source(run, "momentum.csv", plots), "Momentum", plots);
  return plots;
}

}  // namespace apothem
