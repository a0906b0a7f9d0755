#include "lib/scene/drawing_unit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "lib/scene/gdal.hpp"

namespace apothem {
namespace {

// A drawing whose distance from 0, 0 is more than this many times its extent is taken for a map.
constexpr double kFarAway = 3;
constexpr double kLargestLongitude = 180, kLargestLatitude = 90;  // degrees

struct Unit {
  const char* name;
  double metres;
};
constexpr double kSurveyFoot = 1200.0 / 3937;
// By their numbers in $INSUNITS.
constexpr std::array<Unit, 25> kUnits{{{"", 1},
                                       {"inches", 0.0254},
                                       {"feet", 0.3048},
                                       {"miles", 1609.344},
                                       {"millimetres", 1e-3},
                                       {"centimetres", 1e-2},
                                       {"metres", 1},
                                       {"kilometres", 1e3},
                                       {"microinches", 25.4e-9},
                                       {"mils", 25.4e-6},
                                       {"yards", 0.9144},
                                       {"angstroms", 1e-10},
                                       {"nanometres", 1e-9},
                                       {"micrometres", 1e-6},
                                       {"decimetres", 1e-1},
                                       {"decametres", 1e1},
                                       {"hectometres", 1e2},
                                       {"gigametres", 1e9},
                                       {"astronomical units", 149597870700.0},
                                       {"light years", 9460730472580800.0},
                                       {"parsecs", 30856775814913673.0},
                                       {"US survey feet", kSurveyFoot},
                                       {"US survey inches", kSurveyFoot / 12},
                                       {"US survey yards", 3 * kSurveyFoot},
                                       {"US survey miles", 5280 * kSurveyFoot}}};

class SpatialReference {
 public:
  explicit SpatialReference(const std::string& system)
      : handle_(gdal().OSRNewSpatialReference(nullptr)),
        good_(gdal().OSRSetFromUserInput(handle_, system.c_str()) == OGRERR_NONE) {}
  ~SpatialReference() { gdal().OSRDestroySpatialReference(handle_); }
  SpatialReference(const SpatialReference&) = delete;
  SpatialReference& operator=(const SpatialReference&) = delete;

  [[nodiscard]] bool good() const { return good_; }
  [[nodiscard]] bool in_degrees() const { return gdal().OSRIsGeographic(handle_) != 0; }
  [[nodiscard]] double metres() const { return gdal().OSRGetLinearUnits(handle_, nullptr); }

 private:
  OGRSpatialReferenceH handle_;
  bool good_;
};

bool can_be_degrees(const Box& box) {
  return box.x0 >= -kLargestLongitude && box.x1 <= kLargestLongitude &&
         box.y0 >= -kLargestLatitude && box.y1 <= kLargestLatitude;
}

// Its grid of the Universal Transverse Mercator projection is in metres, with an error of 1e-3.
int utm_zone(const Box& box) {
  const double longitude = (box.x0 + box.x1) / 2, latitude = (box.y0 + box.y1) / 2;
  const int zone = std::clamp(static_cast<int>(std::floor((longitude + 180) / 6)) + 1, 1, 60);
  return (latitude < 0 ? 32700 : 32600) + zone;
}

DrawingUnit degrees(const std::string& source, const std::string& file, const Box& box) {
  const std::filesystem::path path(file);
  const std::string name = path.filename().string(), stem = path.stem().string();
  return {1, "",
          fmt::format("is in degrees of longitude and latitude ({}); project it to metres (ogr2ogr "
                      "-t_srs EPSG:{} {}-metres.geojson {}), or import it with \"scale\": 1 if its "
                      "numbers are metres",
                      source, utm_zone(box), stem, name)};
}

}  // namespace

DrawingUnit unit_of_dxf(int code) {
  if (code == 0) return {};
  if (code < 0 || code >= static_cast<int>(kUnits.size())) {
    return {1, "",
            fmt::format("states a unit that is not known ($INSUNITS {}); write \"scale\": the "
                        "length of its unit in m",
                        code)};
  }
  const Unit& unit = kUnits[static_cast<size_t>(code)];
  return {unit.metres, fmt::format("{}, by $INSUNITS {}", unit.name, code), ""};
}

DrawingUnit unit_of_system(const std::string& system, const std::string& file, const Box& box) {
  const SpatialReference reference(system);
  if (!reference.good()) {
    return {
        1, "",
        fmt::format("names a coordinate system that is not known (\"{}\"); write \"scale\": the "
                    "length of its unit in m, 1 if its numbers are metres",
                    system)};
  }
  if (reference.in_degrees()) return degrees(system, file, box);
  return {reference.metres(), "of the coordinate system " + system, ""};
}

DrawingUnit unit_of_geojson(const std::string& crs, const std::string& file, const Box& box) {
  if (!crs.empty()) return unit_of_system(crs, file, box);
  if (!can_be_degrees(box)) return {};
  const double away =
      std::hypot(std::max({box.x0, -box.x1, 0.0}), std::max({box.y0, -box.y1, 0.0}));
  if (away <= kFarAway * std::hypot(box.x1 - box.x0, box.y1 - box.y0)) return {};
  return degrees("as GeoJSON without a \"crs\" is, by RFC 7946", file, box);
}

DrawingUnit unit_of_polygon(const std::string& text, const std::string& file, const Box& box) {
  if (text.find("\"coordinates\"") != std::string::npos) {
    return unit_of_geojson(crs_of_geojson(text), file, box);
  }
  constexpr std::string_view kSystem = "SRID=";
  const size_t start = text.find_first_not_of(" \t\r\n");
  if (start == std::string::npos || !std::string_view(text).substr(start).starts_with(kSystem))
    return {};
  const size_t number = start + kSystem.size();
  const std::string system = text.substr(number, text.find_first_of("; \r\n", number) - number);
  return system == "0" ? DrawingUnit() : unit_of_system("EPSG:" + system, file, box);
}

std::string crs_of_geojson(const std::string& text) {
  using nlohmann::json;
  // Of the whole file, only this one member is kept.
  bool inside = false;
  const auto keep = [&](int depth, json::parse_event_t event, json& value) {
    if (event == json::parse_event_t::key && depth == 1) inside = value == "crs";
    return depth == 0 || inside;
  };
  const json file = json::parse(text, keep, false);
  if (!file.is_object()) return "";
  const auto crs = file.find("crs");
  if (crs == file.end() || !crs->is_object()) return "";
  const json name = crs->value(json::json_pointer("/properties/name"), json());
  if (name.is_string()) return name.get<std::string>();
  return crs->dump(-1, ' ', false, json::error_handler_t::replace);
}

}  // namespace apothem
