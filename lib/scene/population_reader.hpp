// Reads what a scene says of many bodies: the world, the regions, and when to stop.
#pragma once

#include <vector>

#include "lib/model/model.hpp"
#include "lib/model/settings.hpp"
#include "lib/scene/compatibility.hpp"
#include "lib/scene/json.hpp"

namespace apothem {

class PopulationReader {
 public:
  /// The model has its origin, and receives world and regions.
  PopulationReader(const JsonReader& in, Model& model, UsedFeatures& features)
      : in_(in), model_(model), features_(features) {}

  /// All throw SceneError.
  void world(const JsonValue& value);
  void regions(const JsonValue& value);
  /// Called after `regions`.
  [[nodiscard]] std::vector<StopRule> stops(const JsonValue& value);

 private:
  [[nodiscard]] StopRule stop(const JsonValue& value) const;

  const JsonReader& in_;
  Model& model_;
  UsedFeatures& features_;
};

}  // namespace apothem
