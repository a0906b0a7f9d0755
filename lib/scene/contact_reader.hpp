// What stands in a scene about contact.
#pragma once

#include "apothem/model/model.hpp"
#include "apothem/scene/json.hpp"

namespace apothem {

class ContactReader {
 public:
  ContactReader(const JsonReader& in, Model& model) : in_(in), model_(model) {}

  void read(const JsonValue& value);
  /// Rules for pairs; after the bodies, whose names these may use.
  void pairs();
  /// Refuses what would mean nothing because all that can touch has a mesh.
  void refuse_with_meshes() const;
  /// Where the scene asks for potentials of elements, or nullptr.
  [[nodiscard]] const JsonValue* element_surface() const { return element_surface_; }

 private:
  void surface(JsonObject& object);
  Friction friction(const JsonValue& value, bool of_scene);
  void damping(const JsonValue& value);
  [[nodiscard]] ContactRule::Party party(const JsonValue& value) const;
  void field(const JsonValue& value);
  void reference(const JsonValue& value);

  const JsonReader& in_;
  Model& model_;
  const JsonValue* pairs_ = nullptr;
  const JsonValue* potential_ = nullptr;
  const JsonValue* friction_law_ = nullptr;
  const JsonValue* damping_ = nullptr;
  const JsonValue* element_surface_ = nullptr;
};

}  // namespace apothem
