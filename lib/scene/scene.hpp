// A scene file, read, checked and turned into a model.
#pragma once

#include <string>
#include <vector>

#include "apothem/model/model.hpp"
#include "apothem/model/settings.hpp"
#include "apothem/scene/json.hpp"

namespace apothem {

struct Scene {
  std::string file;
  std::string text;  ///< as read
  Model model;
  TimeSettings time;
  OutputSettings output;
  std::vector<Expectation> expectations;
  std::vector<int> rigid_places;  ///< of each rigid body, in the scene's list of bodies

  /// An error at a JSON pointer of this scene, or at the nearest enclosing value that exists.
  [[nodiscard]] SceneError error_at(const std::string& pointer, const std::string& what) const;

  JsonValue document;
};

/// Throws SceneError.
Scene read_scene(const std::string& file);

}  // namespace apothem
