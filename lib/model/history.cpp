#include "lib/model/history.hpp"

#include <algorithm>
#include <cmath>

#include "lib/model/rotation.hpp"

namespace apothem {
namespace {

// Piecewise linear value at `time`, constant outside the table.
template <class Points, class Value>
auto interpolate(const Points& points, double time, const Value& value) {
  if (time <= points.front().time) return value(points.front());
  for (size_t i = 1; i < points.size(); ++i) {
    const auto& p = points[i - 1];
    const auto& q = points[i];
    if (time < q.time) {
      const double s = (time - p.time) / (q.time - p.time);
      return decltype(value(p))(value(p) + s * (value(q) - value(p)));
    }
  }
  return value(points.back());
}

// Integral of the same function from 0 to `time` >= 0: the trapezoid rule between its kinks.
template <class Points, class Value>
auto integrate(const Points& points, double time, const Value& value) {
  auto previous = interpolate(points, 0, value);
  decltype(previous) sum = 0 * previous;
  double from = 0;
  const auto advance = [&](double to) {
    const auto next = interpolate(points, to, value);
    sum += (to - from) / 2 * (previous + next);
    previous = next;
    from = to;
  };
  for (const auto& p : points) {
    if (p.time > 0 && p.time < time) advance(p.time);
  }
  advance(time);
  return sum;
}

double angle_of(const std::vector<MotionHistory::SpinPoint>& spin, double time) {
  return spin.empty() ? 0 : integrate(spin, time, [](const auto& p) { return p.spin; });
}

}  // namespace

std::array<double, 3> MotionHistory::rate(double time, const Vec2& arm) const {
  const Vec2 v = velocity.empty()
                     ? Vec2(0, 0)
                     : interpolate(velocity, time, [](const auto& p) { return p.velocity; });
  const double w = spin.empty() ? 0 : interpolate(spin, time, [](const auto& p) { return p.spin; });
  if (w == 0 || arm == Vec2::Zero()) return {v.x(), v.y(), w};
  const Vec2 turning = cross(w, turned(arm, angle_of(spin, time)));
  return {v.x() + turning.x(), v.y() + turning.y(), w};
}

std::array<double, 3> MotionHistory::displacement(double time, const Vec2& arm) const {
  Vec2 u(0, 0);
  if (!velocity.empty()) u = integrate(velocity, time, [](const auto& p) { return p.velocity; });
  const double angle = angle_of(spin, time);
  if (arm != Vec2::Zero() && angle != 0) u += turned(arm, angle) - arm;
  return {u.x(), u.y(), angle};
}

double LoadHistory::at(double time) const {
  return points.empty() ? 1 : interpolate(points, time, [](const auto& p) { return p.factor; });
}

double LoadHistory::largest() const {
  double most = points.empty() ? 1 : 0;
  for (const Point& p : points) most = std::max(most, std::abs(p.factor));
  return most;
}

double Servo::rate(double time, const Vec2& contact_force, double before, double mass,
                   double dt) const {
  return std::clamp(before + dt * excess(time, contact_force) / mass, -speed, speed);
}

}  // namespace apothem
