#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "apps/commands.hpp"
#include "apps/polygon/input.hpp"
#include "lib/output/files.hpp"
#include "lib/scene/shape_repair.hpp"
#include "lib/text/error.hpp"

namespace apothem {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kGap = 1e-6;  // of the extent

struct Report {
  std::vector<PolygonWithHoles> polygons;
  std::vector<std::string> faults;
  int left_out = 0;
  double hausdorff_distance = 0;
};

double extent_of(const std::vector<DrawnShape>& shapes) {
  Box box;
  for (const DrawnShape& shape : shapes) {
    for (const auto& ring : shape.rings) box.include(box_of(ring));
  }
  return std::max(0.0, box.extent());
}

void leave_out(const DrawnShape& shape, const std::string& what, Report& report) {
  report.faults.push_back(fmt::format("{}: {}; left out", place_of(shape), what));
  ++report.left_out;
}

void add(const DrawnShape& shape, double gap, double tolerance, Report& report) {
  using Kind = DrawnShape::Kind;
  if (shape.kind == Kind::unsupported) return leave_out(shape, shape.remark, report);
  if (shape.kind != Kind::line && shape.kind != Kind::area) return;  // not an outline
  if (shape.kind == Kind::line && gap_of(shape) > gap) {
    const Vec2& end = shape.rings[0].back();
    const std::string what =
        fmt::format("the line is open, {:.3g} m between its ends at ({}, {}) m", gap_of(shape),
                    end.x(), end.y());
    return leave_out(shape, what, report);
  }
  if (shape.kind == Kind::line && gap_of(shape) > 0) {
    report.faults.push_back(
        fmt::format("{}: the line is open, closed over {:.3g} m", place_of(shape), gap_of(shape)));
  }
  RepairedShape repaired = repair_shape(shape, tolerance);
  report.faults.insert(report.faults.end(), repaired.faults.begin(), repaired.faults.end());
  if (repaired.result.polygons.empty()) return leave_out(shape, "it surrounds nothing", report);
  report.hausdorff_distance =
      std::max(report.hausdorff_distance, repaired.result.hausdorff_distance);
  for (PolygonWithHoles& polygon : repaired.result.polygons) {
    report.polygons.push_back(std::move(polygon));
  }
}

void print(const Report& report, const PolygonOptions& options, FILE* to) {
  for (const std::string& fault : report.faults) fmt::print(to, "{}\n", fault);
  size_t holes = 0;
  for (const PolygonWithHoles& polygon : report.polygons) holes += polygon.holes.size();
  fmt::print(to,
             "{}: {} fault{}, {} left out; {} polygon{} with {} hole{}, {} m^2; Hausdorff distance "
             "of the simplification {:.3g} m\n",
             options.file, report.faults.size(), report.faults.size() == 1 ? "" : "s",
             report.left_out, report.polygons.size(), report.polygons.size() == 1 ? "" : "s", holes,
             holes == 1 ? "" : "s", area_of(report.polygons), report.hausdorff_distance);
}

}  // namespace

int repair_outlines(const PolygonOptions& options) {
  const ShapeFormat format =
      options.output.empty() ? ShapeFormat::wkt : shape_format_of(options.output);
  const std::vector<DrawnShape> shapes = read_shapes(options.file);
  const double gap = options.tolerance.value_or(kGap * extent_of(shapes));
  Report report;
  for (const DrawnShape& shape : shapes) {
    if (shape.hidden) continue;
    try {
      add(shape, gap, options.tolerance.value_or(0), report);
    } catch (const InvalidPolygon& error) {
      throw PolygonError(options.file, 0, fmt::format("{}: {}", place_of(shape), error.what()),
                         error.vertex());
    }
  }
  if (report.polygons.empty()) {
    throw SceneError(
        options.file, 0, "",
        fmt::format("holds no outline that can be repaired{}{}; draw closed polylines or "
                    "polygons, or raise --tolerance (m)",
                    report.faults.empty() ? "" : ": ",
                    report.faults.empty() ? "" : report.faults.front()));
  }
  const std::string text = shape_text(shapes_of(report.polygons), format);
  if (!options.output.empty()) write_file(options.output, text);
  if (options.json) {
    const Json object{{"faults", report.faults},
                      {"left_out", report.left_out},
                      {"area", area_of(report.polygons)},
                      {"hausdorff_distance", report.hausdorff_distance},
                      {"polygons", Json::parse(polygons_json(report.polygons))}};
    fmt::print("{}\n", object.dump(2, ' ', false, Json::error_handler_t::replace));
    return exit_code::done;
  }
  if (options.output.empty()) fmt::print("{}", text);
  print(report, options, options.output.empty() ? stderr : stdout);
  return exit_code::done;
}

}  // namespace apothem
