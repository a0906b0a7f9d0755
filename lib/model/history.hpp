// Given functions of time.
#pragma once

#include <array>
#include <vector>

#include "geometry/polygon/point.hpp"

namespace apothem {

/// Prescribed motion: velocity of a pivot and spin about it, piecewise linear in time, constant
/// before the first and after the last point.
struct MotionHistory {
  struct VelocityPoint {
    double time;
    Vec2 velocity;
  };
  struct SpinPoint {
    double time;
    double spin;
  };
  std::vector<VelocityPoint> velocity;  ///< may be empty: no translation
  std::vector<SpinPoint> spin;          ///< may be empty: no rotation

  [[nodiscard]] bool empty() const { return velocity.empty() && spin.empty(); }
  /// Velocity (vx, vy, spin) at `time` of what has lain `arm` (m) from the pivot at time 0.
  [[nodiscard]] std::array<double, 3> rate(double time, const Vec2& arm = Vec2::Zero()) const;
  /// Its displacement and rotation since time 0: the histories are integrated exactly, and the
  /// place on the circle about the pivot follows from the angle.
  [[nodiscard]] std::array<double, 3> displacement(double time,
                                                   const Vec2& arm = Vec2::Zero()) const;
};

/// A factor, piecewise linear in time, constant before the first and after the last point.
struct LoadHistory {
  struct Point {
    double time;
    double factor;
  };
  std::vector<Point> points;  ///< may be empty: 1

  [[nodiscard]] double at(double time) const;
  /// The largest size of the factor.
  [[nodiscard]] double largest() const;
};

/// A wall that moves along its direction so that it holds a force: the difference of the force to
/// be held and the contact force that resists accelerates its mass. Its speed stays below a limit.
struct Servo {
  Vec2 direction;       ///< of unit length
  double force = 0;     ///< N, at factor 1
  double speed = 0;     ///< m/s, the highest one
  LoadHistory history;  ///< of the factor

  /// What accelerates the wall along the direction against a contact force on it, N.
  [[nodiscard]] double excess(double time, const Vec2& contact_force) const {
    return force * history.at(time) + contact_force.dot(direction);
  }
  /// The speed along the direction after dt (s), of a wall of that mass (kg) with the speed
  /// `before`, against a contact force on it (N).
  [[nodiscard]] double rate(double time, const Vec2& contact_force, double before, double mass,
                            double dt) const;
};

}  // namespace apothem
