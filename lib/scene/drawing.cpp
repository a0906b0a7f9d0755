#include "apothem/scene/drawing.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstring>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string_view>

#include "apothem/scene/decimal.hpp"
#include "apothem/scene/gdal.hpp"
#include "apothem/scene/json.hpp"

namespace apothem {
namespace {

using Points = std::vector<Vec2>;

std::string in_lower_case(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

Points points_of(OGRGeometryH curve) {
  Points points;
  for (int i = 0; i < gdal().OGR_G_GetPointCount(curve); ++i) {
    points.emplace_back(gdal().OGR_G_GetX(curve, i), gdal().OGR_G_GetY(curve, i));
  }
  return points;
}

// Appends the parts of a geometry without curves. `like` has their layer, name and place.
void add_parts(OGRGeometryH geometry, const DrawnShape& like, std::vector<DrawnShape>& shapes) {
  const auto add = [&](DrawnShape::Kind kind) -> DrawnShape& {
    shapes.push_back(like);
    shapes.back().kind = kind;
    return shapes.back();
  };
  const int parts = gdal().OGR_G_GetGeometryCount(geometry);
  switch (gdal().OGR_GT_Flatten(gdal().OGR_G_GetGeometryType(geometry))) {
    case wkbPoint:
      add(DrawnShape::Kind::label).rings.push_back(points_of(geometry));
      return;
    case wkbLineString:
      add(DrawnShape::Kind::line).rings.push_back(points_of(geometry));
      return;
    case wkbPolygon:
    case wkbTriangle: {
      DrawnShape& area = add(DrawnShape::Kind::area);
      for (int i = 0; i < parts; ++i) {
        area.rings.push_back(points_of(gdal().OGR_G_GetGeometryRef(geometry, i)));
      }
      if (parts == 0) area.rings.emplace_back();
      return;
    }
    default:
      for (int i = 0; i < parts; ++i) {
        add_parts(gdal().OGR_G_GetGeometryRef(geometry, i), like, shapes);
      }
  }
}

void add_geometry(OGRGeometryH geometry, const DrawnShape& like, std::vector<DrawnShape>& shapes) {
  const Geometry straight(gdal().OGR_G_GetLinearGeometry(geometry, 0, nullptr));
  add_parts(straight.get(), like, shapes);
}

// Geometries of WKT, one after the other, usually one in each line.
class WktDrawing {
 public:
  explicit WktDrawing(const std::string& file) : file_(file), text_(read_text(file)) {}

  std::vector<DrawnShape> read() {
    char* at = text_.data();
    const char* counted = at;
    int line = 1;
    while (at = skip(at), *at != '\0') {
      line += static_cast<int>(std::count(counted, static_cast<const char*>(at), '\n'));
      counted = at;
      OGRGeometryH geometry = nullptr;
      const bool good = gdal().OGR_G_CreateFromWkt(&at, nullptr, &geometry) == OGRERR_NONE;
      const Geometry owner(geometry);
      if (!good) {
        throw SceneError(file_, line, "",
                         "is not valid WKT; write POLYGON ((x y, x y, ...)) with points in "
                         "decimals, one in each line");
      }
      add_geometry(geometry, {{}, {}, "", "", fmt::format("line {}", line)}, shapes_);
    }
    return std::move(shapes_);
  }

 private:
  // White space, comments, and a coordinate system in front ("SRID=4326;").
  static char* skip(char* at) {
    for (;;) {
      at += std::strspn(at, " \t\r\n;");
      if (*at == '#') {
        at += std::strcspn(at, "\n");
      } else if (std::strncmp(at, "SRID=", 5) == 0) {
        at += std::strcspn(at, "\n;");
      } else {
        return at;
      }
    }
  }

  const std::string& file_;
  std::string text_;
  std::vector<DrawnShape> shapes_;
};

// The attributes of a feature, whose names may be in upper or lower case.
class Attributes {
 public:
  explicit Attributes(OGRFeatureH feature) : feature_(feature) {}

  [[nodiscard]] std::optional<std::string> find(std::string_view name) const {
    for (int i = 0; i < gdal().OGR_F_GetFieldCount(feature_); ++i) {
      const char* own = gdal().OGR_Fld_GetNameRef(gdal().OGR_F_GetFieldDefnRef(feature_, i));
      if (in_lower_case(own) == name) return gdal().OGR_F_GetFieldAsString(feature_, i);
    }
    return {};
  }
  /// The first of them that is not empty, or nothing.
  [[nodiscard]] std::string first(std::initializer_list<const char*> names) const {
    for (const char* name : names) {
      if (const auto value = find(name); value && !value->empty()) return *value;
    }
    return {};
  }

 private:
  OGRFeatureH feature_;
};

// The formats that GDAL reads as lists of features.
class FeatureDrawing {
 public:
  FeatureDrawing(const std::string& file, const char* driver) : file_(file), driver_(driver) {
    open_text(file);  // says what is wrong where the file cannot be opened
    const std::array<const char*, 2> drivers{driver, nullptr};
    const std::array<const char*, 3> options{"HEADERS=YES", "GEOM_POSSIBLE_NAMES=WKT", nullptr};
    set_.reset(gdal().GDALOpenEx(file.c_str(), GDAL_OF_VECTOR, drivers.data(),
                                 is("CSV") ? options.data() : nullptr, nullptr));
    if (!set_ && is("CSV")) fail("is not valid CSV; give it a header and two columns or more");
    if (!set_) fail(fmt::format("is not valid {}{}", driver, reason()));
  }

  std::vector<DrawnShape> read() {
    for (int i = 0; i < gdal().GDALDatasetGetLayerCount(set_.get()); ++i) {
      OGRLayerH layer = gdal().GDALDatasetGetLayer(set_.get(), i);
      const auto next = [&] { return gdal().OGR_L_GetNextFeature(layer); };
      for (OGRFeatureH feature = next(); feature != nullptr; feature = next()) {
        const std::unique_ptr<void, decltype(gdal().OGR_F_Destroy)> owner(feature,
                                                                          gdal().OGR_F_Destroy);
        ++number_;
        add_feature(feature);
      }
      if (gdal().CPLGetLastErrorType() >= CE_Failure) {
        fail(fmt::format("is not valid {} behind {} {}{}", driver_, noun(), number_, reason()));
      }
    }
    return std::move(shapes_);
  }

 private:
  struct Close {
    void operator()(void* set) const { gdal().GDALClose(set); }
  };

  [[nodiscard]] bool is(std::string_view driver) const { return driver_ == driver; }
  [[nodiscard]] const char* noun() const {
    return is("DXF") ? "entity" : is("CSV") ? "row" : "feature";
  }
  [[nodiscard]] static std::string reason() {
    const std::string text = gdal().CPLGetLastErrorMsg();
    return text.empty() ? "" : " (" + text + ")";
  }
  [[noreturn]] void fail(const std::string& what) const { throw SceneError(file_, 0, "", what); }
  [[noreturn]] void fail_here(const std::string& what) const {
    fail(fmt::format("{} {}: {}", noun(), number_, what));
  }

  void add_feature(OGRFeatureH feature) {
    const Attributes attributes(feature);
    // The paper space of a DXF file is the sheet to be printed, with its frame and its title.
    if (attributes.find("paperspace") == "1") return;
    OGRGeometryH geometry = gdal().OGR_F_GetGeometryRef(feature);
    if (geometry != nullptr) {
      DrawnShape like;
      like.layer = attributes.first({"layer"});
      // Other shapes of a DXF file have their pattern there.
      const bool is_label =
          gdal().OGR_GT_Flatten(gdal().OGR_G_GetGeometryType(geometry)) == wkbPoint;
      like.name = attributes.first({"name", "id", is_label ? "text" : "name"});
      const std::string handle = attributes.first({"entityhandle"});
      like.place = fmt::format("{} {}{}", noun(), number_,
                               handle.empty() ? "" : fmt::format(" (handle {})", handle));
      add_geometry(geometry, like, shapes_);
    } else if (is("CSV") && attributes.find("x") && attributes.find("y")) {
      add_vertex(attributes);
    } else if (is("CSV")) {
      fail_here(
          "has no shape, or no valid one; give the file a column WKT with POLYGON ((x y, x y, "
          "...)), or "
          "columns x and y with a vertex in each row and a column id");
    } else if (!is("DXF")) {
      fail_here("has no shape, or no valid one; give it a geometry, or take it out");
    }
  }

  void add_vertex(const Attributes& attributes) {
    Vec2 vertex;
    for (int k = 0; k < 2; ++k) {
      try {
        vertex[k] = parse_decimal(*attributes.find(k == 0 ? "x" : "y"));
      } catch (const BadNumber& error) {
        fail_here(fmt::format("{}: {}", k == 0 ? "x" : "y", error.what()));
      }
    }
    const std::string id = attributes.first({"id"});
    const auto [found, is_new] = by_id_.try_emplace(id, shapes_.size());
    if (is_new) {
      shapes_.push_back({DrawnShape::Kind::area,
                         {{}},
                         attributes.first({"layer"}),
                         attributes.first({"name", "id"}),
                         fmt::format("the outline \"{}\" from row {}", id, number_)});
    }
    shapes_[found->second].rings[0].push_back(vertex);
  }

  const std::string& file_;
  const char* driver_;
  std::unique_ptr<void, Close> set_;
  int number_ = 0;
  std::vector<DrawnShape> shapes_;
  std::map<std::string, size_t> by_id_;  // shapes of a list of vertices
};

}  // namespace

std::vector<DrawnShape> read_drawing(const std::string& file) {
  struct Format {
    const char *ending, *driver;  // without a driver: WKT
  };
  constexpr std::array<Format, 6> kFormats{{{".dxf", "DXF"},
                                            {".geojson", "GeoJSON"},
                                            {".json", "GeoJSON"},
                                            {".csv", "CSV"},
                                            {".wkt", nullptr},
                                            {".txt", nullptr}}};
  const std::string ending = in_lower_case(std::filesystem::path(file).extension().string());
  const auto format = std::find_if(kFormats.begin(), kFormats.end(),
                                   [&](const Format& f) { return ending == f.ending; });
  if (format == kFormats.end()) {
    throw SceneError(file, 0, "",
                     "is of no known format; drawings are .dxf, .wkt, .geojson or .csv");
  }
  try {
    const QuietGdal quiet;
    if (format->driver == nullptr) return WktDrawing(file).read();
    return FeatureDrawing(file, format->driver).read();
  } catch (const SceneError&) {
    throw;
  } catch (const std::runtime_error& error) {
    throw SceneError(file, 0, "", error.what());
  }
}

}  // namespace apothem
