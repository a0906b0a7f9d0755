// Given functions of time.
#pragma once

#include <array>
#include <vector>

#include "apothem/geometry/polygon/point.hpp"

namespace apothem {

/// Prescribed motion: velocity and spin piecewise linear in time, constant before the first and
/// after the last point.
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

  /// Velocity (vx, vy, spin) at `time`.
  [[nodiscard]] std::array<double, 3> rate(double time) const;
  /// Displacement and rotation since time 0, integrated exactly.
  [[nodiscard]] std::array<double, 3> displacement(double time) const;
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

}  // namespace apothem
