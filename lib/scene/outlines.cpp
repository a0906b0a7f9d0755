#include "lib/scene/outlines.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <map>

#include "geometry/exact/overlap.hpp"
#include "geometry/polygon/cyclic.hpp"
#include "geometry/polygon/predicates.hpp"
#include "geometry/polygon/ring_moments.hpp"
#include "geometry/spatial/boxes.hpp"
#include "lib/scene/faces.hpp"
#include "lib/scene/shape_repair.hpp"

namespace apothem {
namespace {

// An outline that covers this part of another one is drawn twice, or over it.
constexpr double kCovered = 0.01;
// A hatch that covers this part of an outline, and is covered so, is the hatching of its area.
constexpr double kSame = 0.99;
constexpr double kTolerance = 1e-6;  // of the extent
constexpr const char* kFaulty = "faulty";

std::string shown_place(const std::string& place, const std::string& layer) {
  return layer.empty() ? place : fmt::format("{} on layer \"{}\"", place, layer);
}

template <class Shape>
[[noreturn]] void refuse(const Shape& shape, const std::string& what) {
  throw BadOutline(fmt::format("{}: {}", shown_place(shape.place, shape.layer), what));
}

class OutlineMaker {
 public:
  OutlineMaker(const std::vector<DrawnShape>& shapes, const OutlineRules& rules,
               ImportReport& report)
      : rules_(rules), report_(report) {
    Box box;
    for (const DrawnShape& shape : shapes) {
      if (is_left_out(shape)) continue;
      shapes_.push_back(shape);
      for (auto& ring : shapes_.back().rings) {
        for (Vec2& v : ring) v = rules.scale * v + rules.offset;
        box.include(box_of(ring));
      }
    }
    tolerance_ = rules.tolerance.value_or(kTolerance * std::max(0.0, box.extent()));
  }

  std::vector<Outline> make() {
    for (const DrawnShape& shape : shapes_) {
      const bool read = unless_faulty(shape, [&] {
        if (shape.kind == DrawnShape::Kind::area) add(shape);
        if (shape.kind == DrawnShape::Kind::line && !rules_.polygonize) add_line(shape);
      });
      if (read) report_.read[shape.entity] += shape.further ? 0 : 1;
    }
    if (rules_.polygonize) add_faces();
    if (outlines_.empty()) {
      const std::string left_out = report_.left_out_in_words();
      throw BadOutline((rules_.polygonize
                            ? "its lines enclose no face; check that they meet, or raise "
                              "\"tolerance\" (m)"
                            : "holds no closed outline; draw closed polylines or polygons") +
                       (left_out.empty() ? "" : fmt::format(" (left out: {})", left_out)));
    }
    if (rules_.nested_holes) cut_nested_holes();
    look_for_covered();
    count_hatches();
    std::set<std::int32_t> numbers(hatches_);
    numbers.insert(covered_.begin(), covered_.end());
    take_out(numbers);
    return std::move(outlines_);
  }

 private:
  // Does something with a shape, and returns true. If that finds a fault and faults are skipped, it
  // lists the fault, counts the shape as left out, and returns false.
  template <class Work>
  bool unless_faulty(const DrawnShape& shape, const Work& work) {
    if (!rules_.skip_faults) {
      work();
      return true;
    }
    try {
      work();
      return true;
    } catch (const BadOutline& fault) {
      report_.faults.emplace_back(fault.what());
      report_.left_out[{shape.entity, kFaulty}] += shape.further ? 0 : 1;
      return false;
    }
  }

  // Counts what is left out, and refuses what cannot be read and is not left out.
  bool is_left_out(const DrawnShape& shape) {
    using Kind = DrawnShape::Kind;
    std::string reason;
    if (rules_.ignored.count(shape.layer)) {
      reason = "on layers that the scene leaves out";
    } else if (shape.hidden) {
      reason = "off or frozen in the drawing";
    } else if (shape.kind == Kind::left_out) {
      reason = shape.remark;
    } else if (shape.kind == Kind::unsupported ||
               (shape.kind == Kind::unbounded && rules_.polygonize)) {
      return !unless_faulty(shape, [&] { refuse(shape, shape.remark); });
    } else if (!rules_.polygonize && (shape.kind == Kind::label || shape.kind == Kind::unbounded)) {
      reason = "no outline";
    }
    if (reason.empty()) return false;
    report_.left_out[{shape.entity, reason}] += shape.further ? 0 : 1;
    return true;
  }

