// Reads the bodies of a scene: rigid bodies, which have a polygon, and deformable ones, which have
// a mesh.
#pragma once

#include <deque>
#include <functional>
#include <string>
#include <unordered_set>
#include <variant>
#include <vector>

#include "geometry/potential/potentials.hpp"
#include "lib/model/model.hpp"
#include "lib/scene/compatibility.hpp"
#include "lib/scene/json.hpp"
#include "lib/scene/mesh_reader.hpp"

namespace apothem {

/// The name of one of many bodies.
std::string numbered(const std::string& name, int number);

class BodyReader {
 public:
  /// The model holds the contact law and the materials, which stand at `materials` in the scene. It
  /// receives the bodies, and the origin of its coordinates.
  BodyReader(const JsonReader& in, const JsonValue& materials, Model& model, UsedFeatures& features)
      : in_(in), materials_(materials), model_(model), features_(features) {}

  /// Reads the shapes of bodies, which are then the next ones in the list of bodies. The values
  /// must outlive this object. Throws SceneError.
  void add(const std::vector<JsonValue>& bodies);
  /// Adds rigid bodies that have all but their names and polygons in common, which are then the
  /// next ones in the list. `alike` is one of them, without a number in its name.
  void add(const JsonValue& alike, std::vector<Polygon> polygons);
  /// The outlines of all bodies so far, where they start, in world coordinates, m. Of a mesh in
  /// several parts those around the parts, without holes.
  [[nodiscard]] std::vector<PolygonWithHoles> outlines() const;
  /// Reads all bodies, when all shapes are known. Throws SceneError.
  void read();

  /// Names of all bodies, in the order of the list.
  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
  /// JSON pointers of the rigid bodies of the model.
  [[nodiscard]] const std::vector<std::string>& rigid_pointers() const { return rigid_pointers_; }
  /// What was not made at once, one sentence each.
  [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }
  /// The number in the model of the body at a place of the list.
  [[nodiscard]] BodyIndex body_at(size_t place) const;

 private:
  using Shape = std::variant<Polygon, MeshSpec>;

  Shape read_shape(const JsonValue& value);
  Box extent(const JsonValue& value, const Shape& shape) const;
  [[nodiscard]] std::vector<Vec2> moved(const JsonValue& value, std::vector<Vec2> points,
                                        const Vec2& centre) const;
  using PotentialSource = std::function<Potential()>;

  /// Of all polygons, in their order.
  [[nodiscard]] Potentials find_potentials() const;
  void rigid_body(const JsonValue& value, const Polygon& polygon, const PotentialSource& potential);
  void give_shape(const JsonValue& value, const Polygon& polygon, const PotentialSource& potential,
                  RigidBody& body);
  void deformable_body(const JsonValue& value, MeshSpec spec);
  void place_mesh(JsonObject& object, Mesh& mesh) const;
  void name_and_material(JsonObject& object, std::string& name, MaterialIndex& material);
  [[nodiscard]] MaterialIndex material(const JsonValue& name) const;
  void require_elastic(const JsonValue& name, MaterialIndex material) const;
  void element_materials(const JsonValue& value, DeformableBody& body) const;
  Motion motion(const JsonValue& value);
  void prescribed_motion(const JsonValue& value, RigidBody& body);
  void servo(const JsonValue& value, RigidBody& body) const;
  void held_coordinates(const JsonValue& value, RigidBody& body);
  void initial_velocity(JsonObject& object, Vec2& velocity, double& spin);
  void refuse_held_velocity(const JsonValue& value, const RigidBody& body) const;
  /// The place in the scene's list of the body that is being read.
  [[nodiscard]] int place() const { return static_cast<int>(names_.size()) - 1; }

  // Bodies that have all but their names and polygons in common.
  struct Series {
    size_t first, end;  // their places in the list
    JsonValue value;    // of the body that is being read
    std::string name;
  };

  const JsonReader& in_;
  const JsonValue& materials_;
  Model& model_;
  UsedFeatures& features_;
  std::vector<const JsonValue*> values_;  // of all bodies
  std::vector<Shape> shapes_;
  std::deque<Series> series_;
  std::vector<std::string> names_;
  std::unordered_set<std::string> known_names_;
  std::vector<std::string> rigid_pointers_;
  std::vector<std::string> warnings_;
  std::vector<int> numbers_;  // among the rigid bodies, or -1 - number among the deformable ones
};

}  // namespace apothem
