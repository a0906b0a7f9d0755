#include "apps/reproduce/tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "lib/sweep/statistics.hpp"
#include "lib/text/decimal.hpp"
#include "lib/text/words.hpp"

namespace apothem {
namespace {

using Kind = TableSource::Kind;

// A name of a column without its unit, as "time" for "time [s]".
std::string without_unit(const std::string& name) { return name.substr(0, name.find(" [")); }

// Whether a cell has that content; a * at its end stands for anything.
bool fits(const std::string& cell, const std::string& content) {
  if (!content.ends_with('*')) return cell == content;
  return cell.starts_with(content.substr(0, content.size() - 1));
}

class Table {
 public:
  explicit Table(const std::string& file) : file_(file), rows_(read_csv(file)) {
    if (rows_.empty()) throw SceneError(file, "is empty");
  }

  [[nodiscard]] size_t column(const std::string& name) const {
    const std::vector<std::string>& names = rows_.front().cells;
    std::vector<std::string> known;
    for (size_t i = 0; i < names.size(); ++i) {
      if (names[i] == name || without_unit(names[i]) == name) return i;
      known.push_back(without_unit(names[i]));
    }
    throw SceneError(file_, 1, "", "there is no column " + suggest(name, known));
  }

  /// The rows that a source chooses.
  [[nodiscard]] std::vector<const CsvRow*> chosen(const TableSource& source) const {
    std::vector<std::pair<size_t, const std::vector<std::string>*>> conditions;
    for (const auto& [name, contents] : source.where)
      conditions.emplace_back(column(name), &contents);
    std::vector<const CsvRow*> rows;
    for (size_t i = 1; i < rows_.size(); ++i) {
      const auto meets = [&](const auto& condition) {
        const std::string& cell = this->cell(rows_[i], condition.first);
        return std::ranges::any_of(*condition.second,
                                   [&](const std::string& content) { return fits(cell, content); });
      };
      if (std::ranges::all_of(conditions, meets)) rows.push_back(&rows_[i]);
    }
    return rows;
  }

  [[nodiscard]] const std::string& cell(const CsvRow& row, size_t column) const {
    if (column < row.cells.size()) return row.cells[column];
    throw SceneError(file_, row.line, "", "has fewer cells than the first row");
  }

  /// A number, or the one behind the last slash, as in the names of benchmarks; yes and no are 1
  /// and 0. NaN if the cell is empty.
  [[nodiscard]] double number(const CsvRow& row, size_t column) const {
    const std::string& whole = cell(row, column);
    const std::string text = whole.substr(whole.rfind('/') + 1);
    if (text.empty() || text == "nan") return std::nan("");
    if (text == "true" || text == "false") return text == "true" ? 1 : 0;
    try {
      return parse_decimal(text);
    } catch (const BadNumber& bad) {
      throw SceneError(file_, row.line, "", bad.what());
    }
  }