  // Closing vertices are left out, and vertices that repeat the one before: programs write both
  // where arcs meet lines, and not always with the same digits.
  [[nodiscard]] std::vector<Vec2> cleaned(const std::vector<Vec2>& drawn) const {
    const auto close = [&](const Vec2& a, const Vec2& b) { return (a - b).norm() <= tolerance_; };
    std::vector<Vec2> ring;
    std::unique_copy(drawn.begin(), drawn.end(), std::back_inserter(ring), close);
    while (ring.size() > 1 && close(ring.back(), ring.front())) ring.pop_back();
    return ring;
  }

  void add_line(const DrawnShape& shape) {
    const std::vector<Vec2>& line = shape.rings[0];
    const double gap = line.empty() ? 0 : (line.back() - line.front()).norm();
    if (gap > tolerance_) {
      refuse(shape, fmt::format("the line is open, with {:.3g} m between its ends; close it, leave "
                                "its layer out, raise \"tolerance\" (m), or say \"lines\": "
                                "\"polygonize\" where lines divide the plane into bodies",
                                gap));
    }
    add(shape);
  }

  void add(const DrawnShape& shape) {
    if (rules_.repair) {
      add_repaired(shape);
      return;
    }
    Rings rings;
    for (const auto& ring : shape.rings) rings.push_back(cleaned(ring));
    add_rings(shape, std::move(rings));
  }

  // An outline by its rings: the outer one and holes.
  void add_rings(const DrawnShape& shape, Rings rings) {
    try {
      Polygon polygon(polygon_of_rings(rings));
      add_outline(shape, std::move(polygon), std::move(rings));
    } catch (const InvalidPolygon& error) {
      refuse(shape,
             fmt::format("{}; correct the drawing there, or say \"repair\": true", error.what()));
    }
  }

  void add_outline(const DrawnShape& shape, Polygon polygon, Rings rings) {
    polygons_.push_back(std::move(polygon));
    outlines_.push_back({std::move(rings), shape.layer, shape.name, shape.place, shape.entity});
  }

  void add_repaired(const DrawnShape& shape) {
    try {
      DrawnShape clean = shape;
      for (auto& ring : clean.rings) ring = cleaned(ring);
      const RepairedShape repaired = repair_shape(clean, rules_.tolerance.value_or(0));
      if (repaired.result.polygons.empty()) refuse(shape, "surrounds nothing; take it out");
      // All of its parts are taken or none of them.
      std::vector<Polygon> parts;
      for (const PolygonWithHoles& part : repaired.result.polygons) parts.emplace_back(part);
      for (size_t i = 0; i < parts.size(); ++i) {
        add_outline(shape, std::move(parts[i]), rings_of(repaired.result.polygons[i]));
      }
      report_.faults.insert(report_.faults.end(), repaired.faults.begin(), repaired.faults.end());
    } catch (const InvalidPolygon& error) {
      refuse(shape, fmt::format("{}; correct the drawing there", error.what()));
    }
  }

  void add_faces() {
    std::vector<std::vector<Vec2>> lines;
    for (const DrawnShape& shape : shapes_) {
      if (shape.kind == DrawnShape::Kind::line) lines.push_back(shape.rings[0]);
    }
    for (size_t i = 0; i < shapes_.size(); ++i) {
      const DrawnShape& shape = shapes_[i];
      if (shape.kind == DrawnShape::Kind::label && !shape.rings[0].empty()) labels_.push_back(i);
    }
    first_face_ = static_cast<std::int32_t>(outlines_.size());
    for (auto& rings : faces_between(std::move(lines), tolerance_)) {
      DrawnShape face{};
      face.kind = DrawnShape::Kind::area;
      face.rings = std::move(rings);
      const Vec2& corner = face.rings[0][0];
      face.place =
          fmt::format("the face with the corner ({:.6g}, {:.6g}) m", corner.x(), corner.y());
      unless_faulty(face, [&] {
        label(face);
        add(face);
      });
    }
  }

