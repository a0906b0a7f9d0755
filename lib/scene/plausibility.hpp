// Values that are legal but hardly meant: another unit, degrees instead of radians, stiffnesses far
// from each other. They do not stop a run; the user is told the key.
#pragma once

#include <string>
#include <vector>

#include "lib/scene/scene.hpp"

namespace apothem {

/// One line for each such value of the scene: file, line, JSON pointer, value and what to check.
std::vector<std::string> unlikely_values(const Scene& scene);

}  // namespace apothem
