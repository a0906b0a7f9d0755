#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "output/files.hpp"
#include "output/frames.hpp"
#include "scene/error.hpp"
#include "scene/polygon_file.hpp"

namespace apothem {
namespace {

using Json = nlohmann::json;

std::string rows(const std::vector<Vec2>& points) {
  std::string text;
  for (const Vec2& p : points) {
    text += (text.empty() ? "" : ",\n") + Json{p.x(), p.y()}.dump();
  }
  return "[\n" + text + "\n]";
}

std::string rows(const std::vector<std::vector<int>>& cells) {
  std::string text;
  for (const std::vector<int>& cell : cells) {
    text += (text.empty() ? "" : ",\n") + Json(cell).dump();
  }
  return "[\n" + text + "\n]";
}

std::string summary(const Polygon& region, const VoronoiMesh& voronoi, const PolygonMesh& mesh) {
  double shortest = HUGE_VAL, longest = 0;
  double smallest = HUGE_VAL, largest = 0, sum = 0;
  for (const std::vector<int>& cell : mesh.cells) {
    const Polygon polygon(cell_ring(mesh, cell));
    for (int i = 0; i < polygon.size(); ++i) {
      const double length = (polygon.after(i) - polygon[i]).norm();
      shortest = std::min(shortest, length);
      longest = std::max(longest, length);
    }
    const double area = area_moments(polygon).area;
    smallest = std::min(smallest, area);
    largest = std::max(largest, area);
    sum += area;
  }
  const double whole = area_moments(region).area;
  const double mean = whole / static_cast<double>(mesh.cells.size());
  std::string text;
  const auto say = [&](const char* what, const std::string& value) {
    text += fmt::format("{:<12} {}\n", what, value);
  };
  say("cells", fmt::format("{}, {} nodes", mesh.cells.size(), mesh.points.size()));
  say("Lloyd", fmt::format("{} steps, last movement {:.2g} of the cell size", voronoi.lloyd_steps,
                           voronoi.last_movement / std::sqrt(mean)));
  say("edges", fmt::format("{:.6g} m to {:.6g} m; {} collapsed, {} short ones left", shortest,
                           longest, voronoi.short_edges.collapsed, voronoi.short_edges.left));
  say("areas", fmt::format("{:.6g} m^2 to {:.6g} m^2, mean {:.6g} m^2", smallest, largest, mean));
  say("area defect", fmt::format("{:.2g} of the region", std::abs(sum - whole) / whole));
  if (voronoi.joined_pieces > 0) {
    say("joined",
        fmt::format("{} pieces that the outline cuts from their cell", voronoi.joined_pieces));
  }
  return text;
}

}  // namespace

int mesh_command(const MeshOptions& options) {
  if (!options.output.empty() && options.output == options.vtk) {
    throw SceneError(options.vtk, 0, "", "is given for JSON and for VTK; give two names");
  }
  try {
    const Polygon region(read_polygon_file(options.region));
    const VoronoiMesh voronoi = voronoi_mesh(region, options.voronoi);
    const PolygonMesh mesh = in_world(region, voronoi.mesh);
    const std::string json =
        fmt::format("{{\n\"region\": {},\n\"points\": {},\n\"cells\": {}\n}}\n",
                    rows(region.vertices()), rows(mesh.points), rows(mesh.cells));
    if (!options.output.empty()) write_file(options.output, json);
    if (!options.vtk.empty()) write_mesh(options.vtk, mesh);
    if (options.output.empty()) fmt::print("{}", json);
    fmt::print(options.output.empty() ? stderr : stdout, "{}", summary(region, voronoi, mesh));
  } catch (const InvalidPolygon& error) {
    throw SceneError(options.region, 0, "", fmt::format("the region {}", error.what()));
  } catch (const std::invalid_argument& error) {
    throw SceneError("mesh", 0, "", error.what());
  }
  return exit_code::done;
}

}  // namespace apothem
