#include <fmt/format.h>

#include <array>
#include <nlohmann/json.hpp>

#include "apps/commands.hpp"
#include "apps/polygon/batch.hpp"
#include "apps/polygon/input.hpp"
#include "geometry/exact/pair_methods.hpp"
#include "geometry/regions/boolean.hpp"
#include "lib/contact/law/law.hpp"
#include "lib/output/files.hpp"
#include "lib/scene/json.hpp"
#include "lib/scene/pair_file.hpp"
#include "lib/scene/polygon_file.hpp"
#include "lib/scene/ring_line.hpp"
#include "lib/system/clock.hpp"

namespace apothem {
namespace {

using Json = nlohmann::ordered_json;

PotentialChoice potential_choice(const ContactOptions& options) {
  PotentialChoice choice;
  for (const NamedPotential& p : kPotentials) {
    if (options.potential == p.name) choice.kind = p.kind;
  }
  if (options.reference && choice.kind == PotentialChoice::Kind::area) {
    throw UsageError("--reference", "the area potential has no reference length; leave it out");
  }
  if (options.field && choice.kind == PotentialChoice::Kind::area) {
    throw UsageError("--field", "the area potential has one field only; leave it out");
  }
  for (const NamedField& f : kFields) {
    if (options.field == f.name) choice.field = f.field;
  }
  if (options.reference) set_reference(choice, *options.reference);
  return choice;
}

Json results(const Polygon& a, const Polygon& b, const ContactOptions& options) {
  const PotentialChoice choice = potential_choice(options);
  const double k = options.stiffness;
  const std::vector<std::string> methods =
      options.method == "all" ? std::vector<std::string>(kPairMethods.begin(), kPairMethods.end())
                              : std::vector{options.method};
  const PosedPair posed(a, b);
  const double deepest = posed.penetration();
  Json list = Json::array();
  for (const std::string& method : methods) {
    const Clock::time_point start = Clock::now();
    const PairContact pair = posed.contact(method, choice);
    const double seconds = seconds_since(start);
    const Vec2& point = pair.loading_point;
    list.push_back({{"method", method},
                    {"force", {k * pair.force.x(), k * pair.force.y()}},
                    {"moment_a", k * pair.moment_a},
                    {"moment_b", k * pair.moment_b},
                    {"loading_point", {point.x(), point.y()}},
                    {"energy", k * pair.energy},
                    {"overlap_area", pair.overlap_area},
                    {"own_length_a", pair.own_length_a},
                    {"own_length_b", pair.own_length_b},
                    {"weight", k * pair.weight},
                    {"penetration", deepest},
                    {"largest_phi", pair.largest_phi},
                    {"seconds", seconds}});
  }
  return list;
}

// For each number of the results.
constexpr std::array kUnits{std::pair("force", " N/m, on A"),
                            std::pair("moment_a", " N, about the centroid of A"),
                            std::pair("moment_b", " N, about the centroid of B"),
                            std::pair("loading_point", " m"),
                            std::pair("energy", " J/m"),
                            std::pair("overlap_area", " m^2"),
                            std::pair("own_length_a", " m, of the boundary of A inside B"),
                            std::pair("own_length_b", " m, of the boundary of B inside A"),
                            std::pair("weight", " N/m, all tractions without their directions"),
                            std::pair("penetration", " m"),
                            std::pair("largest_phi", ""),
                            std::pair("seconds", " s")};

void print_table(const Json& list) {
  for (const Json& r : list) {
    fmt::print("{}\n", r["method"].get<std::string>());
    for (const auto& [key, unit] : kUnits) {
      const Json& value = r.at(key);
      const std::string text = value.is_array()
                                   ? fmt::format("({}, {})", value[0].dump(), value[1].dump())
                                   : value.dump();
      fmt::print("  {:<15} {}{}\n", key, text, unit);
    }
  }
}

int batch(const ContactOptions& options) {
  potential_choice(options);  // a wrong option is reported once, not for each line
  return print_answers(options.batch, kPairForm, [&](const BatchLine& line) -> BatchAnswer {
    const Json name = line.has_polygon ? Json(line.name) : Json();
    Json object{{"name", name}};
    BatchAnswer answer;
    const auto refuse = [&](const InvalidPolygon& error, const std::string& which) {
      object = {{"name", name}, {"error", error.what()}, {"polygon", which}};
      if (error.hole()) object["hole"] = *error.hole();
      object.update({{"vertex", error.vertex()}, {"line", line.number}});
      answer.refused = true;
    };
    const char* which = "a";
    try {
      const PolygonPair pair = parse_pair(line.text);
      const Polygon a(pair.a.outer, pair.a.holes);
      which = "b";
      const Polygon b(pair.b.outer, pair.b.holes);
      which = "";
      object["normal_stiffness"] = options.stiffness;
      object["results"] = results(a, b, options);
    } catch (const BadPairLine& error) {
      refuse(error, error.polygon());
    } catch (const InvalidPolygon& error) {
      refuse(error, which);
    }
    answer.text = object.dump(-1, ' ', false, Json::error_handler_t::replace);
    return answer;
  });
}

}  // namespace

int contact_command(const ContactOptions& options) {
  if (!options.batch.empty()) return batch(options);
  if (options.b.empty()) throw UsageError("contact", "give two polygon files, or --batch FILE");
  std::optional<ShapeFormat> format;
  if (!options.output.empty()) format = shape_format_of(options.output);
  const Polygon a = polygon_of_file(options.a);
  const Polygon b = polygon_of_file(options.b);
  Json list;
  try {
    list = results(a, b, options);
  } catch (const InvalidPolygon& error) {
    throw SceneError(options.a + ", " + options.b, 0, "", error.what());
  }
  if (format) {
    const auto overlap = boolean_operation(a, b, BooleanOperation::intersection);
    write_file(options.output, shape_text(shapes_of(overlap), *format));
  }
  if (options.json) {
    fmt::print("{}\n", Json{{"normal_stiffness", options.stiffness}, {"results", list}}.dump(2));
  } else {
    print_table(list);
  }
  return exit_code::done;
}

}  // namespace apothem
