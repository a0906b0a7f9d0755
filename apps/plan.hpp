// From a scene to something that can run, with the scene's own place in every error.
#pragma once

#include "apothem/dynamics/simulation.hpp"
#include "apothem/scene/scene.hpp"

namespace apothem {

/// Where a simulation begins: as its scene says, or from a snapshot that follows (it need not
/// settle).
enum class Start { scene, snapshot };

/// Throws SceneError instead of Unrunnable.
Simulation make_simulation(const Scene& scene, int threads, Start start = Start::scene);

}  // namespace apothem
