#include "lib/output/run_plot.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <set>

#include "lib/output/files.hpp"
#include "lib/output/run_folder.hpp"
#include "lib/text/file.hpp"

namespace apothem {
namespace {

constexpr size_t kMostCurves = 12;  // of a panel: more cannot be told apart
constexpr double kNoChange = 1e-9;  // of the largest change of a column of that unit
constexpr size_t kSolidCurves = 6;  // of curves; further curves are dashed

double spread_of(const std::vector<double>& values) {
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  return *most - *least;
}

// By how much the columns of each unit change: changes far below are round-off. A turn is large if
// it is a radian.
std::map<std::string, double> changes_of(const HistoryTable& table) {
  std::map<std::string, double> changes;
  for (size_t i = 1; i < table.names.size(); ++i) {
    double& most = changes[table.units[i]];
    most = std::max(most, spread_of(table.columns[i]));
  }
  const double duration = spread_of(table.columns[0]);
  changes["rad"] = std::max(changes["rad"], 1.);
  if (duration > 0) changes["rad/s"] = std::max(changes["rad/s"], 1 / duration);
  return changes;
}

// Collects curves: a panel for each key, in the order in which they come.
class Panels {
 public:
  Panels(const HistoryTable& table, const std::vector<std::string>& wanted)
      : table_(table), wanted_(wanted), changes_(changes_of(table)) {}

  /// `label`: of the curve in its panel.
  void add(size_t column, const std::string& key, const std::string& label) {
    const std::string& name = table_.names[column];
    const bool asked = std::ranges::any_of(
        wanted_, [&](const std::string& w) { return w == name || w == ColumnName(name).quantity; });
    candidates_.push_back(name);
    if (asked) found_.insert(name), found_.insert(ColumnName(name).quantity);
    if (wanted_.empty() ? !changes(column) : !asked) return;
    const auto [place, is_new] = place_of_.try_emplace(key, panels_.size());
    if (is_new) {
      CurvePanel& panel = panels_.emplace_back();
      panel.x_label = "time [s]";
      const std::string& unit = table_.units[column];
      panel.y_label = unit == "1" ? key : fmt::format("{} [{}]", key, unit);
    }
    CurvePanel& panel = panels_[place->second];
    const size_t number = panel.curves.size();
    if (number == kMostCurves) {
      panel.title = fmt::format("{}: the first {}; choose others with --columns", key, kMostCurves);
      return;
    }
    panel.curves.push_back({label, number < kSolidCurves ? CurveStyle::line : CurveStyle::dashed,
                            static_cast<int>(number), table_.columns[0], table_.columns[column]});
  }

  /// Throws ResultsError if nothing is left to plot; `file` is where it should be.
  std::vector<CurvePanel> finish(const std::string& file) {
    for (const std::string& name : wanted_) {
      if (found_.count(name) == 0) {
        throw ResultsError(fmt::format("{}: there is no column \"{}\" to plot here, but {}", file,
                                       name, fmt::join(candidates_, ", ")));
      }
    }
    if (panels_.empty()) {
      throw ResultsError(file + ": nothing in it changes; choose a column with --columns");
    }
    return std::move(panels_);
  }

 private:
  // The errors of a ledger are small and count all the same.
  [[nodiscard]] bool changes(size_t column) const {
    const double change = spread_of(table_.columns[column]);
    if (table_.names[column].ends_with("_error")) return change > 0;
    return change > kNoChange * changes_.at(table_.units[column]);
  }

  const HistoryTable& table_;
  const std::vector<std::string>& wanted_;
  std::map<std::string, double> changes_;
  std::vector<CurvePanel> panels_;
  std::map<std::string, size_t> place_of_;
  std::set<std::string> found_;
  std::vector<std::string> candidates_;
};

std::string in_words(std::string column) {
  std::ranges::replace(column, '_', ' ');
  return column;
}

// What does not balance has a panel of its own, because it should be far smaller than the rest.
void add_ledger(const HistoryTable& table, Panels& panels) {
  for (size_t i = 1; i < table.names.size(); ++i) {
    const std::string& name = table.names[i];
    const bool error = name.ends_with("_error");
    const bool energy = table.units[i] == "J";
    const std::string key = energy                        ? "energy"
                            : name.starts_with("angular") ? "angular momentum"
                                                          : "momentum";
    panels.add(i, error ? "error of " + key : key, in_words(name));
  }
}

void add_history(const HistoryTable& table, bool of_regions, const std::string& file,
                 Panels& panels) {
  const std::set<std::string> regions = table.regions();
  bool any = false;
  for (size_t i = 1; i < table.names.size(); ++i) {
    const ColumnName name(table.names[i]);
    if ((regions.count(name.owner) > 0) != of_regions) continue;
    panels.add(i, name.quantity, name.owner);
    any = true;
  }
  if (any) return;
  throw ResultsError(file + (of_regions ? ": has no regions; the scene records those that it has "
                                          "under \"regions\""
                                        : ": has no bodies or points; the scene records those that "
                                          "it has under \"track\" of \"output.history\""));
}

}  // namespace

CurveFigure plot_of(const std::string& folder, const std::string& plot,
                    const std::vector<std::string>& columns) {
  const bool ledger = plot == "energy" || plot == "momentum";
  const std::string name = ledger ? plot + ".csv" : "history.csv";
  const HistoryTable table = read_table(folder, name);
  const std::string file = folder + "/" + name;
  if (table.columns[0].empty()) throw ResultsError(file + ": has no rows yet");
  Panels panels(table, columns);
  if (ledger) {
    add_ledger(table, panels);
  } else {
    add_history(table, plot == "regions", file, panels);
  }
  return {folder_title(folder) + ": " + plot, panels.finish(file)};
}

std::optional<std::string> draw_curves(const CurveFigure& figure, PictureFormat format) {
  const TemporaryFolder folder;
  std::vector<std::string> files;
  switch (write_curves(folder.path(), figure, files)) {
    case Plotted::no_gnuplot:
      return std::nullopt;
    case Plotted::failed:
      throw std::runtime_error("gnuplot has failed, or the disk of temporary files is full");
    case Plotted::yes:
      break;
  }
  return read_bytes(folder.path() +
                    (format == PictureFormat::png ? "/picture.png" : "/picture.svg"));
}

}  // namespace apothem
