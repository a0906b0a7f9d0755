// What stands in a scene about results: frames, histories, checkpoints, expectations.
#pragma once

#include <string>
#include <vector>

#include "apothem/model/model.hpp"
#include "apothem/model/settings.hpp"
#include "apothem/scene/json.hpp"

namespace apothem {

class OutputReader {
 public:
  /// The model with all its bodies; `end` of the run, s.
  OutputReader(const JsonReader& in, const Model& model, double end, OutputSettings& output);

  /// Tracks all bodies that can move, if they are not too many.
  void track_by_default();
  void read(const JsonValue& value);
  /// After the output, whose columns they name.
  [[nodiscard]] std::vector<Expectation> expectations(const JsonValue& value) const;

 private:
  void tracked(const JsonValue& item);
  void tracked_surface(int deformable, const JsonValue& value, const JsonValue* point);
  void tracked_point(int index, const JsonValue& point, const JsonValue* label);

  const JsonReader& in_;
  const Model& model_;
  double end_;
  OutputSettings& output_;
  std::vector<std::string> names_;  // of all bodies
};

/// Refuses a name that could not head columns of a CSV file.
void refuse_as_column(const JsonReader& in, const JsonValue& name);
[[nodiscard]] bool has_control_character(const std::string& name);

}  // namespace apothem