  void label(DrawnShape& face) const {
    const DrawnShape* found = nullptr;
    const Box box = box_of(face.rings[0]);
    for (const size_t i : labels_) {
      const DrawnShape& shape = shapes_[i];
      const Vec2& place = shape.rings[0][0];
      if (apart({place.x(), place.y(), place.x(), place.y()}, box) ||
          !strictly_inside(cleaned(face.rings[0]), place)) {
        continue;
      }
      if (found != nullptr) {
        refuse(shape, fmt::format("is a second label of one face, besides {}; take one away",
                                  shown_place(found->place, found->layer)));
      }
      found = &shape;
    }
    if (found == nullptr) return;
    face.layer = found->layer;
    face.name = found->name;
  }

  [[nodiscard]] std::vector<BoxPair> near_pairs() const {
    std::vector<Box> boxes;
    for (const Polygon& polygon : polygons_) boxes.push_back(bounding_box(polygon));
    std::vector<BoxPair> pairs;
    BoxGrid().find_pairs(boxes, pairs);
    return pairs;
  }

  // Whether an outline lies inside of another one, and not in a hole of it, as far as its first
  // vertex tells that is not on the other's boundary.
  static bool is_inside(const Polygon& inner, const Polygon& outer) {
    if (!contains(bounding_box(outer), bounding_box(inner))) return false;
    for (const Vec2& v : inner.outer_ring()) {
      if (const int side = side_of(outer, v)) return side > 0;
    }
    return false;
  }

  // For each outline those of its layer that it lies inside of.
  [[nodiscard]] std::vector<std::vector<std::int32_t>> find_enclosing() const {
    std::vector<std::vector<std::int32_t>> enclosing(outlines_.size());
    for (const auto& [a, b] : near_pairs()) {
      if (std::max(a, b) >= first_face_) continue;  // faces have their holes
      if (outlines_[a].layer != outlines_[b].layer) continue;
      if (is_inside(polygons_[a], polygons_[b])) enclosing[a].push_back(b);
      if (is_inside(polygons_[b], polygons_[a])) enclosing[b].push_back(a);
    }
    return enclosing;
  }

  // An outline inside of an odd number of others is a hole of the innermost of them.
  void cut_nested_holes() {
    const std::vector<std::vector<std::int32_t>> enclosing = find_enclosing();
    std::map<std::int32_t, std::vector<std::int32_t>> holes;  // by the outline that has them
    for (std::int32_t i = 0; i < static_cast<std::int32_t>(enclosing.size()); ++i) {
      if (enclosing[i].size() % 2 == 0) continue;
      const auto depth = [&](std::int32_t k) { return enclosing[k].size(); };
      holes[*std::ranges::max_element(enclosing[i], {}, depth)].push_back(i);
    }
    std::set<std::int32_t> gone;
    for (const auto& entry : holes) {
      const std::int32_t outer = entry.first;
      const std::vector<std::int32_t>& inner = entry.second;
      gone.insert(inner.begin(), inner.end());
      const Outline& outline = outlines_[outer];
      const bool cut = unless_faulty(shape_of(outline), [&] { cut_holes(outer, inner); });
      if (cut) continue;
      gone.insert(outer);
      uncount(outline.entity);
    }
    take_out(gone);
    for (const std::int32_t number : std::vector(gone.rbegin(), gone.rend())) {
      polygons_.erase(polygons_.begin() + number);
    }
    if (first_face_ < INT32_MAX) first_face_ -= static_cast<std::int32_t>(gone.size());
  }

