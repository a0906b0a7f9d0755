// What a simulation remembers, as JSON and as text.
#pragma once

#include "lib/dynamics/simulation.hpp"
#include "lib/run/json_archive.hpp"

namespace apothem::test {

inline nlohmann::json saved(Simulation& simulation) {
  JsonWriter archive;
  archive("simulation", simulation);
  return archive.json();
}

/// Equal texts mean that two simulations remember the same, to the last bit.
inline std::string saved_text(Simulation& simulation) { return saved(simulation).dump(); }

inline void restore(Simulation& simulation, const nlohmann::json& json) {
  JsonLoader archive(json);
  archive("simulation", simulation);
  simulation.refresh();
}

}  // namespace apothem::test
