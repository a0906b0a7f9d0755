#include "lib/scene/fill_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <optional>

#include "geometry/packing/block_shapes.hpp"
#include "geometry/packing/voronoi_blocks.hpp"
#include "geometry/polygon/ring_moments.hpp"
#include "geometry/spatial/hilbert.hpp"
#include "lib/fem/kinds.hpp"
#include "lib/scene/block_reader.hpp"
#include "lib/scene/body_reader.hpp"
#include "lib/scene/polygon_value.hpp"
#include "lib/scene/value_maker.hpp"
#include "lib/system/memory.hpp"
#include "lib/text/words.hpp"

namespace apothem {
namespace {

constexpr int kMostBlocks = 10'000'000;
// What a body and an element of a scene take in memory, measured with meshes of squares, bytes.
constexpr double kBodyBytes = 4e3, kElementBytes = 1.1e3;
constexpr double kTouching = 1e-7;  // of the size of a cell

enum class Arranged { random, lattice, dense, voronoi };

// Cells may touch what surrounds them.
std::vector<Vec2> shrunk(const std::vector<Vec2>& ring, double share) {
  Vec2 middle = Vec2::Zero();
  for (const Vec2& v : ring) middle += v / static_cast<double>(ring.size());
  std::vector<Vec2> smaller;
  smaller.reserve(ring.size());
  for (const Vec2& v : ring) smaller.push_back(v + share * (middle - v));
  return smaller;
}

// Reads one fill and makes its bodies.
class Fill {
 public:
  Fill(const JsonReader& in, const JsonValue& value)
      : in_(in), value_(value), make_(value), blocks_(in) {}

  Filled read(std::vector<PolygonWithHoles>& obstacles) {
    JsonObject object(in_, value_);
    name_ = in_.string(object.required("name", "a string; bodies are called NAME-0, NAME-1, ..."));
    object.required("material", "the name of a material");
    const JsonValue& region = object.required("region", "[[x,y],...] in m");
    read_region(region, object.optional("holes"));
    object.choose("arrangement", arranged_, {"random", "lattice", "dense", "voronoi"});
    object.read("gap", gap_, &JsonReader::not_negative, "m");
    const JsonValue* seed = object.optional("seed");
    RandomNumbers random(seed ? static_cast<std::uint64_t>(in_.count(*seed)) : 1);
    velocity_ = object.optional("velocity");
    spin_ = object.optional("spin");
    mesh(object.optional("mesh"));
    Filled filled;
    repeat(object.optional("repeat"), filled);
    if (arranged_ == Arranged::voronoi) {
      cells(object, seed ? static_cast<std::uint64_t>(in_.count(*seed)) : 1);
    } else {
      blocks(object);
    }
    object.finish();
    if (arranged_ == Arranged::voronoi) {
      add_cells(obstacles, filled);
    } else {
      // Batches do not keep clear of each other: a later one waits until nothing is in its way.
      std::vector<PolygonWithHoles> first;
      if (count_) refuse_too_many(*count_, 0, filled.batches);
      for (int batch = 0; batch < filled.batches; ++batch) {
        std::vector<PolygonWithHoles> placed = add_blocks(obstacles, random, filled);
        if (batch > 0) continue;
        first = std::move(placed);
        refuse_too_many(filled.count, area_of(first), filled.batches);
      }
      // Blocks of later fills may lie in the holes of these.
      std::ranges::move(first, std::back_inserter(obstacles));
    }
    filled.batch = filled.count / filled.batches;
    if (!element_) {
      filled.alike = body(name_);
      make_.add(filled.alike, "polygon", make_.ring({}));
    }
    return filled;
  }

 private:
  // The file of a region may have holes as well.
  void read_region(const JsonValue& region, const JsonValue* holes) {
    constexpr const char* kNoHole = "a hole of the region is one ring";
    Rings rings = rings_of(read_polygon(in_, region));
    for (size_t i = 1; i < rings.size(); ++i) holes_.emplace_back(std::move(rings[i]));
    outline_.emplace(std::move(rings[0]));
    if (!holes) return;
    for (const JsonValue& hole : in_.array(*holes)) {
      holes_.push_back(read_polygon_without_holes(in_, hole, kNoHole));
    }
  }

