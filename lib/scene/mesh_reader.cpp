#include "lib/scene/mesh_reader.hpp"

#include <fmt/format.h>

#include "geometry/meshing/voronoi.hpp"
#include "lib/mesh/check.hpp"
#include "lib/mesh/disc_mesh.hpp"
#include "lib/mesh/fill_mesh.hpp"
#include "lib/mesh/half_disc_mesh.hpp"
#include "lib/mesh/mirror.hpp"
#include "lib/mesh/rectangle_mesh.hpp"
#include "lib/scene/mesh_file.hpp"
#include "lib/scene/polygon_value.hpp"
#include "lib/text/words.hpp"

namespace apothem {
namespace {

class MeshReader {
 public:
  MeshReader(const JsonReader& in, const JsonValue& value) : in_(in), value_(value) {}

  MeshSpec read() {
    JsonObject object(in_, value_);
    const JsonValue* source = nullptr;
    const Way* way = nullptr;
    for (const Way& w : kWays) {
      const JsonValue* found = object.optional(w.key);
      if (found == nullptr) continue;
      if (source != nullptr) {
        in_.fail(
            *found,
            fmt::format("a mesh is made in one way, and \"{}\" is given; leave one out", way->key));
      }
      source = found;
      way = &w;
    }
    element_value_ = object.optional("element");
    const JsonValue* mirror_value = object.optional("mirror");
    object.finish();
    if (source == nullptr) {
      in_.fail(value_, "must give one of rectangle, disc, half_disc, fill, voronoi, file");
    }
    if (element_value_) element_ = &kElements[in_.choice(*element_value_, names_of(kElements))];
    MeshSpec spec{made(*source, *way), {}};
    if (mirror_value != nullptr) mirror_at(*mirror_value, spec.mesh);
    spec.element = element_ != nullptr ? element_->kind : fitting(spec.mesh);
    if (element_ != nullptr) require_fit(spec.mesh);
    return spec;
  }

 private:
  // A key of the scene, and the function that makes a mesh from its value.
  struct Way {
    const char* key;
    Mesh (MeshReader::*make)(const JsonValue&) const;
  };
  static const std::array<Way, 6> kWays;

  void mirror_at(const JsonValue& value, Mesh& mesh) const {
    JsonObject object(in_, value);
    const JsonValue* x = object.optional("x");
    const JsonValue* y = object.optional("y");
    object.finish();
    if ((x == nullptr) == (y == nullptr)) {
      in_.fail(value, "must give the line: one of \"x\" and \"y\"");
    }
    mirror(mesh, x != nullptr ? 0 : 1, in_.number(x != nullptr ? *x : *y, "m"));
    check(mesh, value);
  }

  // The generators know nothing of the scene. Their errors are reported at the value from which the
  // mesh is made.
  Mesh made(const JsonValue& source, const Way& way) const {
    try {
      Mesh mesh = (this->*way.make)(source);
      check(mesh, source);
      return mesh;
    } catch (const std::invalid_argument& error) {
      in_.fail(source, error.what());
    }
  }

  void check(const Mesh& mesh, const JsonValue& source) const {
    try {
      check_mesh(mesh, rules());
    } catch (const std::invalid_argument& error) {
      in_.fail(source, error.what());
    }
  }

  [[nodiscard]] MeshRules rules() const {
    return {.convex_quadrilaterals = element_ == nullptr || element_->corners != 0};
  }

  [[nodiscard]] ElementShape shape() const {
    return element_ != nullptr && element_->corners == 3 ? ElementShape::triangle
                                                         : ElementShape::quadrilateral;
  }

  Mesh rectangle(const JsonValue& value) const {
    JsonObject object(in_, value);
    const Vec2 size = in_.vec2(object.required("size", "[x, y] in m"), "m");
    const JsonValue& cells = object.required("cells", "[along x, along y]");
    if (in_.array(cells).size() != 2) in_.fail(cells, "must be [along x, along y]");
    const Vec2 origin = vec2_or_zero(object, "origin");
    object.finish();
    return rectangle_mesh(size, {in_.count(cells.items()[0]), in_.count(cells.items()[1])}, origin,
                          shape());
  }

  Mesh disc(const JsonValue& value) const {
    JsonObject object(in_, value);
    const double radius = in_.positive(object.required("radius", "in m"), "m");
    DiscCells cells;
    cells.quarter = in_.count(object.required("cells", "along a quarter of the circle"));
    const Vec2 centre = vec2_or_zero(object, "centre");
    object.read("grading", cells.grading, &JsonReader::number, "");
    object.finish();
    return disc_mesh(centre, radius, cells, shape());
  }

