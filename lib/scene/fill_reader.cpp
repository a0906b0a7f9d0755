#include "lib/scene/fill_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <optional>

#include "geometry/packing/block_shapes.hpp"
#include "geometry/packing/voronoi_blocks.hpp"
#include "geometry/polygon/ring_moments.hpp"
#include "geometry/spatial/hilbert.hpp"
#include "lib/execution/elementary.hpp"
#include "lib/fem/kinds.hpp"
#include "lib/scene/body_reader.hpp"
#include "lib/scene/polygon_value.hpp"
#include "lib/scene/value_maker.hpp"
#include "lib/system/memory.hpp"

namespace apothem {
namespace {

constexpr int kMostBlocks = 10'000'000;
// What a body and an element of a scene take in memory, measured with meshes of squares, bytes.
constexpr double kBodyBytes = 4e3, kElementBytes = 1.1e3;
constexpr double kTouching = 1e-7;  // of the size of a cell
constexpr double kSharpest = 50 * M_PI / 180, kBluntest = 130 * M_PI / 180;  // of quadrilaterals

// A number that is drawn for each block.
using Draw = std::function<double(RandomNumbers&)>;

// One of the shapes that blocks are drawn from.
struct Shape {
  double weight = 1;
  std::function<std::vector<Vec2>(RandomNumbers&)> ring;  // of area 1
  std::optional<double> own_diameter;                     // m
};

enum class Arranged { random, lattice, dense, voronoi };

double disc_area(double diameter) { return M_PI / 4 * diameter * diameter; }

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
  Fill(const JsonReader& in, const JsonValue& value) : in_(in), value_(value), make_(value) {}

  Filled read(std::vector<std::vector<Vec2>>& obstacles) {
    JsonObject object(in_, value_);
    name_ = in_.string(object.required("name", "a string; bodies are called NAME-0, NAME-1, ..."));
    object.required("material", "the name of a material");
    const JsonValue& region = object.required("region", "[[x,y],...] in m");
    outline_.emplace(read_polygon(in_, region));
    if (const JsonValue* v = object.optional("holes")) {
      for (const JsonValue& hole : in_.array(*v)) holes_.push_back(read_polygon(in_, hole));
    }
    if (const JsonValue* v = object.optional("arrangement")) {
      arranged_ = static_cast<Arranged>(in_.choice(*v, {"random", "lattice", "dense", "voronoi"}));
    }
    if (const JsonValue* v = object.optional("gap")) gap_ = in_.not_negative(*v, "m");
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
      shapes(object);
    }
    object.finish();
    if (arranged_ == Arranged::voronoi) {
      add_cells(obstacles, filled);
    } else {
      // Batches do not keep clear of each other: a later one waits until nothing is in its way.
      std::vector<std::vector<Vec2>> first;
      if (count_) refuse_too_many(*count_, 0, filled.batches);
      for (int batch = 0; batch < filled.batches; ++batch) {
        std::vector<std::vector<Vec2>> rings = add_blocks(obstacles, random, filled);
        if (batch > 0) continue;
        first = std::move(rings);
        double area = 0;
        for (const std::vector<Vec2>& ring : first) area += ring_area(ring);
        refuse_too_many(filled.count, area, filled.batches);
      }
      obstacles.insert(obstacles.end(), first.begin(), first.end());
    }
    filled.batch = filled.count / filled.batches;
    if (!element_) {
      filled.alike = body(name_);
      make_.add(filled.alike, "polygon", make_.ring({}));
    }
    return filled;
  }

 private:
  // [from, to], or one number for both.
  [[nodiscard]] std::array<double, 2> range(const JsonValue& value, double least, double most,
                                            const std::string& unit) const {
    std::array<double, 2> bounds{};
    if (value.type() == JsonValue::Type::number) {
      bounds = {value.number(), value.number()};
    } else {
      const std::vector<double> given = in_.numbers(value, 2, "[from, to] in " + unit);
      bounds = {given[0], given[1]};
    }
    if (!(bounds[0] >= least && bounds[1] <= most && bounds[0] <= bounds[1])) {
      in_.fail(value,
               most < HUGE_VAL
                   ? fmt::format("must be ascending, from {:g} to {:g} {}", least, most, unit)
                   : fmt::format("must be ascending, {:g} {} or more", least, unit));
    }
    return bounds;
  }