  void mesh(const JsonValue* value) {
    if (!value) return;
    JsonObject object(in_, *value);
    mesh_size_ = in_.positive(object.required("size", "of the elements, in m"), "m");
    ElementKind kind = ElementKind::quad4;
    object.choose("element", kind, names_of(kElements));
    element_ = &kElements[static_cast<size_t>(kind)];
    object.finish();
  }

  void repeat(const JsonValue* value, Filled& filled) const {
    if (!value) return;
    JsonObject object(in_, *value);
    const JsonValue& times = object.required("times", "how often, the first time included");
    filled.batches = in_.count(times);
    if (filled.batches < 1) in_.fail(times, "must be 1 or more");
    object.read("every", filled.every, &JsonReader::not_negative, "s");
    object.finish();
    if (arranged_ == Arranged::voronoi) {
      in_.fail(*value, "has no meaning for Voronoi cells, which fill the region; leave it out");
    }
  }

  void cells(JsonObject& object, std::uint64_t seed) {
    const JsonValue& count = object.required("count", "the number of cells");
    cells_.cells = in_.count(count);
    if (cells_.cells < 1) in_.fail(count, "must be 1 or more");
    cells_.seed = seed;
    object.read("convex", cells_.convex, &JsonReader::boolean);
    object.read("smallest_angle", cells_.smallest_angle, &JsonReader::number, "rad");
    for (const char* key : {"shapes", "diameter", "solid_fraction", "angle"}) {
      if (const JsonValue* v = object.optional(key)) {
        in_.fail(*v, "has no meaning for Voronoi cells, which fill the region; leave it out");
      }
    }
  }

  [[nodiscard]] const JsonValue& place_of_holes() const {
    const JsonValue* holes = value_.find("holes");
    return holes ? *holes : *value_.find("region");
  }

  void blocks(JsonObject& object) {
    for (const char* key : {"convex", "smallest_angle"}) {
      if (const JsonValue* v = object.optional(key)) {
        in_.fail(*v, "is for the arrangement \"voronoi\"; leave it out");
      }
    }
    blocks_.read(object);
    const JsonValue* count = object.optional("count");
    const JsonValue* fraction = object.optional("solid_fraction");
    if (!count == !fraction) {
      in_.fail(fraction ? *fraction : value_, "must give either \"count\" or \"solid_fraction\"");
    }
    if (count) {
      count_ = in_.count(*count);
      if (*count_ < 1 || *count_ > kMostBlocks) {
        in_.fail(*count, fmt::format("must be from 1 to {}", kMostBlocks));
      }
    } else {
      fraction_ = in_.positive(*fraction, "");
      if (!(fraction_ < 1)) in_.fail(*fraction, "must be less than 1");
    }
  }

  std::vector<Block> draw_all(RandomNumbers& random, double area) const {
    std::vector<Block> blocks;
    if (count_) {
      for (int i = 0; i < *count_; ++i) blocks.push_back(blocks_.draw(random));
      return blocks;
    }
    double solid = 0;
    while (true) {
      Block next = blocks_.draw(random);
      const double with_it = solid + next.scale * next.scale, goal = fraction_ * area;
      if (with_it > goal && with_it - goal > goal - solid) return blocks;
      solid = with_it;
      blocks.push_back(std::move(next));
      if (blocks.size() > kMostBlocks) {
        in_.fail(value_, fmt::format("would need more than {} blocks", kMostBlocks));
      }
    }
  }

  [[nodiscard]] Polygon region_without_holes() const {
    Rings rings = rings_of(*outline_);
    for (const Polygon& hole : holes_) rings.push_back(hole.vertices());
    try {
      return Polygon(polygon_of_rings(rings));
    } catch (const InvalidPolygon& error) {
      in_.fail(place_of_holes(), error.what());
    }
  }

