#include "lib/output/history.hpp"

#include <fmt/compile.h>
#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>

#include "lib/model/columns.hpp"
#include "lib/system/input_file.hpp"
#include "lib/text/csv.hpp"

namespace apothem {
namespace {

constexpr size_t kLongEnough = 1 << 16;  // bytes of rows that are worth a system call

template <class... Numbers>
void add_row(std::string& rows, double time, const Numbers&... numbers) {
  // The format {} gives the shortest text that reads back to the same double.
  fmt::format_to(std::back_inserter(rows), FMT_COMPILE("{}"), time);
  (fmt::format_to(std::back_inserter(rows), FMT_COMPILE(",{}"), numbers), ...);
  rows += '\n';
}

// The largest pressure on a surface, and twice the root of the pressure-weighted mean square
// distance from the pressure's centre, which for the elliptic pressure of Hertz is the half-width.
struct Pressed {
  double pressure = 0, half_width = 0;
};
Pressed pressed(const std::vector<SurfaceRecord>& surfaces, int body) {
  Pressed result;
  double whole = 0;
  Vec2 centre = Vec2::Zero();
  for (const SurfaceRecord& s : surfaces) {
    if (s.body != body) continue;
    const double force = s.pressure * (s.to - s.from).norm();
    result.pressure = std::max(result.pressure, s.pressure);
    whole += force;
    centre += force * (s.from + s.to) / 2;
  }
  if (!(whole > 0)) return result;
  centre /= whole;
  double square = 0;
  for (const SurfaceRecord& s : surfaces) {
    if (s.body != body) continue;
    const double length = (s.to - s.from).norm();
    const double mean = ((s.from + s.to) / 2 - centre).squaredNorm() + length * length / 12;
    square += s.pressure * length * mean;
  }
  result.half_width = 2 * std::sqrt(square / whole);
  return result;
}

template <class Columns>
std::string header(const Columns& columns) {
  std::string row = "time [s]";
  for (const auto& column : columns) {
    row += ',' + csv_cell(fmt::format("{} [{}]", column.name, column.unit));
  }
  return row + '\n';
}

}  // namespace

std::string history_header(const Model& model, const OutputSettings& settings) {
  return header(history_columns(model, settings));
}

HistoryWriter::HistoryWriter(const std::string& folder, const Model& model,
                             const OutputSettings& settings, const Parts& parts)
    : model_(model),
      settings_(settings),
      history_{AppendedFile(folder + "/history.csv", parts[0]), ""},
      energy_{AppendedFile(folder + "/energy.csv", parts[1]), ""},
      momentum_{AppendedFile(folder + "/momentum.csv", parts[2]), ""} {
  if (parts[0].size > 0) return;
  energy_.rows = header(kEnergyColumns);
  momentum_.rows = header(kMomentumColumns);
  history_.rows = history_header(model, settings);
  flush();
}

void HistoryWriter::add(const State& state, const Energies& e, const Momenta& p,
                        const Observed& observed) {
  std::string& rows = history_.rows;
  fmt::format_to(std::back_inserter(rows), FMT_COMPILE("{}"), state.time);
  const auto add_body = [&](BodyIndex body) {
    const ObservedBody record{
        motion_of(model_, state, body, observed.contact[body], observed.node_mass),
        observed.bodies[static_cast<size_t>(body)]};
    for (const BodyQuantity& quantity : kBodyQuantities) {
      if (!quantity.in_histories()) continue;
      fmt::format_to(std::back_inserter(rows), FMT_COMPILE(",{}"), quantity.value(record)[0]);
    }
  };
  for (const RigidIndex i : settings_.track) add_body(i);
  for (const DeformableIndex i : settings_.track_deformables) {
    add_body(static_cast<BodyIndex>(model_.bodies.size()) + i);
  }
  for (const int i : settings_.track_surfaces) {
    const Pressed contact = pressed(observed.surfaces, static_cast<int>(model_.bodies.size()) + i);
    fmt::format_to(std::back_inserter(rows), FMT_COMPILE(",{},{}"), contact.pressure,
                   contact.half_width);
  }
  for (size_t i = 0; i < settings_.points.size(); ++i) {
    const TrackedPoint& point = settings_.points[i];
    std::array<double, 4> value{};
    for (size_t k = 0; k < point.nodes.size(); ++k) {
      for (int axis = 0; axis < 2; ++axis) {
        const auto at = static_cast<size_t>(axis);
        value[at] += point.weights[k] * state.node(point.nodes[k])[axis];
        value[2 + at] += point.weights[k] * state.node_velocity(point.nodes[k])[axis];
      }
    }
    const CauchyStress& s = observed.stress[i];
    const auto [major, minor] = principal_stresses(s);
    fmt::format_to(std::back_inserter(rows), FMT_COMPILE(",{},{},{},{},{},{},{},{},{}"), value[0],
                   value[1], value[2], value[3], s.xx, s.yy, s.xy, major, minor);
  }
  for (const RegionSums& sums : observed.regions) {
    for (const RegionQuantity& quantity : kRegionQuantities) {
      fmt::format_to(std::back_inserter(rows), FMT_COMPILE(",{}"), quantity.value(sums));
    }
  }
  rows += '\n';
  add_row(energy_.rows, state.time, e.kinetic, e.strain, e.contact, e.gravity, e.friction_loss,
          e.damping_loss, e.numerical_loss, e.external_work, e.total_error);
  add_row(momentum_.rows, state.time, p.x, p.y, p.angular, p.x_error, p.y_error, p.angular_error);
  if (rows.size() > kLongEnough) flush();
}

void HistoryWriter::flush() {
  for (Table* table : {&history_, &energy_, &momentum_}) {
    std::string rows;
    rows.swap(table->rows);
    table->file.append(rows);
  }
}

void HistoryWriter::make_last() {
  flush();
  for (const Table* table : {&history_, &energy_, &momentum_}) table->file.make_last();
}

const std::vector<double>* HistoryTable::column(const std::string& name) const {
  for (size_t i = 0; i < names.size(); ++i) {
    if (names[i] == name) return &columns[i];
  }
  return nullptr;
}

ColumnName::ColumnName(const std::string& column) : quantity(column) {
  const size_t point = column.rfind('.');
  if (point == std::string::npos) return;
  owner = column.substr(0, point);
  quantity = column.substr(point + 1);
}

std::set<std::string> HistoryTable::regions() const {
  std::set<std::string> regions;
  for (const std::string& column : names) {
    const ColumnName name(column);
    if (name.quantity == "count") regions.insert(name.owner);
  }
  return regions;
}

HistoryTable read_history(const std::string& file) {
  const std::string refusal = refusal_of_input(file);
  if (!refusal.empty()) throw std::runtime_error(file + ": " + refusal);
  std::ifstream stream(file);
  std::string line;
  if (!std::getline(stream, line)) throw std::runtime_error(file + ": cannot be read");
  HistoryTable table;
  for (const std::string& cell : csv_cells(line, file, 1)) {
    const size_t unit = cell.find(" [");
    table.names.push_back(cell.substr(0, unit));
    table.units.push_back(
        unit == std::string::npos ? "" : cell.substr(unit + 2, cell.rfind(']') - unit - 2));
  }
  table.columns.resize(table.names.size());
  if (line.empty()) throw std::runtime_error(file + ": has no names of columns");
  for (int number = 2; std::getline(stream, line) && !stream.eof(); ++number) {
    // Rows are many, and hold what the program writes of a run that has become unstable: inf and
    // nan.
    const char* at = line.data();
    const char* const end = at + line.size();
    for (std::vector<double>& column : table.columns) {
      double value = 0;
      const auto [next, error] = std::from_chars(at, end, value);
      const bool last = &column == &table.columns.back();
      if (error != std::errc() || (last ? next != end : next == end || *next != ',')) {
        throw std::runtime_error(
            fmt::format("{}:{}: is not a row of {} numbers", file, number, table.columns.size()));
      }
      column.push_back(value);
      at = next + 1;
    }
  }
  return table;
}

HistoryTable read_history_of(const std::string& folder, const std::string& column) {
  for (const char* name : kHistoryFiles) {
    HistoryTable table = read_history(folder + "/" + name);
    if (table.column(column)) return table;
  }
  throw std::runtime_error("no history has a column " + column);
}

namespace {

// The parabola through a row and its neighbours.
struct Parabola {
  double left, right;  // slopes to the neighbours
  double curvature;
  double slope;  // at the row
};
Parabola parabola_at(const std::vector<double>& t, const std::vector<double>& y, size_t i) {
  const double left = (y[i] - y[i - 1]) / (t[i] - t[i - 1]);
  const double right = (y[i + 1] - y[i]) / (t[i + 1] - t[i]);
  const double curvature = (right - left) / (t[i + 1] - t[i - 1]);
  return {left, right, curvature, left + curvature * (t[i] - t[i - 1])};
}

// The extreme value of the parabola through row i and its neighbours, if the column bends there
// much as it does a row before and after; otherwise, and at the ends of the table, the value of the
// row itself. A parabola through a jump or a kink has extremes that never occurred.
double refined(const std::vector<double>& t, const std::vector<double>& y, size_t i) {
  constexpr double kAlike = 0.5;
  if (i == 0 || i + 1 == y.size()) return y[i];
  const Parabola at = parabola_at(t, y, i);
  if (!(at.left * at.right < 0)) return y[i];
  const auto bends_alike = [&](size_t row) {
    if (row == 0 || row + 1 == y.size()) return true;
    return parabola_at(t, y, row).curvature / at.curvature >= kAlike;
  };
  if (!bends_alike(i - 1) || !bends_alike(i + 1)) return y[i];
  return y[i] - at.slope * at.slope / (4 * at.curvature);
}

// Over time, between rows by the trapezoid rule.
double mean(const std::vector<double>& t, const std::vector<double>& y, size_t from, size_t until) {
  if (until - from < 2) return y[from];
  double sum = 0;
  for (size_t i = from + 1; i < until; ++i) sum += (t[i] - t[i - 1]) * (y[i] + y[i - 1]) / 2;
  return sum / (t[until - 1] - t[from]);
}

// Of the line of least squares; 0 for a single row.
double slope(const std::vector<double>& t, const std::vector<double>& y, size_t from,
             size_t until) {
  const auto count = static_cast<double>(until - from);
  double mean_t = 0, mean_y = 0;
  for (size_t i = from; i < until; ++i) mean_t += t[i] / count, mean_y += y[i] / count;
  double tt = 0, ty = 0;
  for (size_t i = from; i < until; ++i) {
    tt += (t[i] - mean_t) * (t[i] - mean_t);
    ty += (t[i] - mean_t) * (y[i] - mean_y);
  }
  return tt > 0 ? ty / tt : 0;
}

}  // namespace

double reduce(const Reduction& reduction, const std::string& folder) {
  const HistoryTable table = read_history_of(folder, reduction.quantity);
  const std::vector<double>& t = table.columns.front();
  const std::vector<double>& y = *table.column(reduction.quantity);
  size_t from = 0;
  size_t until = t.size();
  while (reduction.from && from < until && t[from] < *reduction.from) ++from;
  while (reduction.until && until > from && t[until - 1] > *reduction.until) --until;
  if (from == until) {
    throw std::runtime_error("no row of " + reduction.quantity + " in the window");
  }
  const auto [least, most] = std::minmax_element(y.begin() + static_cast<std::ptrdiff_t>(from),
                                                 y.begin() + static_cast<std::ptrdiff_t>(until));
  const auto minimum = [&, at = static_cast<size_t>(least - y.begin())] {
    return reduction.jumps ? y[at] : refined(t, y, at);
  };
  const auto maximum = [&, at = static_cast<size_t>(most - y.begin())] {
    return reduction.jumps ? y[at] : refined(t, y, at);
  };
  switch (reduction.take) {
    case Reduction::Take::first:
      return y[from];
    case Reduction::Take::last:
      return y[until - 1];
    case Reduction::Take::minimum:
      return minimum();
    case Reduction::Take::maximum:
      return maximum();
    case Reduction::Take::largest:
      return std::max(-minimum(), maximum());
    case Reduction::Take::mean:
      return mean(t, y, from, until);
    case Reduction::Take::increase:
      return y[until - 1] - y[from];
    case Reduction::Take::decrease:
      return y[from] - y[until - 1];
    case Reduction::Take::slope:
      return slope(t, y, from, until);
  }
  return 0;
}

Outcome evaluate(const Expectation& expectation, const std::string& folder) {
  const double value = reduce(expectation, folder);
  return {value, std::abs(value - expectation.value) <= expectation.tolerance};
}

}  // namespace apothem
