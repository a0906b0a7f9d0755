#include "lib/scene/shape_repair.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>

#include "lib/scene/polygon_file.hpp"
#include "lib/text/file.hpp"
#include "lib/text/words.hpp"

namespace apothem {
namespace {

bool is_drawing(const std::string& file) {
  const std::string ending = lower_case(std::filesystem::path(file).extension().string());
  constexpr std::array kDrawings{".dxf", ".csv", ".wkt", ".txt", ".geojson"};
  if (std::find(kDrawings.begin(), kDrawings.end(), ending) != kDrawings.end()) return true;
  return ending == ".json" &&
         read_text(file, kLargestJson).find("\"coordinates\"") != std::string::npos;
}

}  // namespace

std::vector<DrawnShape> read_shapes(const std::string& file) {
  if (!is_drawing(file)) {
    DrawnShape shape{};
    shape.kind = DrawnShape::Kind::area;
    const PolygonText text = read_polygon_file(file);
    shape.rings.push_back(text.outer.ring);
    for (const RingText& hole : text.holes) shape.rings.push_back(hole.ring);
    shape.place = text.holes.empty() ? "the ring" : "the polygon";
    shape.entity = "polygon";
    return {shape};
  }
  Drawing drawing = read_drawing(file);
  const bool scaled = lower_case(file).ends_with(".dxf") && drawing.unit.problem.empty();
  for (DrawnShape& shape : drawing.shapes) {
    for (auto& ring : shape.rings) {
      for (Vec2& v : ring) v *= scaled ? drawing.unit.metres : 1;
    }
  }
  return std::move(drawing.shapes);
}

std::string place_of(const DrawnShape& shape) {
  return shape.layer.empty() ? shape.place
                             : fmt::format("{} on layer \"{}\"", shape.place, shape.layer);
}

double gap_of(const DrawnShape& line) {
  const std::vector<Vec2>& points = line.rings[0];
  return points.empty() ? 0 : (points.back() - points.front()).norm();
}

RepairedShape repair_shape(const DrawnShape& shape, double tolerance) {
  RepairedShape repaired;
  const std::string place = place_of(shape);
  const auto say = [&](const std::string& what) { repaired.faults.push_back(place + ": " + what); };
  repaired.result = repair(shape.rings, tolerance);
  for (const RingFault& fault : repaired.result.faults) say(describe(fault));
  const Repaired& r = repaired.result;
  if (r.simplified_vertices > 0) {
    say(fmt::format("simplified by {} {}; Hausdorff distance {:.3g} m", r.simplified_vertices,
                    r.simplified_vertices == 1 ? "vertex" : "vertices", r.hausdorff_distance));
  }
  if (r.thin_parts > 0) {
    say(fmt::format("parts thinner than the tolerance left out: {}, {:.3g} m^2", r.thin_parts,
                    r.thin_area));
  }
  return repaired;
}

}  // namespace apothem
