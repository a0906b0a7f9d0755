// Reads the contact law of a scene.
#pragma once

#include "lib/model/model.hpp"
#include "lib/scene/compatibility.hpp"
#include "lib/scene/json.hpp"

namespace apothem {

class ContactReader {
 public:
  /// The model receives the contact law.
  ContactReader(const JsonReader& in, Model& model, UsedFeatures& features)
      : in_(in), model_(model), features_(features) {}

  /// Reads all but the rules for pairs. Throws SceneError.
  void read(const JsonValue& value);

  /// Reads the rules for pairs of materials or bodies. Called when the model has its bodies,
  /// because the rules name them. Throws SceneError.
  void read_pairs();

 private:
  void potential(const JsonValue& value);
  void field(const JsonValue& value);
  void reference(const JsonValue& value);
  Friction friction(const JsonValue& value, bool of_scene);
  void friction_law(const JsonValue& value);
  void damping(const JsonValue& value);
  void damping_model(const JsonValue& value);
  ContactDamping dashpots(JsonObject& object, bool tangential);
  void surface(const JsonValue* surface, const JsonValue* distribution);
  [[nodiscard]] ContactRule::Party party(const JsonValue& value) const;

  const JsonReader& in_;
  Model& model_;
  UsedFeatures& features_;
  const JsonValue* pairs_ = nullptr;
  bool damped_ = false, mass_damped_ = false;  // kinds of damping that have been given
};

}  // namespace apothem
