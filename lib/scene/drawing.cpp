#include "lib/scene/drawing.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstring>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string_view>

#include "lib/scene/dxf_text.hpp"
#include "lib/scene/gdal.hpp"
#include "lib/scene/json.hpp"
#include "lib/text/decimal.hpp"
#include "lib/text/file.hpp"
#include "lib/text/words.hpp"

namespace apothem {
namespace {

// Appends the parts of a geometry without curves. `like` has their layer, name and place.
void add_parts(OGRGeometryH geometry, const DrawnShape& like, std::vector<DrawnShape>& shapes) {
  const auto add = [&](DrawnShape::Kind kind) -> DrawnShape& {
    shapes.push_back(like);
    shapes.back().kind = kind;
    if (like.entity.empty()) {
      shapes.back().entity = kind == DrawnShape::Kind::label  ? "point"
                             : kind == DrawnShape::Kind::line ? "line"
                                                              : "polygon";
    }
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
  const size_t first = shapes.size();
  add_parts(straight.get(), like, shapes);
  if (like.entity.empty()) return;  // each of them is counted
  for (size_t i = first + 1; i < shapes.size(); ++i) shapes[i].further = true;
}

Box extent_of(const std::vector<DrawnShape>& shapes) {
  Box box;
  for (const DrawnShape& shape : shapes) {
    for (const std::vector<Vec2>& ring : shape.rings) box.include(box_of(ring));
  }
  return box;
}

DrawnShape shape_at(std::string place) {
  DrawnShape shape{};
  shape.place = std::move(place);
  return shape;
}

// Geometries of WKT, one after the other, usually one in each line.
class WktDrawing {
 public:
  explicit WktDrawing(const std::string& file) : file_(file), text_(read_text(file)) {}

  Drawing read() {
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
      add_geometry(geometry, shape_at(fmt::format("line {}", line)), drawing_.shapes);
    }
    if (!system_.empty()) {
      drawing_.unit = unit_of_system(system_, file_, extent_of(drawing_.shapes));
    }
    return std::move(drawing_);
  }

 private:
  // White space, comments, and a coordinate system in front ("SRID=4326;").
  char* skip(char* at) {
    for (;;) {
      at += std::strspn(at, " \t\r\n;");
      if (*at == '#') {
        at += std::strcspn(at, "\n");
      } else if (std::strncmp(at, "SRID=", 5) == 0) {
        const size_t size = std::strcspn(at, "\n;");
        coordinate_system("EPSG:" + std::string(at + 5, size - 5));
        at += size;
      } else {
        return at;
      }
    }
  }

  // 0 says that none is known.
  void coordinate_system(const std::string& system) {
    if (system == "EPSG:0") return;
    if (!system_.empty() && system != system_) {
      throw SceneError(file_,
                       fmt::format("holds two coordinate systems, {} and {} (SRID), which is not "
                                   "supported yet; write all geometries in one of them",
                                   system_, system));
    }
    system_ = system;
  }

  const std::string& file_;
  std::string text_;
  std::string system_;
  Drawing drawing_;
};

// The attributes of a feature, whose names may be in upper or lower case.
class Attributes {
 public:
  explicit Attributes(OGRFeatureH feature) : feature_(feature) {}

