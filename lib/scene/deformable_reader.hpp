// Reads the supports and loads of a body with a mesh, and the histories of motions and loads.
#pragma once

#include "lib/model/model.hpp"
#include "lib/scene/json.hpp"

namespace apothem {

/// Supports and loads of a body that has its material, and its mesh in model coordinates at the
/// place where it starts. Both throw SceneError.
void read_supports(const JsonReader& in, const JsonValue& value, const Model& model,
                   DeformableBody& body);
void read_loads(const JsonReader& in, const JsonValue& value, const Model& model,
                DeformableBody& body);

/// Why a "pivot" without a "spin" is refused.
inline constexpr const char* kPivotAtRest =
    "nothing turns about it; give a \"spin\" history, or leave it out";

/// Histories with increasing times: [[t, vx, vy], ...], [[t, spin], ...] and [[t, factor], ...].
/// They throw SceneError.
std::vector<MotionHistory::VelocityPoint> read_velocities(const JsonReader& in,
                                                          const JsonValue& value);
std::vector<MotionHistory::SpinPoint> read_spins(const JsonReader& in, const JsonValue& value);
LoadHistory read_load_history(const JsonReader& in, const JsonValue& value);
/// The same of an angle in rad.
LoadHistory read_tilt_history(const JsonReader& in, const JsonValue& value);

}  // namespace apothem
