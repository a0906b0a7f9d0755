// Hashes of scenes and of states: equal hashes mean equal bits.
#pragma once

#include <string>
#include <string_view>

#include "lib/model/state.hpp"
#include "lib/scene/scene.hpp"

namespace apothem {

/// Of the scene as read, with its settings and what stands in files of their own: polygons, meshes
/// and drawings.
std::string scene_hash(const Scene& scene);

/// Of the potentials of all rigid bodies, from which the forces of contact come. They follow from
/// the scene, but for what constructs straight skeletons, which may be of another version.
std::string potentials_hash(const Model& model);

/// Of a text.
std::string text_hash(std::string_view text);

/// Of time, places, velocities and forces.
std::string state_hash(const State& state);

}  // namespace apothem
