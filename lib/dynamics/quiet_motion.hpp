// Motion that nobody notices: what the accuracy of a run lets its bodies be off anyway.
#pragma once

#include <cstdint>
#include <vector>

#include "lib/dynamics/degrees_of_freedom.hpp"
#include "lib/model/model.hpp"
#include "lib/model/state.hpp"

namespace apothem {

/// The shortest length of a body that tells how exactly each coordinate is known: a rigid body's
/// inradius (as an angle, over its radius), for nodes the shortest edge of the elements, or a free
/// rigid body's inradius if that is shorter; m or rad.
class Lengths {
 public:
  /// The model must outlive this object.
  Lengths(const Model& model, const Layout& layout);
  [[nodiscard]] double of(size_t coordinate) const {
    if (coordinate >= first_node_) return shortest_;
    const size_t body = coordinate / 3;
    return model_.bodies[body].inradius / (coordinate % 3 == 2 ? radius_[body] : 1);
  }
  /// Of nodes; infinite if nothing is free, m.
  [[nodiscard]] double shortest() const { return shortest_; }
  /// Of each rigid body, from its mass centre to its farthest vertex, m.
  [[nodiscard]] const std::vector<double>& radius() const { return radius_; }

 private:
  const Model& model_;
  size_t first_node_;
  double shortest_;
  std::vector<double> radius_;
};

class QuietMotion {
 public:
  /// Steps of the scheme, over which a body may move unnoticed.
  static constexpr std::int64_t kSteps = 16;

  QuietMotion(const Model& model, const DegreesOfFreedom& dofs, double accuracy);
  /// Whether no body would move noticeably in so many steps of dt (s), nor fast enough to bounce
  /// noticeably.
  [[nodiscard]] bool holds(const State& state, double dt) const;
  /// How far a coordinate may be off, m or rad.
  [[nodiscard]] double way(size_t coordinate) const { return way_[coordinate]; }
  /// How far its velocity may be off, as much as makes a difference of that height, m/s or rad/s.
  [[nodiscard]] double speed(size_t coordinate) const { return speed_[coordinate]; }
  /// What lifts all bodies by what they may be off, J.
  [[nodiscard]] double energy() const { return energy_; }

 private:
  const DegreesOfFreedom& dofs_;
  std::vector<double> way_, speed_;
  double energy_ = 0;
};

}  // namespace apothem