  [[nodiscard]] PackingSpace space_of(const std::vector<PolygonWithHoles>& obstacles, double size,
                                      const std::vector<Polygon>& holes) const {
    for (const Polygon& hole : holes) {
      for (const Vec2& v : hole.vertices()) {
        const Box box = bounding_box(*outline_);
        if (v.x() < box.x0 || v.x() > box.x1 || v.y() < box.y0 || v.y() > box.y1) {
          in_.fail(place_of_holes(), "must lie inside the region");
        }
      }
    }
    PackingSpace space(*outline_, holes, gap_, size);
    for (const PolygonWithHoles& obstacle : obstacles) space.add_obstacle(obstacle);
    return space;
  }

  // Before they are made: `count` blocks, of this area together, in each of some batches.
  void refuse_too_many(int count, double area, int batches) const {
    const double elements = element_ ? area / (mesh_size_ * mesh_size_) : 0;  // of a batch
    const double bytes = batches * (kBodyBytes * count + kElementBytes * elements);
    const double there = memory_limit();
    if (bytes < there) return;
    const JsonValue* const times = value_.find("repeat");
    in_.fail(times && batches > 1 ? *times : value_,
             fmt::format("{}{} bodies{} take about {:.2g} GB of memory, and there are "
                         "{:.2g} GB; give fewer",
                         batches > 1 ? fmt::format("{} batches of ", batches) : "", count,
                         element_ ? fmt::format(" with {:.2g} elements", std::ceil(elements)) : "",
                         bytes / 1e9, there / 1e9));
  }

  std::vector<PolygonWithHoles> add_blocks(const std::vector<PolygonWithHoles>& obstacles,
                                           RandomNumbers& random, Filled& filled) {
    double area = area_moments(*outline_).area;
    for (const Polygon& hole : holes_) area -= area_moments(hole).area;
    const std::vector<Block> blocks = draw_all(random, area);
    double size = 0;
    for (const Block& b : blocks) size += b.scale / static_cast<double>(blocks.size());
    PackingSpace space = space_of(obstacles, blocks.empty() ? 1 : size, holes_);
    const Arrangement found =
        arranged_ == Arranged::random    ? insert_at_random(space, random, blocks)
        : arranged_ == Arranged::lattice ? put_on_lattice(space, blocks)
                                         : grow(space, random, blocks, blocks_.turn());
    refuse_shortfall(blocks, found, space.area());
    std::vector<PolygonWithHoles> placed;
    placed.reserve(found.rings.size());
    for (const int i : along_curve(found.rings)) {
      placed.push_back({found.rings[i], holes_of(blocks[i], found.poses[i])});
      add_body(filled, placed.back());
    }
    return placed;
  }

  // The numbers of blocks are such that neighbours in space are near each other in memory.
  static std::vector<int> along_curve(const std::vector<std::vector<Vec2>>& rings) {
    std::vector<Vec2> middles;
    middles.reserve(rings.size());
    for (const std::vector<Vec2>& ring : rings) {
      const Vec2 sum = std::accumulate(ring.begin(), ring.end(), Vec2(Vec2::Zero()));
      middles.emplace_back(sum / static_cast<double>(ring.size()));
    }
    return hilbert_order(middles);
  }

  void refuse_shortfall(const std::vector<Block>& blocks, const Arrangement& found,
                        double area) const {
    const auto solid = [&](double part, double whole) {
      return fmt::format("solid fraction {:.3g} instead of {:.3g}", part / area, whole / area);
    };
    double all = 0, placed = 0;
    for (size_t i = 0; i < blocks.size(); ++i) {
      const double own = blocks[i].scale * blocks[i].scale;
      all += own;
      if (!found.rings[i].empty()) placed += own;
    }
    if (found.placed < static_cast<int>(blocks.size())) {
      in_.fail(value_, fmt::format("{} of {} blocks could be placed ({}): give fewer or "
                                   "smaller blocks, a larger region, or another arrangement; "
                                   "\"dense\" packs most",
                                   found.placed, blocks.size(), solid(placed, all)));
    }
    if (found.scale < 1) {
      const double part = found.scale * found.scale;
      in_.fail(value_,
               fmt::format("{} of {} blocks could be placed: all {} fit at {:.4g} of their size "
                           "only ({}); give fewer or smaller blocks, or a larger region",
                           static_cast<int>(part * static_cast<double>(blocks.size())),
                           blocks.size(), blocks.size(), found.scale, solid(part * all, all)));
    }
  }