  void cut_holes(std::int32_t outer, const std::vector<std::int32_t>& inner) {
    Outline& outline = outlines_[outer];
    Rings rings = outline.rings;
    for (const std::int32_t hole : inner) {
      const Outline& cut = outlines_[hole];
      if (cut.rings.size() > 1) {
        refuse(cut, fmt::format("lies inside of {} and has a hole itself; draw what lies in the "
                                "hole as an outline, or on another layer",
                                shown_place(outline.place, outline.layer)));
      }
      rings.push_back(cut.rings[0]);
    }
    try {
      polygons_[outer] = Polygon(polygon_of_rings(rings));
    } catch (const InvalidPolygon& error) {
      refuse(outline, fmt::format("{}; correct the drawing there", error.what()));
    }
    outline.rings = std::move(rings);
  }

  static DrawnShape shape_of(const Outline& outline) {
    DrawnShape shape{};
    shape.place = outline.place, shape.layer = outline.layer, shape.entity = outline.entity;
    return shape;
  }

  // An outline that is not taken after all.
  void uncount(const std::string& entity) {
    if (--report_.read[entity] == 0) report_.read.erase(entity);
  }

  void look_for_covered() {
    for (const BoxPair& pair : near_pairs()) {
      if (pair.first >= first_face_) continue;  // faces do not overlap each other
      const Polygon &a = polygons_[pair.first], &b = polygons_[pair.second];
      double shared = 0;
      for (const OverlapPolygon& part : overlap_polygons(a, b, a.origin())) {
        shared += ring_area(part.vertices);
        for (const OverlapRing& hole : part.holes) shared += ring_area(hole.vertices);
      }
      const double areas[]{area_moments(a).area, area_moments(b).area};
      const double smaller = std::min(areas[0], areas[1]), larger = std::max(areas[0], areas[1]);
      if (!(shared > kCovered * smaller)) continue;
      const Outline &first = outlines_[pair.first], &second = outlines_[pair.second];
      if (shared > kSame * larger && (first.entity == "HATCH" || second.entity == "HATCH")) {
        hatches_.insert(second.entity == "HATCH" ? pair.second : pair.first);
        continue;
      }
      if (rules_.skip_faults && covered_.count(pair.first)) continue;
      const bool whole = shared > kSame * smaller && first.layer == second.layer;
      const bool apart = unless_faulty(shape_of(second), [&] {
        refuse(second,
               fmt::format("covers {:.4g} % of {} (or is covered so); delete one of them, "
                           "move them apart, or leave a layer out{}",
                           100 * shared / smaller, shown_place(first.place, first.layer),
                           whole ? "; say \"holes\": \"nested\" if the inner one is a hole" : ""));
      });
      if (apart || !covered_.insert(pair.second).second) continue;
      uncount(second.entity);
    }
  }

  // Takes outlines out by their numbers.
  void take_out(const std::set<std::int32_t>& numbers) {
    for (const std::int32_t number : std::vector(numbers.rbegin(), numbers.rend())) {
      outlines_.erase(outlines_.begin() + number);
    }
  }

  void count_hatches() {
    if (hatches_.empty()) return;
    const int count = static_cast<int>(hatches_.size());
    report_.left_out[{"HATCH", "over an outline that is drawn"}] = count;
    if ((report_.read["HATCH"] -= count) == 0) report_.read.erase("HATCH");
  }

  const OutlineRules& rules_;
  ImportReport& report_;
  std::vector<DrawnShape> shapes_;  // in m
  double tolerance_ = 0;
  std::vector<Outline> outlines_;
  std::vector<Polygon> polygons_;        // of the outlines
  std::int32_t first_face_ = INT32_MAX;  // of the outlines that are faces between lines
  std::vector<size_t> labels_;           // numbers of shapes
  std::set<std::int32_t> hatches_;       // outlines that are the hatching of another one
  std::set<std::int32_t> covered_;       // outlines that are skipped because they cover another one
};

}  // namespace

std::vector<Outline> outlines_of(const std::vector<DrawnShape>& shapes, const OutlineRules& rules,
                                 ImportReport& report) {
  return OutlineMaker(shapes, rules, report).make();
}

}  // namespace apothem
