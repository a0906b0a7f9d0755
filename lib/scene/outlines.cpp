#include "lib/scene/outlines.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <iterator>

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
    std::vector<std::vector<Vec2>> rings;
    for (const auto& ring : shape.rings) rings.push_back(cleaned(ring));
    add_rings(shape, std::move(rings));
  }

  void require_no_holes(const DrawnShape& shape) const {
    if (rules_.may_have_holes(shape.layer)) return;
    refuse(shape,
           "has a hole, and rigid bodies have none; divide it into outlines without "
           "holes, or give its bodies a \"mesh\"");
  }

  // An outline of valid rings: the outer one and holes.
  void add_rings(const DrawnShape& shape, std::vector<std::vector<Vec2>> rings) {
    if (rings.size() > 1) require_no_holes(shape);
    std::vector<Polygon> polygons;
    try {
      for (const auto& ring : rings) polygons.emplace_back(ring);
    } catch (const InvalidPolygon& error) {
      refuse(shape,
             fmt::format("{}; correct the drawing there, or say \"repair\": true", error.what()));
    }
    polygons_.push_back(std::move(polygons.front()));
    outlines_.push_back({std::move(rings), shape.layer, shape.name, shape.place, shape.entity});
  }

  void add_repaired(const DrawnShape& shape) {
    try {
      DrawnShape clean = shape;
      for (auto& ring : clean.rings) ring = cleaned(ring);
      const RepairedShape repaired = repair_shape(clean, rules_.tolerance.value_or(0));
      if (repaired.result.polygons.empty()) refuse(shape, "surrounds nothing; take it out");
      // All of its parts are taken or none of them.
      for (const PolygonWithHoles& polygon : repaired.result.polygons) {
        if (!polygon.holes.empty()) require_no_holes(shape);
      }
      for (const PolygonWithHoles& polygon : repaired.result.polygons) {
        add_rings(shape, rings_of(polygon));
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
    Box box;
    for (const Vec2& v : face.rings[0]) box.include(v.x(), v.y());
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

  void look_for_covered() {
    std::vector<Box> boxes;
    for (const Polygon& polygon : polygons_) boxes.push_back(bounding_box(polygon));
    std::vector<BoxPair> pairs;
    BoxGrid().find_pairs(boxes, pairs);
    for (const BoxPair& pair : pairs) {
      if (pair.first >= first_face_) continue;  // faces do not overlap each other
      const Polygon &a = polygons_[pair.first], &b = polygons_[pair.second];
      if (outlines_[pair.first].rings.size() + outlines_[pair.second].rings.size() > 2) continue;
      double shared = 0;
      for (const OverlapPolygon& part : overlap_polygons(a, b, a.origin())) {
        shared += ring_area(part.vertices);
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
      DrawnShape shape{};
      shape.place = second.place, shape.layer = second.layer, shape.entity = second.entity;
      const bool apart = unless_faulty(shape, [&] {
        refuse(second, fmt::format("covers {:.3g} % of {} (or is covered so); delete one of them, "
                                   "move them apart, or leave a layer out",
                                   100 * shared / smaller, shown_place(first.place, first.layer)));
      });
      if (apart || !covered_.insert(pair.second).second) continue;
      if (--report_.read[second.entity] == 0) report_.read.erase(second.entity);
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
  std::vector<Polygon> polygons_;        // the outer rings of the outlines
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
