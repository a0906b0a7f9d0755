#include "geometry/regions/boolean.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "apps/commands.hpp"
#include "apps/polygon/input.hpp"
#include "lib/output/files.hpp"
#include "lib/scene/polygon_file.hpp"

namespace apothem {
namespace {

using Json = nlohmann::ordered_json;

BooleanOperation operation_of(const std::string& name) {
  for (const NamedOperation& known : kBooleanOperations) {
    if (name == known.name) return known.operation;
  }
  throw UsageError("boolean", fmt::format("no operation \"{}\"", name));
}

}  // namespace

int boolean_command(const BooleanOptions& options) {
  const ShapeFormat format =
      options.output.empty() ? ShapeFormat::wkt : shape_format_of(options.output);
  const std::vector<PolygonWithHoles> result = boolean_operation(
      polygon_of_file(options.a), polygon_of_file(options.b), operation_of(options.operation));
  const std::string text = shape_text(shapes_of(result), format);
  if (!options.output.empty()) write_file(options.output, text);
  if (options.json) {
    const Json object{{"operation", options.operation},
                      {"area", area_of(result)},
                      {"polygons", Json::parse(polygons_json(result))}};
    fmt::print("{}\n", object.dump(2));
    return exit_code::done;
  }
  size_t holes = 0;
  for (const PolygonWithHoles& polygon : result) holes += polygon.holes.size();
  if (options.output.empty()) fmt::print("{}", text);
  fmt::print(options.output.empty() ? stderr : stdout, "{}: {} polygon{} with {} hole{}, {} m^2\n",
             options.operation, result.size(), result.size() == 1 ? "" : "s", holes,
             holes == 1 ? "" : "s", area_of(result));
  return exit_code::done;
}

}  // namespace apothem