 private:
  std::string file_;
  std::vector<CsvRow> rows_;
};

TablePoint share_point(double x, size_t events, size_t trials) {
  const ProportionEstimate e = estimate_proportion(events, trials);
  return {x,
          e.proportion,
          e.interval.low,
          e.interval.high,
          static_cast<double>(trials),
          static_cast<double>(events)};
}

TablePoint point_of(Kind kind, double x, const std::vector<double>& values) {
  if (kind == Kind::share) {
    const auto is_true = [](double v) { return v != 0; };
    const auto events = std::ranges::count_if(values, is_true);
    return share_point(x, static_cast<size_t>(events), values.size());
  }
  const MeanEstimate e = estimate_mean(values);
  const bool interval = std::isfinite(e.interval.low);
  return {x, e.mean, interval ? e.interval.low : e.mean, interval ? e.interval.high : e.mean, 0, 0};
}

void axis_of(const JsonReader& in, JsonObject& object, const std::string& key,
             TableSource::Axis& axis) {
  axis.column = in.string(object.required(key, "a column"));
  object.read(key + "_offset", axis.offset, &JsonReader::number, "");
  object.read(key + "_scale", axis.scale, &JsonReader::number, "");
  if (const JsonValue* v = object.optional(key + "_absolute")) axis.absolute = v->boolean();
}

std::string path_of(const TableSource& source, const std::string& data,
                    const std::string& studies) {
  return (source.of_study ? studies : data) + "/" + source.file;
}

void require_columns(const TableSource& source, const std::string& file) {
  const Table table(file);
  for (const std::string* name : {&source.x.column, &source.y.column, &source.of}) {
    if (!name->empty()) static_cast<void>(table.column(*name));
  }
  if (table.chosen(source).empty()) throw SceneError(file, "has no row that is asked for");
}

}  // namespace

double TableSource::Axis::shown(double value) const {
  const double result = (value + offset) * scale;
  return absolute ? std::abs(result) : result;
}

bool is_table_source(const JsonValue& curve) { return curve.find("study") || curve.find("table"); }

TableSource read_table_source(const JsonReader& in, JsonObject& object, const std::string& data) {
  TableSource source;
  const JsonValue* study = object.optional("study");
  const JsonValue* table = object.optional("table");
  if (!study == !table) {
    in.fail(object.value(), "must give either \"study\" or \"table\", the file of a table");
  }
  source.of_study = study != nullptr;
  source.file = in.string(study ? *study : *table);
  if (const JsonValue* v = object.optional("where")) {
    for (size_t i = 0; i < v->keys().size(); ++i) {
      auto& [column, contents] = source.where.emplace_back();
      column = v->keys()[i];
      const JsonValue& item = v->items()[i];
      if (item.type() != JsonValue::Type::array) {
        contents = {in.string(item)};
      } else {
        for (const JsonValue& one : item.items()) contents.push_back(in.string(one));
      }
    }
  }
  object.choose("take", source.kind, {"value", "share", "counts", "mean"});
  axis_of(in, object, "x", source.x);
  axis_of(in, object, "y", source.y);
  if (source.kind == Kind::counts) {
    source.of = in.string(object.required("of", "column with the number of trials"));
  }
  if (table) {
    try {
      require_columns(source, path_of(source, data, {}));
    } catch (const SceneError& error) {
      in.fail(*table, error.what());
    }
  }
  return source;
}

std::vector<TablePoint> points_of(const TableSource& source, const std::string& data,
                                  const std::string& studies) {
  const std::string file = path_of(source, data, studies);
  const Table table(file);
  const size_t x = table.column(source.x.column), y = table.column(source.y.column);
  std::vector<TablePoint> points;
  std::map<double, std::vector<double>> groups;
  for (const CsvRow* row : table.chosen(source)) {
    const double at = source.x.shown(table.number(*row, x));
    const double value = source.y.shown(table.number(*row, y));
    if (std::isnan(at) || std::isnan(value)) continue;
    if (source.kind == Kind::value) {
      points.push_back({at, value, value, value});
    } else if (source.kind == Kind::counts) {
      const double trials = table.number(*row, table.column(source.of));
      points.push_back(share_point(at, static_cast<size_t>(value), static_cast<size_t>(trials)));
    } else {
      groups[at].push_back(value);
    }
  }
  for (const auto& [at, values] : groups) points.push_back(point_of(source.kind, at, values));
  if (points.empty()) throw SceneError(file, "has no row with the values that are shown");
  std::ranges::stable_sort(points,
                           [](const TablePoint& a, const TablePoint& b) { return a.x < b.x; });
  return points;
}

TableComparison read_comparison(const JsonReader& in, const JsonValue& value,
                                const std::string& data) {
  JsonObject object(in, value);
  TableComparison result;
  result.label = in.string(object.required("label", "what is compared"));
  result.kind = in.choice<TableComparison::Kind>(object.required("state", "what is stated"),
                                                 {"difference", "ratio", "order"});
  for (auto& [key, source] : {std::pair("first", &result.first), {"second", &result.second}}) {
    JsonObject side(in, object.required(key, "a table"));
    *source = read_table_source(in, side, data);
    side.finish();
  }
  object.read("at", result.name_of_x, &JsonReader::string);
  result.expected = read_expected(in, object);
  object.finish();
  return result;
}

std::vector<ReportNumber> numbers_of(const TableComparison& c, const std::string& data,
                                     const std::string& studies) {
  const std::vector<TablePoint> first = points_of(c.first, data, studies);
  const std::vector<TablePoint> second = points_of(c.second, data, studies);
  std::vector<ReportNumber> numbers;
  const auto state = [&](const std::string& what, double value) {
    numbers.push_back(c.expected.beside("", what, "1", value));
  };
  size_t common = 0, at_least = 0;
  for (const TablePoint& a : first) {
    const auto found = std::ranges::find_if(
        second, [&](const TablePoint& b) { return std::abs(b.x - a.x) <= 1e-9 * std::abs(a.x); });
    if (found == second.end()) continue;
    const TablePoint& b = *found;
    ++common;
    at_least += a.y >= b.y;
    const std::string where = fmt::format("{}, {} = {:g}", c.label, c.name_of_x, a.x);
    if (c.kind == TableComparison::Kind::ratio) state(where, a.y / b.y);
    if (c.kind != TableComparison::Kind::difference) continue;
    const auto count = [](double number) { return static_cast<size_t>(std::lround(number)); };
    state(fmt::format("{}: {} of {} and {} of {}, probability if both are the same (Fisher)", where,
                      a.events, a.trials, b.events, b.trials),
          same_proportion(count(a.events), count(a.trials), count(b.events), count(b.trials)));
  }
  if (c.kind == TableComparison::Kind::order && common > 0) {
    state(fmt::format("{}, part of {} common {}", c.label, common, c.name_of_x),
          static_cast<double>(at_least) / static_cast<double>(common));
  }
  if (common == 0) {
    throw SceneError(path_of(c.first, data, studies),
                     "has no x in common with " + path_of(c.second, data, studies));
  }
  return numbers;
}

}  // namespace apothem