  void add_cells(std::vector<PolygonWithHoles>& obstacles, Filled& filled) const {
    const Polygon region = region_without_holes();
    // The cells tile the region, so its holes need no test.
    const PackingSpace space =
        space_of(obstacles, std::sqrt(area_moments(region).area / cells_.cells), {});
    try {
      const std::vector<std::vector<Vec2>> rings = voronoi_blocks(region, cells_, gap_);
      for (const int i : along_curve(rings)) {
        const std::vector<Vec2>& ring = rings[i];
        if (!space.is_clear(shrunk(ring, kTouching))) {
          in_.fail(value_,
                   "a cell of the region overlaps a body of the scene; keep bodies out of "
                   "the region");
        }
        add_body(filled, {ring, {}});
        obstacles.push_back({ring, {}});
      }
    } catch (const std::invalid_argument& error) {
      in_.fail(value_, error.what());
    }
  }

  void add_body(Filled& filled, const PolygonWithHoles& shape) const {
    const int number = filled.count++;
    if (!element_) {
      try {
        filled.polygons.emplace_back(shape);
      } catch (const InvalidPolygon& error) {
        refuse_polygon(in_, value_, error);
      }
      return;
    }
    JsonValue body = this->body(numbered(name_, number));
    make_.add(body, "mesh", mesh_value(shape, static_cast<size_t>(number)));
    filled.bodies.push_back(std::move(body));
  }

  // As it would stand in the scene, but for its shape.
  [[nodiscard]] JsonValue body(const std::string& name) const {
    JsonValue body = make_.object();
    make_.add(body, "name", make_.string(name));
    make_.add(body, "material", *value_.find("material"));
    if (velocity_) make_.add(body, "velocity", *velocity_);
    if (spin_) make_.add(body, "spin", *spin_);
    return body;
  }

  [[nodiscard]] JsonValue mesh_value(const PolygonWithHoles& shape, size_t number) const {
    JsonValue way = make_.object();
    make_.add(way, "polygon", make_.ring(shape.outer));
    if (!shape.holes.empty()) make_.add(way, "holes", make_.rings(shape.holes));
    const bool cells = element_->kind == ElementKind::polygon;
    if (cells) {
      const double count = std::max(1., std::round(area_of(shape) / (mesh_size_ * mesh_size_)));
      make_.add(way, "cells", make_.number(count));
      make_.add(way, "seed", make_.number(static_cast<double>(number)));
    } else {
      make_.add(way, "size", make_.number(mesh_size_));
    }
    JsonValue mesh = make_.object();
    make_.add(mesh, cells ? "voronoi" : "fill", std::move(way));
    make_.add(mesh, "element", make_.string(std::string(element_->name)));
    return mesh;
  }

  const JsonReader& in_;
  const JsonValue& value_;
  ValueMaker make_;
  std::string name_;
  std::optional<Polygon> outline_;
  std::vector<Polygon> holes_;
  Arranged arranged_ = Arranged::random;
  double gap_ = 0;
  const JsonValue* velocity_ = nullptr;
  const JsonValue* spin_ = nullptr;
  double mesh_size_ = 0;
  const ElementName* element_ = nullptr;  // null: rigid
  VoronoiOptions cells_;
  BlockReader blocks_;
  std::optional<int> count_;
  double fraction_ = 0;
};

}  // namespace

std::vector<Filled> read_fills(const JsonReader& in, const JsonValue& list,
                               std::vector<PolygonWithHoles> obstacles) {
  std::vector<Filled> fills;
  for (const JsonValue& value : in.array(list)) fills.push_back(Fill(in, value).read(obstacles));
  return fills;
}

}  // namespace apothem
