#include "lib/scene/population_reader.hpp"

#include <algorithm>

#include "geometry/polygon/convex_parts.hpp"
#include "lib/scene/output_reader.hpp"
#include "lib/scene/polygon_value.hpp"
#include "lib/text/words.hpp"

namespace apothem {
namespace {

StopRule read_stop(const JsonReader& in, const JsonValue& value, const Model& model) {
  JsonObject object(in, value);
  StopRule rule;
  rule.name = in.string(object.required("name", "a string, for \"stopped_by\""));
  if (const JsonValue* v = object.optional("region")) {
    const std::vector<std::string> names = names_of(model.regions);
    const auto found = std::ranges::find(names, in.string(*v));
    if (found == names.end()) in.fail(*v, "unknown region " + suggest(v->string(), names));
    rule.region = static_cast<int>(found - names.begin());
  }
  int conditions = 0;
  if (const JsonValue* v = object.optional("kinetic_per_body")) {
    rule.kinetic_per_body = in.positive(*v, "J");
    ++conditions;
  }
  if (const JsonValue* v = object.optional("count_below")) {
    rule.count_below = in.count(*v);
    ++conditions;
  }
  if (const JsonValue* v = object.optional("count_above")) {
    rule.count_above = in.count(*v);
    ++conditions;
  }
  if (const JsonValue* v = object.optional("no_exit_for")) {
    rule.no_exit_for = in.positive(*v, "s");
    if (rule.region < 0) in.fail(*v, "needs a \"region\" that bodies can leave");
    ++conditions;
  }
  if (const JsonValue* v = object.optional("wall_clock")) {
    rule.wall_clock = in.positive(*v, "s of real time");
    if (conditions > 0) in.fail(*v, "stands alone; make two entries");
    ++conditions;
  }
  object.read("for", rule.hold, &JsonReader::not_negative, "s");
  object.read("after", rule.after, &JsonReader::not_negative, "s");
  object.finish();
  if (conditions == 0) {
    in.fail(value,
            "must give one or more of kinetic_per_body, count_below, count_above, "
            "no_exit_for, wall_clock");
  }
  return rule;
}

}  // namespace

void read_world(const JsonReader& in, const JsonValue& value, Model& model,
                UsedFeatures& features) {
  JsonObject object(in, value);
  if (const JsonValue* v = object.optional("periodic")) {
    in.fail(*v, "periodic cells are not supported yet; leave it out");
  }
  const JsonValue& box = object.required("box", "[[x0, y0], [x1, y1]] in m");
  if (in.array(box).size() != 2) in.fail(box, "must be [[x0, y0], [x1, y1]] in m");
  const Vec2 low = in.vec2(box.items()[0], "m") - model.origin;
  const Vec2 high = in.vec2(box.items()[1], "m") - model.origin;
  if (!(low.x() < high.x() && low.y() < high.y())) {
    in.fail(box, "must be two corners, the lower left one first");
  }
  model.world.box = {low.x(), low.y(), high.x(), high.y()};
  const JsonValue& outside =
      object.required("outside",
                      "what happens to bodies that leave the box: \"keep\", \"remove\" "
                      "or \"stop\"");
  object.finish();
  model.world.outside = in.choice<World::Outside>(outside, kOutsides);
  if (model.world.outside != World::Outside::keep) features.add(Feature::outside, &outside);
}

void read_regions(const JsonReader& in, const JsonValue& value, Model& model) {
  if (value.type() != JsonValue::Type::object) {
    in.fail(value, "must be {\"NAME\": {\"polygon\": [[x,y],...]}, ...}");
  }
  for (size_t i = 0; i < value.items().size(); ++i) {
    const JsonValue& item = value.items()[i];
    const std::string& name = value.keys()[i];
    if (name.empty() || has_control_character(name) ||
        name.find_first_of(",\"[]") != std::string::npos) {
      in.fail(item,
              "has a name that cannot head the columns of a table: it must not be empty nor "
              "hold , \" [ ]");
    }
    JsonObject object(in, item);
    const JsonValue& outline = object.required("polygon", "[[x,y],...] in m");
    const Polygon polygon = read_polygon(in, outline, object.optional("holes"));
    object.finish();
    Region region{name, {}, area_moments(polygon).area};
    for (const std::vector<int>& part : convex_parts(polygon)) {
      std::vector<Vec2>& ring = region.parts.emplace_back();
      for (const int vertex : part) ring.push_back(polygon[vertex] - model.origin);
    }
    model.regions.push_back(std::move(region));
  }
}

std::vector<StopRule> read_stops(const JsonReader& in, const JsonValue& value, const Model& model,
                                 UsedFeatures& features) {
  features.add(Feature::stop_rule, &value);
  std::vector<StopRule> rules;
  for (const JsonValue& item : in.array(value)) {
    rules.push_back(read_stop(in, item, model));
    for (size_t i = 0; i + 1 < rules.size(); ++i) {
      if (rules[i].name == rules.back().name) {
        in.fail(*item.find("name"), "is the name of another rule");
      }
    }
  }
  return rules;
}

}  // namespace apothem
