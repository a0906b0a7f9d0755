// From a scene to something that can run, with the scene's own place in every error.
#pragma once

#include "dynamics/simulation.hpp"
#include "scene/scene.hpp"

namespace apothem {

/// Throws SceneError instead of Unrunnable.
Simulation make_simulation(const Scene& scene, int threads);

}  // namespace apothem