  void mesh(const JsonValue* value) {
    if (!value) return;
    JsonObject object(in_, *value);
    mesh_size_ = in_.positive(object.required("size", "of the elements, in m"), "m");
    if (const JsonValue* v = object.optional("element")) {
      std::vector<std::string> names;
      names.reserve(std::size(kElements));
      for (const ElementName& e : kElements) names.emplace_back(e.name);
      element_ = &kElements[static_cast<size_t>(in_.choice(*v, names))];
    } else {
      element_ = &kElements[static_cast<size_t>(ElementKind::quad4)];
    }
    object.finish();
  }

  void repeat(const JsonValue* value, Filled& filled) const {
    if (!value) return;
    JsonObject object(in_, *value);
    const JsonValue& times = object.required("times", "how often, the first time included");
    filled.batches = in_.count(times);
    if (filled.batches < 1) in_.fail(times, "must be 1 or more");
    if (const JsonValue* v = object.optional("every")) filled.every = in_.not_negative(*v, "s");
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
    for (const char* key : {"shapes", "diameter", "solid_fraction", "angle"}) {
      if (const JsonValue* v = object.optional(key)) {
        in_.fail(*v, "has no meaning for Voronoi cells, which fill the region; leave it out");
      }
    }
    if (!holes_.empty()) {
      in_.fail(*value_.find("holes"),
               "Voronoi cells of a region with holes are not supported yet; cut the region so that "
               "it has none");
    }
  }