  [[nodiscard]] std::optional<std::string> find(std::string_view name) const {
    for (int i = 0; i < gdal().OGR_F_GetFieldCount(feature_); ++i) {
      const char* own = gdal().OGR_Fld_GetNameRef(gdal().OGR_F_GetFieldDefnRef(feature_, i));
      if (lower_case(own) == name) return gdal().OGR_F_GetFieldAsString(feature_, i);
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

// A text that GDAL reads like a file.
class FileInMemory {
 public:
  explicit FileInMemory(std::string& text) {
    static std::atomic<int> count{0};
    name_ = fmt::format("/vsimem/apothem-{}", ++count);
    auto* bytes = reinterpret_cast<GByte*>(text.data());
    gdal().VSIFCloseL(gdal().VSIFileFromMemBuffer(name_.c_str(), bytes, text.size(), FALSE));
  }
  ~FileInMemory() { gdal().VSIUnlink(name_.c_str()); }
  FileInMemory(const FileInMemory&) = delete;
  FileInMemory& operator=(const FileInMemory&) = delete;
  [[nodiscard]] const std::string& name() const { return name_; }

 private:
  std::string name_;
};

// The formats that GDAL reads as lists of features.
class FeatureDrawing {
 public:
  FeatureDrawing(const std::string& file, const char* driver) : file_(file), driver_(driver) {
    open_text(file);  // says what is wrong where the file cannot be opened
    if (is("DXF")) {
      dxf_ = read_dxf(file);
      in_memory_.emplace(dxf_.text);
    }
    const std::array<const char*, 2> drivers{driver, nullptr};
    const std::array<const char*, 3> options{"HEADERS=YES", "GEOM_POSSIBLE_NAMES=WKT", nullptr};
    set_.reset(gdal().GDALOpenEx((in_memory_ ? in_memory_->name() : file).c_str(), GDAL_OF_VECTOR,
                                 drivers.data(), is("CSV") ? options.data() : nullptr, nullptr));
    refuse_entity();
    if (!set_ && is("CSV")) fail("is not valid CSV; give it a header and two columns or more");
    if (!set_) fail(fmt::format("is not valid {}{}", driver, reason()));
  }

  Drawing read() {
    for (int i = 0; i < gdal().GDALDatasetGetLayerCount(set_.get()); ++i) {
      OGRLayerH layer = gdal().GDALDatasetGetLayer(set_.get(), i);
      const auto next = [&] { return gdal().OGR_L_GetNextFeature(layer); };
      for (OGRFeatureH feature = next(); feature != nullptr; feature = next()) {
        const std::unique_ptr<void, decltype(gdal().OGR_F_Destroy)> owner(feature,
                                                                          gdal().OGR_F_Destroy);
        refuse_entity();
        ++number_;
        add_feature(feature);
      }
      refuse_entity();
      if (gdal().CPLGetLastErrorType() >= CE_Failure) {
        fail(fmt::format("is not valid {} behind {} {}{}", driver_, noun(), number_, reason()));
      }
    }
    finish();
    return std::move(drawing_);
  }

 private:
  struct Close {
    void operator()(void* set) const { gdal().GDALClose(set); }
  };

  [[nodiscard]] bool is(std::string_view driver) const { return driver_ == driver; }
  [[nodiscard]] const char* noun() const { return is("CSV") ? "row" : "feature"; }
  [[nodiscard]] static std::string reason() {
    const std::string text = gdal().CPLGetLastErrorMsg();
    return text.empty() ? "" : " (" + text + ")";
  }
  [[noreturn]] void fail(const std::string& what) const { throw SceneError(file_, what); }
  [[noreturn]] void fail_here(const std::string& what) const {
    fail(fmt::format("{} {}: {}", noun(), number_, what));
  }

  // GDAL says where it stopped by a place in its source and the line of the text.
  void refuse_entity() const {
    if (!is("DXF") || gdal().CPLGetLastErrorType() < CE_Failure) return;
    const std::string text = gdal().CPLGetLastErrorMsg();
    constexpr std::string_view kLine = "error at line ";
    const size_t found = text.find(kLine);
    if (found != std::string::npos) {
      const int line = std::atoi(text.c_str() + found + kLine.size());
      const size_t pair = static_cast<size_t>(std::max(line - 1, 0)) / 2;
      const int owner = pair < dxf_.owners.size() ? dxf_.owners[pair] : -1;
      if (owner >= 0) {
        const DxfEntity& entity = dxf_.entities[static_cast<size_t>(owner)];
        fail(fmt::format("{} on layer \"{}\": cannot be read; draw it anew, or take it out",
                         entity.place, entity.layer));
      }
    }
    fail("is not valid DXF; save it anew as DXF (ASCII)");
  }

  void add_feature(OGRFeatureH feature) {
    const Attributes attributes(feature);
    OGRGeometryH geometry = gdal().OGR_F_GetGeometryRef(feature);
    if (geometry != nullptr) {
      DrawnShape like = shape_at(fmt::format("{} {}", noun(), number_));
      like.layer = attributes.first({"layer"});
      // Other shapes of a DXF file have their pattern there.
      const bool is_label =
          gdal().OGR_GT_Flatten(gdal().OGR_G_GetGeometryType(geometry)) == wkbPoint;
      like.name = attributes.first({"name", "id", is_label ? "text" : "name"});
      if (is("DXF")) {
        add_entity(feature, attributes, geometry, std::move(like));
      } else {
        add_geometry(geometry, like, drawing_.shapes);
      }
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

  void add_entity(OGRFeatureH feature, const Attributes& attributes, OGRGeometryH geometry,
                  DrawnShape like) {
    const auto index = static_cast<size_t>(parse_count(attributes.first({"linetype"})));
    const DxfEntity& entity = dxf_.entities.at(index);
    like.entity = entity.type;
    like.place = entity.place;
    like.remark = entity.remark;
    like.hidden = is_transparent(gdal().OGR_F_GetStyleString(feature));
    if (entity.use == DxfEntity::Use::read) {
      add_geometry(geometry, like, drawing_.shapes);
      return;
    }
    like.kind = kind_of(entity.use);
    drawing_.shapes.push_back(std::move(like));
  }

  static DrawnShape::Kind kind_of(DxfEntity::Use use) {
    return use == DxfEntity::Use::left_out    ? DrawnShape::Kind::left_out
           : use == DxfEntity::Use::unbounded ? DrawnShape::Kind::unbounded
                                              : DrawnShape::Kind::unsupported;
  }

  // GDAL gives what a drawing does not show a colour without opacity, "#RRGGBB00".
  static bool is_transparent(const char* style) {
    const std::string_view text = style != nullptr ? style : "";
    const size_t colour = text.find('#');
    return colour != std::string_view::npos && text.size() >= colour + 9 &&
           text.substr(colour + 7, 2) == "00";
  }

  void finish() {
    if (is("DXF")) {
      drawing_.layers = std::move(dxf_.layers);
      drawing_.unit = unit_of_dxf(dxf_.unit);
      for (const DxfEntity& entity : dxf_.paper_space) {
        DrawnShape shape = shape_at(entity.place);
        shape.kind = DrawnShape::Kind::left_out;
        shape.layer = entity.layer;
        shape.entity = entity.type;
        shape.remark = entity.remark;
        drawing_.shapes.push_back(std::move(shape));
      }
    } else if (is("GeoJSON")) {
      drawing_.unit =
          unit_of_geojson(crs_of_geojson(read_text(file_)), file_, extent_of(drawing_.shapes));
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
    const auto [found, is_new] = by_id_.try_emplace(id, drawing_.shapes.size());
    if (is_new) {
      DrawnShape shape = shape_at(fmt::format("the outline \"{}\" from row {}", id, number_));
      shape.kind = DrawnShape::Kind::area;
      shape.rings.emplace_back();
      shape.layer = attributes.first({"layer"});
      shape.name = attributes.first({"name", "id"});
      shape.entity = "polygon";
      drawing_.shapes.push_back(std::move(shape));
    }
    drawing_.shapes[found->second].rings[0].push_back(vertex);
  }

  const std::string& file_;
  const char* driver_;
  DxfText dxf_;
  std::optional<FileInMemory> in_memory_;  // lives longer than what reads it
  std::unique_ptr<void, Close> set_;
  int number_ = 0;
  Drawing drawing_;
  std::map<std::string, size_t> by_id_;  // shapes of a list of vertices
};

}  // namespace

Drawing read_drawing(const std::string& file) {
  struct Format {
    const char *ending, *driver;  // without a driver: WKT
  };
  constexpr std::array<Format, 6> kFormats{{{".dxf", "DXF"},
                                            {".geojson", "GeoJSON"},
                                            {".json", "GeoJSON"},
                                            {".csv", "CSV"},
                                            {".wkt", nullptr},
                                            {".txt", nullptr}}};
  const std::string ending = lower_case(std::filesystem::path(file).extension().string());
  const auto format =
      std::ranges::find_if(kFormats, [&](const Format& f) { return ending == f.ending; });
  if (format == kFormats.end()) {
    throw SceneError(file, "is of no known format; drawings are .dxf, .wkt, .geojson or .csv");
  }
  try {
    const QuietGdal quiet;
    if (format->driver == nullptr) return WktDrawing(file).read();
    return FeatureDrawing(file, format->driver).read();
  } catch (const SceneError&) {
    throw;
  } catch (const std::runtime_error& error) {
    throw SceneError(file, error.what());
  }
}

}  // namespace apothem