  Mesh half_disc(const JsonValue& value) const {
    JsonObject object(in_, value);
    const double radius = in_.positive(object.required("radius", "in m"), "m");
    HalfDiscCells cells{};
    cells.fine =
        in_.positive(object.required("fine", "half-width of the fine part, in m"), "m") / radius;
    cells.cells = in_.count(object.required("cells", "of the fine part's half-width"));
    object.read("growth", cells.growth, &JsonReader::number, "");
    const Vec2 pole = vec2_or_zero(object, "pole");
    object.finish();
    return half_disc_mesh(pole, radius, cells, shape());
  }

  Mesh fill(const JsonValue& value) const {
    JsonObject object(in_, value);
    const JsonValue& outline = outline_of(object);
    const Polygon region = read_polygon(in_, outline, object.optional("holes"));
    const double size = in_.positive(object.required("size", "of the elements, in m"), "m");
    object.finish();
    return fill_mesh(region, size, shape());
  }

  Mesh voronoi(const JsonValue& value) const {
    JsonObject object(in_, value);
    VoronoiOptions options;
    options.cells = in_.count(object.required("cells", "the number of cells"));
    object.read("seed", options.seed, &JsonReader::count);
    object.read("lloyd", options.lloyd, &JsonReader::count);
    object.read("shortest_edge", options.shortest_edge, &JsonReader::number, "");
    object.read("convex", options.convex, &JsonReader::boolean);
    object.read("smallest_angle", options.smallest_angle, &JsonReader::number, "rad");
    const JsonValue* size = object.optional("size");
    const JsonValue* holes = object.optional("holes");
    if (size != nullptr && holes != nullptr) {
      in_.fail(*holes, "belongs to a \"polygon\"; give the rectangle as one");
    }
    const Polygon region =
        size != nullptr ? block(object, *size) : read_polygon(in_, outline_of(object), holes);
    object.finish();
    return mesh_of_cells(region, in_world(region, voronoi_mesh(region, options).mesh));
  }

  Mesh file(const JsonValue& value) const {
    try {
      return read_mesh_file(file_beside(in_, in_.string(value)), rules());
    } catch (const SceneError& error) {
      in_.fail(value, error.what());
    }
  }

  Vec2 vec2_or_zero(JsonObject& object, const char* key) const {
    const JsonValue* v = object.optional(key);
    return v != nullptr ? in_.vec2(*v, "m") : Vec2::Zero();
  }

  [[nodiscard]] const JsonValue& outline_of(JsonObject& object) const {
    const JsonValue* file = object.optional("file");
    if (file == nullptr) {
      return object.required("polygon", "[[x,y],...] in m, or the name of a file");
    }
    in_.string(*file);
    if (object.optional("polygon") != nullptr) {
      in_.fail(*file, "the polygon is given twice; leave out \"file\" or \"polygon\"");
    }
    return *file;
  }

  Polygon block(JsonObject& object, const JsonValue& size) const {
    const Vec2 diagonal = in_.vec2(size, "m");
    if (!(diagonal.minCoeff() > 0)) in_.fail(size, "must be two positive lengths in m");
    const Vec2 origin = vec2_or_zero(object, "origin");
    const Vec2 far = origin + diagonal;
    return Polygon({origin, {far.x(), origin.y()}, far, {origin.x(), far.y()}});
  }

  // The element for a mesh whose scene does not choose one.
  static ElementKind fitting(const Mesh& mesh) {
    const size_t n = mesh.element(0).size();
    for (int e = 0; e < mesh.element_count(); ++e) {
      if (mesh.element(e).size() != n) return ElementKind::polygon;
    }
    return n == 3 ? ElementKind::tri3 : n == 4 ? ElementKind::quad4 : ElementKind::polygon;
  }

  void require_fit(const Mesh& mesh) const {
    const auto corners = static_cast<size_t>(element_->corners);
    for (int e = 0; e < mesh.element_count() && corners != 0; ++e) {
      if (mesh.element(e).size() == corners) continue;
      in_.fail(*element_value_,
               fmt::format("\"{}\" has {} corners, but element {} of the mesh has {}; \"polygon\" "
                           "fits every mesh",
                           element_->name, corners, e, mesh.element(e).size()));
    }
  }

  const JsonReader& in_;
  const JsonValue& value_;
  const JsonValue* element_value_ = nullptr;
  const ElementName* element_ = nullptr;  // null if the scene does not choose one
};

const std::array<MeshReader::Way, 6> MeshReader::kWays{{{"rectangle", &MeshReader::rectangle},
                                                        {"disc", &MeshReader::disc},
                                                        {"half_disc", &MeshReader::half_disc},
                                                        {"fill", &MeshReader::fill},
                                                        {"voronoi", &MeshReader::voronoi},
                                                        {"file", &MeshReader::file}}};

}  // namespace

MeshSpec read_mesh(const JsonReader& in, const JsonValue& value) {
  return MeshReader(in, value).read();
}

}  // namespace apothem
