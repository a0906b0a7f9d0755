#include "plan.hpp"

namespace apothem {

Simulation make_simulation(const Scene& scene, int threads, Start start) {
  TimeSettings time = scene.time;
  if (start == Start::snapshot) time.settled = false;
  try {
    return {scene.model, time, scene.output.frames, threads};
  } catch (const Unrunnable& error) {
    const std::string index =
        error.body() >= 0 ? "/" + std::to_string(scene.rigid_places[error.body()]) : "";
    throw scene.error_at("/" + error.key() + index, error.what());
  }
}

}  // namespace apothem
