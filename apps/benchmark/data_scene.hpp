// Private header: scenes that come with the program.
#pragma once

#include <string>

#include "apps/data_folder.hpp"
#include "lib/scene/scene.hpp"

namespace apothem {

/// The scene of that name, without ".json".
inline Scene data_scene(const std::string& name) {
  return read_scene(data_folder() + "/scenes/" + name + ".json");
}

}  // namespace apothem
