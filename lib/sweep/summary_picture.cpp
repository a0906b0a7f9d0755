#include "lib/sweep/summary_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>

namespace apothem {
namespace {

// Where the values of the first path stand on the x axis: numbers at their places, others at 1, 2,
// ... in the order of the plan.
struct Abscissa {
  std::map<std::string, double> places;
  std::vector<std::string> names;  // of places 1, 2, ...; empty for numbers
};

Abscissa abscissa_of(const SummaryTable& table) {
  Abscissa result;
  const bool numbers = std::ranges::all_of(table.rows, [](const SummaryRow& row) {
    return nlohmann::json::parse(row.values.front()).is_number();
  });
  for (const SummaryRow& row : table.rows) {
    const std::string& value = row.values.front();
    if (numbers) {
      result.places[value] = nlohmann::json::parse(value).get<double>();
    } else if (result.places.emplace(value, result.names.size() + 1).second) {
      result.names.push_back(without_quotes(value));
    }
  }
  return result;
}

// The combination of all paths but the first.
std::string label_of(const SummaryTable& table, const SummaryRow& row) {
  const std::vector<std::string> names = short_names(table.paths);
  std::string label;
  for (size_t i = 1; i < names.size(); ++i) {
    label += fmt::format("{}{} = {}", i == 1 ? "" : ", ", names[i], without_quotes(row.values[i]));
  }
  return label;
}

std::string axis_label(const SummaryColumn& column) {
  switch (column.kind) {
    case SummaryColumn::Kind::mean:
      return "mean of " + column.measure;
    case SummaryColumn::Kind::proportion:
      return "proportion of " + column.measure;
    case SummaryColumn::Kind::rate:
      break;
  }
  return "rate of the event per " + column.measure;
}

void sort_by_x(Curve& curve) {
  std::vector<size_t> order(curve.x.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::ranges::stable_sort(order, [&](size_t i, size_t j) { return curve.x[i] < curve.x[j]; });
  for (std::vector<double>* values : {&curve.y, &curve.low, &curve.high, &curve.x}) {
    std::vector<double> sorted;
    sorted.reserve(order.size());
    for (const size_t i : order) sorted.push_back((*values)[i]);
    *values = std::move(sorted);
  }
}

// Limits of an axis on which gnuplot would find nothing but one value; else nothing, so that it
// chooses them itself.
std::optional<Vec2> limits_of(double low, double high) {
  if (low < high) return {};
  const double room = low == 0 ? 1 : 0.1 * std::abs(low);
  return Vec2(low - room, high + room);
}

void set_limits(CurvePanel& panel) {
  double left = HUGE_VAL, right = -HUGE_VAL, low = HUGE_VAL, high = -HUGE_VAL;
  for (const Curve& curve : panel.curves) {
    for (size_t i = 0; i < curve.x.size(); ++i) {
      left = std::min(left, curve.x[i]);
      right = std::max(right, curve.x[i]);
      low = std::min(low, curve.low[i]);
      high = std::max(high, curve.high[i]);
    }
  }
  panel.x_range = limits_of(left, right);
  panel.y_range = limits_of(low, high);
}

CurvePanel panel_of(const SummaryTable& table, size_t column, const Abscissa& abscissa) {
  CurvePanel panel;
  panel.x_label = table.paths.front();
  panel.y_label = axis_label(table.columns[column]);
  panel.x_names = abscissa.names;
  std::map<std::string, size_t> curves;
  for (const SummaryRow& row : table.rows) {
    const std::string label = label_of(table, row);
    const auto [place, added] = curves.emplace(label, panel.curves.size());
    if (added) {
      Curve& curve = panel.curves.emplace_back();
      curve.label = label;
      curve.style = CurveStyle::error_bars;
      curve.colour = static_cast<int>(place->second);
    }
    const SummaryCell& cell = row.cells[column];
    if (std::isnan(cell.value)) continue;
    // Without an interval, as of a single run, the bar has no length.
    const bool known = !std::isnan(cell.interval.low);
    Curve& curve = panel.curves[place->second];
    curve.x.push_back(abscissa.places.at(row.values.front()));
    curve.y.push_back(cell.value);
    curve.low.push_back(known ? cell.interval.low : cell.value);
    curve.high.push_back(known ? cell.interval.high : cell.value);
  }
  std::erase_if(panel.curves, [](const Curve& curve) { return curve.x.empty(); });
  for (Curve& curve : panel.curves) sort_by_x(curve);
  set_limits(panel);
  return panel;
}

}  // namespace

CurveFigure summary_figure(const SummaryTable& table) {
  CurveFigure figure{"Estimates with 95 % intervals", {}};
  if (table.paths.empty()) return figure;
  const Abscissa abscissa = abscissa_of(table);
  for (size_t c = 0; c < table.columns.size(); ++c) {
    CurvePanel panel = panel_of(table, c, abscissa);
    if (!panel.curves.empty()) figure.panels.push_back(std::move(panel));
  }
  return figure;
}

}  // namespace apothem
