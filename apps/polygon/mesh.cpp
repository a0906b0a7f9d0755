#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "apps/commands.hpp"
#include "apps/polygon/input.hpp"
#include "geometry/meshing/cell_shapes.hpp"
#include "lib/mesh/boundary.hpp"
#include "lib/mesh/fill_mesh.hpp"
#include "lib/mesh/measure.hpp"
#include "lib/output/files.hpp"
#include "lib/output/polygon_vtk.hpp"
#include "lib/scene/mesh_file.hpp"
#include "lib/scene/polygon_file.hpp"
#include "lib/text/error.hpp"
#include "lib/text/words.hpp"

namespace apothem {
namespace {

std::string rows(const std::vector<Vec2>& points) {
  std::string text;
  for (const Vec2& p : points) {
    text += (text.empty() ? "" : ",\n") + nlohmann::json{p.x(), p.y()}.dump();
  }
  return "[\n" + text + "\n]";
}

std::string rows(const std::vector<std::vector<int>>& cells) {
  std::string text;
  for (const std::vector<int>& cell : cells) {
    text += (text.empty() ? "" : ",\n") + nlohmann::json(cell).dump();
  }
  return "[\n" + text + "\n]";
}

std::string line(const char* what, const std::string& value) {
  return fmt::format("{:<12} {}\n", what, value);
}

std::string range(double from, double to, const char* unit) {
  return fmt::format("{0:.6g} {2} to {1:.6g} {2}", from, to, unit);
}

constexpr double kDegree = std::numbers::pi / 180;

std::string degrees(double smallest, double largest) {
  return range(smallest / kDegree, largest / kDegree, "degrees");
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
  const auto say = [&](const char* what, const std::string& value) { text += line(what, value); };
  say("cells", fmt::format("{}, {} nodes", mesh.cells.size(), mesh.points.size()));
  say("Lloyd", fmt::format("{} steps, last movement {:.2g} of the cell size", voronoi.lloyd_steps,
                           voronoi.last_movement / std::sqrt(mean)));
  say("edges", fmt::format("{}; {} collapsed, {} short ones left", range(shortest, longest, "m"),
                           voronoi.short_edges.collapsed, voronoi.short_edges.left));
  say("areas", fmt::format("{}, mean {:.6g} m^2", range(smallest, largest, "m^2"), mean));
  say("area defect", fmt::format("{:.2g} of the region", std::abs(sum - whole) / whole));
  const Mesh elements = mesh_of_cells(region, mesh);
  const MeshQuality q = mesh_quality(elements);
  double own = HUGE_VAL;
  for (int i = 0; i < region.size(); ++i) {
    own = std::min(own, corner_angle(region[i] - region.before(i), region.after(i) - region[i]));
  }
  say("angles", fmt::format("{}; smallest of the region {:.6g} degrees",
                            degrees(q.smallest_angle, q.largest_angle), own / kDegree));
  say("edge/apothem", fmt::format("{:.4g} or more", smallest_edge_ratio(elements)));
  say("not convex", fmt::format("{} of {} cells", q.not_convex, mesh.cells.size()));
  const size_t parts = mesh.cells.size() - voronoi.sites.size() - voronoi.cuts;
  if (parts > 0) say("parts", fmt::format("{} cells without a site", parts));
  if (voronoi.cuts > 0) say("cuts", fmt::format("{} at reflex corners", voronoi.cuts));
  if (voronoi.joined_pieces > 0) {
    say("joined",
        fmt::format("{} pieces that the outline cuts from their cell", voronoi.joined_pieces));
  }
  return text;
}

std::string description(const Mesh& mesh) {
  const MeshQuality q = mesh_quality(mesh);
  std::string text =
      line("elements", fmt::format("{} triangles, {} quadrilaterals, {} nodes", q.triangles,
                                   q.quadrilaterals, mesh.nodes.size())) +
      line("holes", std::to_string(boundary(mesh).loops.size() - 1)) +
      line("edges", range(q.shortest_edge, q.longest_edge, "m")) +
      line("areas", fmt::format("{}, sum {:.6g} m^2", range(q.smallest_area, q.largest_area, "m^2"),
                                q.area)) +
      line("angles", degrees(q.smallest_angle, q.largest_angle)) +
      line("edge/apothem", fmt::format("{:.4g} or more", smallest_edge_ratio(mesh))) +
      line("not convex", fmt::format("{} elements", q.not_convex)) +
      line("Jacobian", fmt::format("{:.4g} or more, scaled (1: best)", q.smallest_scaled_jacobian));
  for (const MeshGroup& group : mesh.groups) {
    text +=
        line("group", fmt::format("{}: {} nodes, {} edges, {} elements", group.name,
                                  group.nodes.size(), group.edges.size(), group.elements.size()));
  }
  return text;
}

nlohmann::json description_json(const Mesh& mesh) {
  const MeshQuality q = mesh_quality(mesh);
  nlohmann::json groups = nlohmann::json::array();
  for (const MeshGroup& group : mesh.groups) {
    groups.push_back({{"name", group.name},
                      {"nodes", group.nodes.size()},
                      {"edges", group.edges.size()},
                      {"elements", group.elements.size()}});
  }
  return {{"nodes", mesh.nodes.size()},
          {"triangles", q.triangles},
          {"quadrilaterals", q.quadrilaterals},
          {"holes", boundary(mesh).loops.size() - 1},
          {"area", q.area},
          {"areas", {q.smallest_area, q.largest_area}},
          {"edges", {q.shortest_edge, q.longest_edge}},
          {"angles", {q.smallest_angle, q.largest_angle}},
          {"smallest_edge_ratio", smallest_edge_ratio(mesh)},
          {"not_convex", q.not_convex},
          {"smallest_scaled_jacobian", q.smallest_scaled_jacobian},
          {"groups", groups}};
}

std::string groups_json(const Mesh& mesh) {
  std::string text;
  for (const MeshGroup& group : mesh.groups) {
    nlohmann::json json{{"name", group.name}, {"nodes", group.nodes}, {"edges", group.edges}};
    if (!group.elements.empty()) json["elements"] = group.elements;
    text += (text.empty() ? "" : ",\n") + json.dump();
  }
  return "[\n" + text + "\n]";
}

// The cells as polygons of a file of shapes.
std::vector<Shape> cell_polygons(const PolygonMesh& mesh) {
  std::vector<Shape> shapes;
  for (const std::vector<int>& cell : mesh.cells) {
    const auto number = static_cast<double>(shapes.size());
    shapes.push_back({Shape::Kind::polygon, {cell_ring(mesh, cell)}, {{"cell", number}}});
  }
  return shapes;
}

bool ends_in_json(const std::string& file) { return lower_case(file).ends_with(".json"); }

// Writes the cells in the format that the ending of the file stands for; `json` is the text of
// the mesh for .json.
void write_cells(const std::string& file, const PolygonMesh& mesh, const std::string& json) {
  if (ends_in_json(file)) return write_file(file, json);
  const ShapeFormat format = *shape_format(file);
  if (format == ShapeFormat::vtu) return write_mesh(file, mesh);
  write_file(file, shape_text(cell_polygons(mesh), format));
}

void make_cells(const MeshOptions& options) {
  try {
    const Polygon region = polygon_of_file(options.file);
    const VoronoiMesh voronoi = voronoi_mesh(region, options.voronoi);
    const PolygonMesh mesh = in_world(region, voronoi.mesh);
    const Rings rings = rings_of(region);
    std::string holes;
    for (size_t i = 1; i < rings.size(); ++i) holes += (i > 1 ? ",\n" : "") + rows(rings[i]);
    if (!holes.empty()) holes = "\"holes\": [\n" + holes + "\n],\n";
    const std::string json =
        fmt::format("{{\n\"region\": {},\n{}\"points\": {},\n\"cells\": {}\n}}\n", rows(rings[0]),
                    holes, rows(mesh.points), rows(mesh.cells));
    if (!options.output.empty()) write_cells(options.output, mesh, json);
    if (!options.vtk.empty()) write_mesh(options.vtk, mesh);
    if (options.output.empty()) fmt::print("{}", json);
    fmt::print(options.output.empty() ? stderr : stdout, "{}", summary(region, voronoi, mesh));
  } catch (const InvalidPolygon& error) {
    throw SceneError(options.file, 0, "", fmt::format("the region {}", error.what()));
  } catch (const std::invalid_argument& error) {
    throw UsageError("mesh", error.what());
  }
}

void describe_mesh(const MeshOptions& options) {
  const Mesh mesh = read_mesh_file(options.file, {.convex_quadrilaterals = false});
  const PolygonMesh cells = cells_of_mesh(mesh);
  if (!options.output.empty()) {
    write_cells(options.output, cells,
                fmt::format("{{\n\"points\": {},\n\"cells\": {},\n\"groups\": {}\n}}\n",
                            rows(cells.points), rows(cells.cells), groups_json(mesh)));
  }
  if (!options.vtk.empty()) write_mesh(options.vtk, cells);
  fmt::print("{}", options.json ? description_json(mesh).dump(2) + "\n" : description(mesh));
}

void require_endings(const MeshOptions& options) {
  const std::string& file = options.output;
  if (!file.empty() && !ends_in_json(file) && !shape_format(file)) {
    throw UsageError("-o", fmt::format("must end in .json, {}, not \"{}\"", kShapeFormats, file));
  }
  if (!options.vtk.empty() && shape_format(options.vtk) != ShapeFormat::vtu) {
    throw UsageError("--vtk", fmt::format("must end in .vtu, not \"{}\"", options.vtk));
  }
}

}  // namespace

int mesh_command(const MeshOptions& options) {
  if (!options.output.empty() && options.output == options.vtk) {
    throw SceneError(options.vtk, 0, "", "is given for -o and for --vtk; give two names");
  }
  require_endings(options);
  if (is_mesh_file(options.file)) {
    if (options.make) {
      throw SceneError(options.file, 0, "", "is a mesh already; leave out --voronoi");
    }
    describe_mesh(options);
  } else {
    if (!options.make) {
      throw SceneError(options.file, 0, "",
                       "give --voronoi N to mesh this region, or a mesh (NAME.msh)");
    }
    make_cells(options);
  }
  return exit_code::done;
}

}  // namespace apothem
