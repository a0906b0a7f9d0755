// What stands in a scene about a body with a mesh: supports, loads, start.
#pragma once

#include "apothem/mesh/select.hpp"
#include "apothem/model/model.hpp"
#include "apothem/scene/json.hpp"

namespace apothem {

class DeformableReader {
 public:
  /// `body` has a mesh in model coordinates, where it starts, and a material.
  DeformableReader(const JsonReader& in, const Model& model, DeformableBody& body)
      : in_(in), model_(model), body_(body) {}

  void supports(const JsonValue& value);
  void loads(const JsonValue& value);

 private:
  Place place(const JsonValue& value) const;
  std::vector<int> nodes(const JsonValue& where) const;
  std::vector<MeshEdge> edges(const JsonValue& where) const;
  void support(const JsonValue& value);
  void load(const JsonValue& value);
  void point_force(const JsonValue& at, const Vec2& force, const LoadHistory& history);
  void edge_force(const JsonValue& where, const Vec2& value, bool per_area,
                  const LoadHistory& history);
  void pressure(const JsonValue& where, double value, const LoadHistory& history);
  void body_force(const Vec2& density, const LoadHistory& history);

  const JsonReader& in_;
  const Model& model_;
  DeformableBody& body_;
  std::vector<std::array<bool, 2>> held_;  // of each node, by an earlier support
};

/// [[t, vx, vy], ...], [[t, spin], ...] and [[t, factor], ...] with increasing times.
std::vector<MotionHistory::VelocityPoint> read_velocities(const JsonReader& in,
                                                          const JsonValue& value);
std::vector<MotionHistory::SpinPoint> read_spins(const JsonReader& in, const JsonValue& value);
LoadHistory read_load_history(const JsonReader& in, const JsonValue& value);

}  // namespace apothem
