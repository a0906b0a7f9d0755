#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "apps/commands.hpp"
#include "apps/polygon/input.hpp"
#include "geometry/potential/point_values.hpp"
#include "lib/output/files.hpp"
#include "lib/scene/polygon_file.hpp"
#include "lib/text/csv.hpp"
#include "lib/text/decimal.hpp"
#include "lib/text/error.hpp"

namespace apothem {
namespace {

using Json = nlohmann::ordered_json;

double coordinate(const CsvRow& row, size_t column, const std::string& file) {
  if (column >= row.cells.size()) {
    throw SceneError(file, row.line, "", "has no y; write x,y in m in each row");
  }
  try {
    return parse_decimal(row.cells[column]);
  } catch (const BadNumber& error) {
    throw SceneError(file, row.line, "",
                     fmt::format("{}: {}", column == 0 ? "x" : "y", error.what()));
  }
}

// The first row may name the columns.
std::vector<Vec2> read_points(const std::string& file) {
  const std::vector<CsvRow> rows = read_csv(file);
  std::vector<Vec2> points;
  for (const CsvRow& row : rows) {
    const bool heading = &row == &rows.front() && row.cells.size() > 1 &&
                         row.cells[0].starts_with("x") && row.cells[1].starts_with("y");
    if (!heading) points.emplace_back(coordinate(row, 0, file), coordinate(row, 1, file));
  }
  if (points.empty()) throw SceneError(file, 0, "", "holds no points; write x,y in m in each row");
  return points;
}

Json to_json(const std::vector<Vec2>& points, const std::vector<PointValues>& values) {
  Json list = Json::array();
  for (size_t i = 0; i < points.size(); ++i) {
    const PointValues& v = values[i];
    list.push_back({{"point", {points[i].x(), points[i].y()}},
                    {"side", side_name(v.side)},
                    {"phi", v.phi},
                    {"gradient", {v.gradient.x(), v.gradient.y()}},
                    {"nearest_edge", v.nearest_edge},
                    {"signed_distance", v.signed_distance}});
  }
  return {{"points", list}};
}

std::string to_csv(const std::vector<Vec2>& points, const std::vector<PointValues>& values) {
  std::string text = csv_row({"x [m]", "y [m]", "side", "phi", "gradient_x [1/m]",
                              "gradient_y [1/m]", "nearest_edge", "signed_distance [m]"});
  for (size_t i = 0; i < points.size(); ++i) {
    const PointValues& v = values[i];
    text +=
        fmt::format("{},{},{},{},{},{},{},{}\n", points[i].x(), points[i].y(), side_name(v.side),
                    v.phi, v.gradient.x(), v.gradient.y(), v.nearest_edge, v.signed_distance);
  }
  return text;
}

}  // namespace

int evaluate_points(const PolygonOptions& options, const PotentialChoice& choice) {
  const Polygon polygon = polygon_of_file(options.file);
  const std::vector<Vec2> points = options.points.empty()
                                       ? std::vector{Vec2(options.at[0], options.at[1])}
                                       : read_points(options.points);
  std::vector<PointValues> values;
  try {
    const Potential potential = make_potential(polygon, choice);
    const PointEvaluator evaluate(polygon, potential);
    for (const Vec2& point : points) values.push_back(evaluate(point));
  } catch (const InvalidPolygon& error) {
    throw PolygonError(options.file, 0, std::string("the polygon is not usable: ") + error.what(),
                       error.vertex(), error.hole());
  }
  fmt::print("{}", options.json ? to_json(points, values).dump(2) + "\n" : to_csv(points, values));
  return exit_code::done;
}

}  // namespace apothem
