// Reads the supports and loads of a body with a mesh, and the histories of motions and loads.
#pragma once

#include "lib/mesh/select.hpp"
#include "lib/model/model.hpp"
#include "lib/scene/json.hpp"

namespace apothem {

class DeformableReader {
 public:
  /// `body` has its material, and its mesh in model coordinates at the place where it starts. It
  /// receives the supports and loads.
  DeformableReader(const JsonReader& in, const Model& model, DeformableBody& body)
      : in_(in), model_(model), body_(body) {}

  /// Both throw SceneError.
  void supports(const JsonValue& value);
  void loads(const JsonValue& value);

 private:
  Place place(const JsonValue& value) const;
  std::vector<int> nodes(const JsonValue& where) const;
  std::vector<MeshEdge> edges(const JsonValue& where) const;
  void support(const JsonValue& value);
  void rotation(JsonObject& object, Support& support) const;
  void load(const JsonValue& value);
  void point_force(const JsonValue& at, const Vec2& force, const LoadHistory& history);
  void edge_force(const JsonValue& where, const Vec2& value, bool per_area,
                  const LoadHistory& history);
  void pressure(const JsonValue& where, double value, const LoadHistory& history);
  void body_force(const Vec2& density, const LoadHistory& history);

  const JsonReader& in_;
  const Model& model_;
  DeformableBody& body_;
  std::vector<std::array<bool, 2>> held_;  // x and y of each node, by the supports read so far
};

/// Why a "pivot" without a "spin" is refused.
inline constexpr const char* kPivotAtRest =
    "nothing turns about it; give a \"spin\" history, or leave it out";

/// Histories with increasing times: [[t, vx, vy], ...], [[t, spin], ...] and [[t, factor], ...].
/// They throw SceneError.
std::vector<MotionHistory::VelocityPoint> read_velocities(const JsonReader& in,
                                                          const JsonValue& value);
std::vector<MotionHistory::SpinPoint> read_spins(const JsonReader& in, const JsonValue& value);
LoadHistory read_load_history(const JsonReader& in, const JsonValue& value);

}  // namespace apothem