  void shapes(JsonObject& object) {
    const JsonValue& list = object.required("shapes", "[{\"quadrilateral\": {}}, ...]");
    if (in_.array(list).empty()) in_.fail(list, "must hold at least one shape");
    for (const JsonValue& item : list.items()) shapes_.push_back(shape(item));
    const JsonValue* size = object.optional("diameter");
    if (size) {
      diameter_ = diameter(*size);
    } else if (!std::all_of(shapes_.begin(), shapes_.end(),
                            [](const Shape& s) { return s.own_diameter.has_value(); })) {
      object.required("diameter",
                      "of the disc of equal area, in m; only given polygons have a "
                      "size of their own");
    }
    if (const JsonValue* v = object.optional("angle")) {
      if (v->type() == JsonValue::Type::string) {
        in_.choice(*v, {"random"});
      } else {
        angles_ = range(*v, -HUGE_VAL, HUGE_VAL, "rad");
      }
    }
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

  Shape shape(const JsonValue& value) const {
    JsonObject object(in_, value);
    Shape shape;
    if (const JsonValue* v = object.optional("weight")) shape.weight = in_.positive(*v, "");
    int kinds = 0;
    if (const JsonValue* v = object.optional("polygon")) {
      const Polygon polygon = read_polygon(in_, *v);
      shape.own_diameter = std::sqrt(area_moments(polygon).area / disc_area(1));
      shape.ring = [ring = normalised(polygon.vertices())](RandomNumbers&) { return ring; };
      ++kinds;
    }
    if (const JsonValue* v = object.optional("quadrilateral"))
      shape.ring = quadrilateral(*v), ++kinds;
    if (const JsonValue* v = object.optional("polygon_random")) shape.ring = convex(*v), ++kinds;
    if (const JsonValue* v = object.optional("cross")) {
      JsonObject cross(in_, *v);
      const JsonValue* arm = cross.optional("arm");
      cross.finish();
      shape.ring = [ring = cross_shape(arm ? in_.positive(*arm, "widths") : 1)](RandomNumbers&) {
        return ring;
      };
      ++kinds;
    }
    object.finish();
    if (kinds != 1) {
      in_.fail(value, "must give one of polygon, quadrilateral, polygon_random, cross");
    }
    return shape;
  }

  std::function<std::vector<Vec2>(RandomNumbers&)> quadrilateral(const JsonValue& value) const {
    JsonObject object(in_, value);
    std::array<double, 2> angles{kSharpest, kBluntest};
    if (const JsonValue* v = object.optional("angles")) {
      angles = range(*v, 0, M_PI, "rad");
      if (!(angles[0] < M_PI / 2 && angles[1] > M_PI / 2)) {
        in_.fail(*v, "must include pi/2, the mean angle of every quadrilateral");
      }
      try {
        RandomNumbers trial(1);
        random_quadrilateral(trial, angles[0], angles[1]);
      } catch (const std::invalid_argument& error) {
        in_.fail(*v, error.what());
      }
    }
    object.finish();
    return [angles](RandomNumbers& random) {
      return random_quadrilateral(random, angles[0], angles[1]);
    };
  }

  std::function<std::vector<Vec2>(RandomNumbers&)> convex(const JsonValue& value) const {
    JsonObject object(in_, value);
    const JsonValue& number = object.required("corners", "[from, to], or one number");
    const std::array<double, 2> corners = range(number, 3, 1000, "corners");
    for (const double n : corners) {
      if (n != std::floor(n)) in_.fail(number, "must be whole numbers");
    }
    std::array<double, 2> aspects{1, 1}, roundnesses{.5, .5};
    if (const JsonValue* v = object.optional("aspect")) aspects = range(*v, 1, 1000, "");
    if (const JsonValue* v = object.optional("roundness")) roundnesses = range(*v, 0, 1, "");
    object.finish();
    return [=](RandomNumbers& random) {
      const int n = random.whole(static_cast<int>(corners[0]), static_cast<int>(corners[1]));
      const double aspect = random.uniform(aspects[0], aspects[1]);
      const double roundness = random.uniform(roundnesses[0], roundnesses[1]);
      return random_polygon(random, n, aspect, roundness);
    };
  }

  Draw diameter(const JsonValue& value) const {
    if (value.type() == JsonValue::Type::number) {
      return [d = in_.positive(value, "m")](RandomNumbers&) { return d; };
    }
    JsonObject object(in_, value);
    Draw draw;
    int kinds = 0;
    if (const JsonValue* v = object.optional("uniform")) {
      const std::array<double, 2> d = positive_range(*v);
      draw = [d](RandomNumbers& random) { return random.uniform(d[0], d[1]); };
      ++kinds;
    }
    if (const JsonValue* v = object.optional("uniform_area")) {
      const std::array<double, 2> d = positive_range(*v);
      draw = [d](RandomNumbers& random) {
        return std::sqrt(random.uniform(d[0] * d[0], d[1] * d[1]));
      };
      ++kinds;
    }
    if (const JsonValue* v = object.optional("lognormal")) draw = lognormal(*v), ++kinds;
    if (const JsonValue* v = object.optional("table")) draw = table(*v), ++kinds;
    object.finish();
    if (kinds != 1) {
      in_.fail(value,
               "must be a number in m, or give one of uniform, uniform_area, lognormal, "
               "table");
    }
    return draw;
  }

  [[nodiscard]] std::array<double, 2> positive_range(const JsonValue& value) const {
    const std::array<double, 2> bounds = range(value, 0, HUGE_VAL, "m");
    if (!(bounds[0] > 0)) in_.fail(value, "must be positive lengths in m");
    return bounds;
  }

  Draw lognormal(const JsonValue& value) const {
    JsonObject object(in_, value);
    const double median = in_.positive(object.required("median", "in m"), "m");
    const double sigma =
        in_.positive(object.required("sigma", "standard deviation of the logarithm"), "");
    const JsonValue& limits = object.required("between", "[smallest, largest] in m");
    const std::array<double, 2> between = positive_range(limits);
    object.finish();
    if (!(between[0] < median && median < between[1])) {
      in_.fail(limits, "must have the median inside");
    }
    return [=](RandomNumbers& random) {
      double d = 0;
      do d = median * exponential(sigma * random.normal());
      while (!(d >= between[0] && d <= between[1]));
      return d;
    };
  }

  Draw table(const JsonValue& value) const {
    std::vector<std::array<double, 2>> rows;  // diameter, sum of the shares so far
    double sum = 0;
    for (const JsonValue& item : in_.array(value)) {
      const std::vector<double> row =
          in_.numbers(item, 2, "[diameter in m, share of the number of blocks]");
      if (!(row[0] > 0 && row[1] > 0)) in_.fail(item, "must be two positive numbers");
      rows.push_back({row[0], sum += row[1]});
    }
    if (rows.empty()) in_.fail(value, "must hold at least one row");
    return [rows](RandomNumbers& random) {
      const double share = random.uniform(0, rows.back()[1]);
      size_t i = 0;
      while (i + 1 < rows.size() && share >= rows[i][1]) ++i;
      return rows[i][0];
    };
  }

  [[nodiscard]] Block draw(RandomNumbers& random) const {
    double weights = 0;
    for (const Shape& s : shapes_) weights += s.weight;
    double left = shapes_.size() > 1 ? random.uniform(0, weights) : 0;
    size_t i = 0;
    for (; i + 1 < shapes_.size() && left >= shapes_[i].weight; ++i) left -= shapes_[i].weight;
    Block block;
    block.shape = shapes_[i].ring(random);
    const double d = diameter_ ? diameter_(random) : *shapes_[i].own_diameter;
    block.scale = std::sqrt(disc_area(d));
    block.angle = angles_[0] < angles_[1] ? random.uniform(angles_[0], angles_[1]) : angles_[0];
    return block;
  }

  std::vector<Block> draw_all(RandomNumbers& random, double area) const {
    std::vector<Block> blocks;
    if (count_) {
      for (int i = 0; i < *count_; ++i) blocks.push_back(draw(random));
      return blocks;
    }
    double solid = 0;
    while (true) {
      Block next = draw(random);
      const double with_it = solid + next.scale * next.scale, goal = fraction_ * area;
      if (with_it > goal && with_it - goal > goal - solid) return blocks;
      solid = with_it;
      blocks.push_back(std::move(next));
      if (blocks.size() > kMostBlocks) {
        in_.fail(value_, fmt::format("would need more than {} blocks", kMostBlocks));
      }
    }
  }

  [[nodiscard]] PackingSpace space_of(const std::vector<std::vector<Vec2>>& obstacles,
                                      double size) const {
    for (const Polygon& hole : holes_) {
      for (const Vec2& v : hole.vertices()) {
        const Box box = bounding_box(*outline_);
        if (v.x() < box.x0 || v.x() > box.x1 || v.y() < box.y0 || v.y() > box.y1) {
          in_.fail(*value_.find("holes"), "must lie inside the region");
        }
      }
    }
    PackingSpace space(*outline_, holes_, gap_, size);
    for (const std::vector<Vec2>& ring : obstacles) space.add_obstacle(ring);
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

  std::vector<std::vector<Vec2>> add_blocks(const std::vector<std::vector<Vec2>>& obstacles,
                                            RandomNumbers& random, Filled& filled) {
    double area = area_moments(*outline_).area;
    for (const Polygon& hole : holes_) area -= area_moments(hole).area;
    const std::vector<Block> blocks = draw_all(random, area);
    double size = 0;
    for (const Block& b : blocks) size += b.scale / static_cast<double>(blocks.size());
    PackingSpace space = space_of(obstacles, blocks.empty() ? 1 : size);
    const bool turns = angles_[0] < angles_[1];
    const Arrangement found = arranged_ == Arranged::random
                                  ? insert_at_random(space, random, blocks)
                              : arranged_ == Arranged::lattice ? put_on_lattice(space, blocks)
                                                               : grow(space, random, blocks, turns);
    refuse_shortfall(blocks, found, space.area());
    std::vector<std::vector<Vec2>> rings;
    rings.reserve(found.rings.size());
    for (const int i : along_curve(found.rings)) {
      add_body(filled, found.rings[i]);
      rings.push_back(found.rings[i]);
    }
    return rings;
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

  void add_cells(std::vector<std::vector<Vec2>>& obstacles, Filled& filled) const {
    const double size = std::sqrt(area_moments(*outline_).area / cells_.cells);
    const PackingSpace space = space_of(obstacles, size);
    try {
      const std::vector<std::vector<Vec2>> rings = voronoi_blocks(*outline_, cells_, gap_);
      for (const int i : along_curve(rings)) {
        const std::vector<Vec2>& ring = rings[i];
        if (!space.is_clear(shrunk(ring, kTouching))) {
          in_.fail(value_,
                   "a cell of the region overlaps a body of the scene; keep bodies out of "
                   "the region");
        }
        add_body(filled, ring);
        obstacles.push_back(ring);
      }
    } catch (const std::invalid_argument& error) {
      in_.fail(value_, error.what());
    }
  }

  void add_body(Filled& filled, const std::vector<Vec2>& ring) const {
    const int number = filled.count++;
    if (!element_) {
      try {
        filled.polygons.emplace_back(ring);
      } catch (const InvalidPolygon& error) {
        refuse_polygon(in_, value_, error);
      }
      return;
    }
    JsonValue body = this->body(numbered(name_, number));
    make_.add(body, "mesh", mesh_value(ring, static_cast<size_t>(number)));
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

  [[nodiscard]] JsonValue mesh_value(const std::vector<Vec2>& ring, size_t number) const {
    JsonValue way = make_.object();
    make_.add(way, "polygon", make_.ring(ring));
    const bool cells = element_->kind == ElementKind::polygon;
    if (cells) {
      const double count = std::max(1., std::round(ring_area(ring) / (mesh_size_ * mesh_size_)));
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
  std::vector<Shape> shapes_;
  Draw diameter_;
  std::array<double, 2> angles_{0, 2 * M_PI};
  std::optional<int> count_;
  double fraction_ = 0;
};

}  // namespace

std::vector<Filled> FillReader::read(const JsonValue& list) {
  std::vector<Filled> fills;
  for (const JsonValue& value : in_.array(list)) {
    fills.push_back(Fill(in_, value).read(obstacles_));
  }
  return fills;
}

}  // namespace apothem
