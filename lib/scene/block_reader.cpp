#include "lib/scene/block_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "geometry/packing/block_shapes.hpp"
#include "lib/execution/elementary.hpp"
#include "lib/scene/polygon_value.hpp"

namespace apothem {
namespace {

constexpr double kSharpest = 50 * M_PI / 180, kBluntest = 130 * M_PI / 180;  // of quadrilaterals

double disc_area(double diameter) { return M_PI / 4 * diameter * diameter; }

}  // namespace

void BlockReader::read(JsonObject& fill) {
  const JsonValue& list = fill.required("shapes", "[{\"quadrilateral\": {}}, ...]");
  if (in_.array(list).empty()) in_.fail(list, "must hold at least one shape");
  for (const JsonValue& item : list.items()) shapes_.push_back(shape(item));
  const JsonValue* size = fill.optional("diameter");
  if (size) {
    diameter_ = diameter(*size);
  } else if (!std::ranges::all_of(shapes_,
                                  [](const Shape& s) { return s.own_diameter.has_value(); })) {
    fill.required("diameter",
                  "of the disc of equal area, in m; only given polygons have a "
                  "size of their own");
  }
  if (const JsonValue* v = fill.optional("angle")) {
    if (v->type() == JsonValue::Type::string) {
      in_.choice(*v, {"random"});
    } else {
      angles_ = range(*v, -HUGE_VAL, HUGE_VAL, "rad");
    }
  }
}

// [from, to], or one number for both.
BlockReader::Bounds BlockReader::range(const JsonValue& value, double least, double most,
                                       const std::string& unit) const {
  Bounds bounds{};
  if (value.type() == JsonValue::Type::number) {
    bounds = {value.number(), value.number()};
  } else {
    const std::vector<double> given = in_.numbers(value, 2, "[from, to] in " + unit);
    bounds = {given[0], given[1]};
  }
  if (!(bounds[0] >= least && bounds[1] <= most && bounds[0] <= bounds[1])) {
    in_.fail(value, most < HUGE_VAL
                        ? fmt::format("must be ascending, from {:g} to {:g} {}", least, most, unit)
                        : fmt::format("must be ascending, {:g} {} or more", least, unit));
  }
  return bounds;
}

BlockReader::Shape BlockReader::shape(const JsonValue& value) const {
  JsonObject object(in_, value);
  Shape shape;
  object.read("weight", shape.weight, &JsonReader::positive, "");
  int kinds = 0;
  if (const JsonValue* v = object.optional("polygon")) {
    const Polygon polygon = read_polygon(in_, *v, value.find("holes"));
    shape.own_diameter = std::sqrt(area_moments(polygon).area / disc_area(1));
    if (polygon.has_holes()) {
      PolygonWithHoles block = normalised_with_holes(polygon);
      shape.ring = [ring = std::move(block.outer)](RandomNumbers&) { return ring; };
      shape.holes = std::move(block.holes);
    } else {
      shape.ring = [ring = normalised(polygon.vertices())](RandomNumbers&) { return ring; };
    }
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
  if (const JsonValue* v = object.optional("holes"); v && !value.find("polygon")) {
    in_.fail(*v, "belongs to a \"polygon\"; other shapes have no holes");
  }
  object.finish();
  if (kinds != 1) {
    in_.fail(value, "must give one of polygon, quadrilateral, polygon_random, cross");
  }
  return shape;
}

BlockReader::DrawRing BlockReader::quadrilateral(const JsonValue& value) const {
  JsonObject object(in_, value);
  Bounds angles{kSharpest, kBluntest};
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

BlockReader::DrawRing BlockReader::convex(const JsonValue& value) const {
  JsonObject object(in_, value);
  const JsonValue& number = object.required("corners", "[from, to], or one number");
  const Bounds corners = range(number, 3, 1000, "corners");
  for (const double n : corners) {
    if (n != std::floor(n)) in_.fail(number, "must be whole numbers");
  }
  Bounds aspects{1, 1}, roundnesses{.5, .5};
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

BlockReader::Draw BlockReader::diameter(const JsonValue& value) const {
  if (value.type() == JsonValue::Type::number) {
    return [d = in_.positive(value, "m")](RandomNumbers&) { return d; };
  }
  JsonObject object(in_, value);
  Draw draw;
  int kinds = 0;
  if (const JsonValue* v = object.optional("uniform")) {
    const Bounds d = positive_range(*v);
    draw = [d](RandomNumbers& random) { return random.uniform(d[0], d[1]); };
    ++kinds;
  }
  if (const JsonValue* v = object.optional("uniform_area")) {
    const Bounds d = positive_range(*v);
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

BlockReader::Bounds BlockReader::positive_range(const JsonValue& value) const {
  const Bounds bounds = range(value, 0, HUGE_VAL, "m");
  if (!(bounds[0] > 0)) in_.fail(value, "must be positive lengths in m");
  return bounds;
}

BlockReader::Draw BlockReader::lognormal(const JsonValue& value) const {
  JsonObject object(in_, value);
  const double median = in_.positive(object.required("median", "in m"), "m");
  const double sigma =
      in_.positive(object.required("sigma", "standard deviation of the logarithm"), "");
  const JsonValue& limits = object.required("between", "[smallest, largest] in m");
  const Bounds between = positive_range(limits);
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

BlockReader::Draw BlockReader::table(const JsonValue& value) const {
  std::vector<Bounds> rows;  // diameter, sum of the shares so far
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

Block BlockReader::draw(RandomNumbers& random) const {
  double weights = 0;
  for (const Shape& s : shapes_) weights += s.weight;
  double left = shapes_.size() > 1 ? random.uniform(0, weights) : 0;
  size_t i = 0;
  for (; i + 1 < shapes_.size() && left >= shapes_[i].weight; ++i) left -= shapes_[i].weight;
  Block block;
  block.shape = shapes_[i].ring(random);
  block.holes = shapes_[i].holes;
  const double d = diameter_ ? diameter_(random) : *shapes_[i].own_diameter;
  block.scale = std::sqrt(disc_area(d));
  block.angle = angles_[0] < angles_[1] ? random.uniform(angles_[0], angles_[1]) : angles_[0];
  return block;
}

}  // namespace apothem
