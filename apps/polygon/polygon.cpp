#include <fmt/format.h>

#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "apps/commands.hpp"
#include "apps/polygon/batch.hpp"
#include "apps/polygon/input.hpp"
#include "apps/process/work_line.hpp"
#include "geometry/polygon/segment.hpp"
#include "geometry/potential/inscribed_circle.hpp"
#include "geometry/skeleton/node_places.hpp"
#include "geometry/skeleton/singular_area.hpp"
#include "lib/output/files.hpp"
#include "lib/output/picture.hpp"
#include "lib/output/polygon_shapes.hpp"
#include "lib/output/polygon_vtk.hpp"
#include "lib/scene/polygon_file.hpp"
#include "lib/scene/ring_line.hpp"
#include "lib/text/decimal.hpp"
#include "lib/text/error.hpp"

namespace apothem {
namespace {

using Json = nlohmann::ordered_json;

struct Analysis {
  Polygon polygon;
  AreaMoments moments;
  InscribedCircle circle;
  Skeleton skeleton;
  double reference;
  SingularArea singular;
};

// All properties of a polygon. Throws InvalidPolygon, and Interrupted after a signal.
Analysis analyse(Polygon polygon, const PotentialChoice& choice) {
  require_few_vertices(polygon.vertices().size());
  WorkLine line(fmt::format("{} vertices", polygon.size()));
  const Progress progress = [&](const Stage& stage) { line.report(stage); };
  InscribedCircle circle = largest_inscribed_circle(polygon, progress);
  Skeleton skeleton = [&] {
    try {
      return straight_skeleton(polygon, progress);
    } catch (const SkeletonFailure& failure) {
      throw InvalidPolygon(failure.what(), 0);
    }
  }();
  using Reference = PotentialChoice::Reference;
  const double reference = choice.reference == Reference::length             ? choice.length
                           : choice.reference == Reference::inscribed_circle ? circle.radius
                                                                             : skeleton.roof_height;
  SingularArea singular = singular_area(skeleton, reference);
  line.check();
  const AreaMoments moments = area_moments(polygon);
  return {std::move(polygon),  moments,   std::move(circle),
          std::move(skeleton), reference, std::move(singular)};
}

const char* reference_name(const PotentialChoice& choice) {
  using Reference = PotentialChoice::Reference;
  return choice.reference == Reference::roof               ? "roof height"
         : choice.reference == Reference::inscribed_circle ? "inscribed circle"
                                                           : "given";
}

const char* arithmetic(const Skeleton& skeleton) { return skeleton.exact ? "exact" : "inexact"; }

// The coordinates of the input from those relative to the polygon's origin.
Json world(const Polygon& polygon, const Vec2& local) {
  return {polygon.origin().x() + local.x(), polygon.origin().y() + local.y()};
}
Json world_list(const Polygon& polygon, const std::vector<Vec2>& points) {
  Json list = Json::array();
  for (const Vec2& p : points) list.push_back(world(polygon, p));
  return list;
}

// The same of nodes of the skeleton and of centres of circles.
template <class Points>
Json place_list(const PlaceGrid& grid, const Points& points) {
  Json list = Json::array();
  for (const Vec2& local : points) {
    const Vec2 p = grid.world(local);
    list.push_back({p.x(), p.y()});
  }
  return list;
}

Json singular_json(const Polygon& polygon, const SingularArea& singular) {
  const PlaceGrid grid(polygon);
  Json points = place_list(grid, singular.points);
  Json segments = Json::array();
  for (const std::array<Vec2, 2>& ends : singular.segments) {
    segments.push_back(place_list(grid, ends));
    points.insert(points.end(), segments.back().begin(), segments.back().end());
  }
  Json polygons = Json::array();
  for (const std::vector<Vec2>& ring : rings_of(singular.polygons)) {
    polygons.push_back(world_list(polygon, ring));
  }
  return {{"kind", kind_name(singular.kind())},
          {"area", singular.area()},
          {"points", points},
          {"segments", segments},
          {"polygons", polygons}};
}

Json faces_json(const Polygon& polygon, const Skeleton& skeleton) {
  const NodePlaces places(polygon, skeleton.nodes);
  std::map<int, Json> faces;  // in the order of the edges in the input
  for (int e = 0; e < polygon.size(); ++e) {
    Json ring = Json::array();
    for (const int i : skeleton.faces[e]) {
      const Vec2 p = places[i];
      ring.push_back({p.x(), p.y(), skeleton.nodes[i].height});
    }
    const int edge = polygon.input_edge(e);
    faces[edge] = {{"edge", edge}, {"polygon", std::move(ring)}};
  }
  Json list = Json::array();
  for (auto& [edge, face] : faces) list.push_back(std::move(face));
  return list;
}

Json to_json(const Analysis& a) {
  return {{"area", a.moments.area},
          {"centroid", world(a.polygon, a.moments.centroid)},
          {"polar_moment", a.moments.polar},
          {"holes", Json::parse(holes_json(polygon_of_rings(rings_of(a.polygon)).holes))},
          {"inradius", a.circle.radius},
          {"incircle_centres", place_list(PlaceGrid(a.polygon), a.circle.centres)},
          {"roof_height", a.skeleton.roof_height},
          {"reference_length", a.reference},
          {"singular_area", singular_json(a.polygon, a.singular)},
          {"faces", faces_json(a.polygon, a.skeleton)},
          {"arithmetic", arithmetic(a.skeleton)},
          {"attempts", a.skeleton.attempts}};
}

std::string text(const Json& object, int indent) {
  return object.dump(indent, ' ', false, Json::error_handler_t::replace);
}

std::string place(const Vec2& p) { return fmt::format("({}, {})", p.x(), p.y()); }

// The table lists at most this many positions; --json lists all of them.
constexpr size_t kListed = 8;

std::string places(const PlaceGrid& grid, const std::vector<Vec2>& points) {
  std::string list;
  for (size_t i = 0; i < std::min(points.size(), kListed); ++i) {
    list += (i == 0 ? "" : ", ") + place(grid.world(points[i]));
  }
  return points.size() > kListed ? fmt::format("{}, ... ({} in all)", list, points.size()) : list;
}

// Whether each point of the segment between two centres is a centre: its middle is, too.
bool is_segment(const Analysis& a, const Vec2& from, const Vec2& to) {
  const Vec2 middle = a.polygon.origin() + (from + to) / 2;
  double depth = HUGE_VAL;
  for (const std::vector<Vec2>& ring : rings_of(a.polygon)) {
    depth = std::min(depth, distance_to_ring(ring, middle));
  }
  return depth > a.circle.radius * (1 - 1e-9);
}

// Isolated centres, and segments of centres, whose ends stand one after the other.
std::string centres(const Analysis& a, const PlaceGrid& grid) {
  const std::vector<Vec2>& all = a.circle.centres;
  std::string text;
  for (size_t i = 0, shown = 0; i < all.size() && shown < kListed; ++i, ++shown) {
    text += (i == 0 ? "" : ", ") + place(grid.world(all[i]));
    if (i + 1 < all.size() && is_segment(a, all[i], all[i + 1])) {
      text += " to " + place(grid.world(all[++i]));
    }
  }
  return all.size() > kListed ? fmt::format("{} m, ... ({} places in all)", text, all.size())
                              : text + " m";
}

void print_table(const Analysis& a, const std::string& reference_name) {
  const auto row = [](const char* name, const std::string& value) {
    fmt::print("{:<17} {}\n", name, value);
  };
  const PlaceGrid grid(a.polygon);
  const bool convex = a.polygon.is_convex();
  row("vertices", fmt::format("{}, {}", a.polygon.size(), convex ? "convex" : "not convex"));
  if (a.polygon.has_holes()) row("holes", fmt::format("{}", a.polygon.rings() - 1));
  row("area", fmt::format("{} m^2", a.moments.area));
  row("centroid", place(a.polygon.origin() + a.moments.centroid) + " m");
  row("polar moment", fmt::format("{} m^4, about the centroid", a.moments.polar));
  row("inradius", fmt::format("{} m", a.circle.radius));
  row("incircle centres", centres(a, grid));
  row("roof height", fmt::format("{} m", a.skeleton.roof_height));
  row("reference length", fmt::format("{} m ({})", a.reference, reference_name));
  const bool beyond = a.reference > a.skeleton.roof_height;
  row("singular area", kind_name(a.singular.kind()) +
                           std::string(beyond ? ": the roof does not reach the reference length, "
                                                "and phi stays below 1"
                                              : ""));
  if (!a.singular.polygons.empty()) {
    row("  polygons",
        fmt::format("{}, area {} m^2", a.singular.polygons.size(), a.singular.area()));
  }
  for (size_t i = 0; i < std::min(a.singular.segments.size(), kListed); ++i) {
    const auto& [start, end] = a.singular.segments[i];
    row("  segment", place(grid.world(start)) + " to " + place(grid.world(end)) + " m");
  }
  if (a.singular.segments.size() > kListed) {
    row("  segments", fmt::format("{} in all", a.singular.segments.size()));
  }
  if (!a.singular.points.empty()) row("  points", places(grid, a.singular.points) + " m");
  row("faces", fmt::format("{}", a.polygon.size()));
  row("skeleton",
      fmt::format("in {}{}", a.skeleton.exact ? "exact arithmetic" : "double precision",
                  a.skeleton.attempts == 1
                      ? ""
                      : fmt::format(", at the {}. attempt, with vertices moved by round-off",
                                    a.skeleton.attempts)));
}

int batch(const PolygonOptions& options, const PotentialChoice& choice) {
  return print_answers(options.batch, kPolygonForm, [&](const BatchLine& line) -> BatchAnswer {
    const Json name = line.has_polygon ? Json(line.name) : Json();
    Json object{{"name", name}};
    try {
      std::istringstream words(line.text.substr(line.text.find(line.name) + line.name.size()));
      const PolygonWithHoles read = read_line_polygon(words);
      require_end(words);
      object.update(to_json(analyse(Polygon(read.outer, read.holes), choice)));
    } catch (const InvalidPolygon& error) {
      object.update({{"error", error.what()}, {"vertex", error.vertex()}, {"line", line.number}});
      if (error.hole()) object["hole"] = *error.hole();
      return {text(object, -1), true};
    }
    return {text(object, -1)};
  });
}

// The properties of the polygon of a file. Throws PolygonError, so that each refusal has its place.
Analysis analyse_file(const std::string& file, const PotentialChoice& choice) {
  const Polygon polygon = polygon_of_file(file);
  try {
    return analyse(polygon, choice);
  } catch (const InvalidPolygon& error) {
    throw PolygonError(file, 0, std::string("the polygon is not usable: ") + error.what(),
                       error.vertex(), error.hole());
  }
}

// What --output asks for.
struct ShapeChoice {
  std::string what;
  double depth = 0;  // of an offset, m
};

ShapeChoice shape_choice(const std::string& text) {
  const std::string offset = "offset:";
  if (text.starts_with(offset)) {
    const double depth = find_decimal(text.substr(offset.size())).value_or(0);
    if (depth > 0) return {"offset", depth};
    throw UsageError("--output", fmt::format("offset:D moves the sides inwards by D, a positive "
                                             "length in m, not \"{}\"",
                                             text.substr(offset.size())));
  }
  for (const char* known : {"skeleton", "faces", "singular-area", "incircle"}) {
    if (text == known) return {text};
  }
  throw UsageError("--output", fmt::format("must be skeleton, faces, offset:D, singular-area or "
                                           "incircle, not \"{}\"",
                                           text));
}

std::vector<Shape> shapes_of(const Analysis& a, const ShapeChoice& choice) {
  if (choice.what == "skeleton") return skeleton_shapes(a.polygon, a.skeleton);
  if (choice.what == "faces") return face_shapes(a.polygon, a.skeleton);
  if (choice.what == "offset") return offset_shapes(a.polygon, a.skeleton, choice.depth);
  if (choice.what == "incircle") return circle_shapes(a.polygon, a.circle);
  return singular_shapes(a.polygon, a.singular);
}

// Writes the picture and the files that are asked for.
void write_files(const Analysis& a, const PolygonOptions& options, const std::string& reference,
                 const std::optional<PictureFormat>& picture,
                 const std::optional<ShapeChoice>& shapes) {
  std::string text;
  if (shapes) {
    const std::vector<Shape> found = shapes_of(a, *shapes);
    text = shape_text(found, shape_format_of(options.output));
    if (found.empty()) {
      fmt::print(stderr, "apothem: warning: {} has no shape: the roof is {} m high\n",
                 options.output, a.skeleton.roof_height);
    }
  }
  if (picture) {
    write_file(options.picture,
               draw_potential({a.polygon, a.skeleton, a.circle, a.singular, a.reference, reference},
                              *picture));
  }
  if (!options.vtk.empty()) {
    write_polygon_vtk(options.vtk, a.polygon, a.skeleton, a.singular, a.reference);
  }
  if (shapes) write_file(options.output, text);
}

}  // namespace

int polygon_command(const PolygonOptions& options) {
  PotentialChoice choice;
  set_reference(choice, options.reference);
  if (!options.batch.empty()) return batch(options, choice);
  if (options.file.empty()) {
    throw UsageError("polygon", "give a polygon file, or --batch FILE");
  }
  const std::optional<PictureFormat> format = picture_format(options.picture);
  if (!options.picture.empty() && !format) {
    throw UsageError("--picture",
                     fmt::format("must end in .png or .svg, not \"{}\"", options.picture));
  }
  if (options.repair) return repair_outlines(options);
  if (!options.at.empty() || !options.points.empty()) return evaluate_points(options, choice);
  if (options.shapes.empty() != options.output.empty()) {
    throw UsageError("polygon", "--output WHAT and -o FILE go together");
  }
  std::optional<ShapeChoice> shapes;
  if (!options.shapes.empty()) {
    shapes = shape_choice(options.shapes);
    shape_format_of(options.output);
  }
  const Analysis a = analyse_file(options.file, choice);
  const std::string name = reference_name(choice);
  write_files(a, options, name, format, shapes);
  if (options.json) {
    fmt::print("{}\n", text(to_json(a), 2));
  } else {
    print_table(a, name);
  }
  return exit_code::done;
}

}  // namespace apothem
