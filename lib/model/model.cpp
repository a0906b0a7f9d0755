#include "model/model.hpp"

#include <cmath>

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

}  // namespace

std::array<double, 3> MotionHistory::rate(double time) const {
  const Vec2 v = velocity.empty()
                     ? Vec2(0, 0)
                     : interpolate(velocity, time, [](const auto& p) { return p.velocity; });
  const double w = spin.empty() ? 0 : interpolate(spin, time, [](const auto& p) { return p.spin; });
  return {v.x(), v.y(), w};
}

std::array<double, 3> MotionHistory::displacement(double time) const {
  Vec2 u(0, 0);
  double angle = 0;
  if (!velocity.empty()) u = integrate(velocity, time, [](const auto& p) { return p.velocity; });
  if (!spin.empty()) angle = integrate(spin, time, [](const auto& p) { return p.spin; });
  return {u.x(), u.y(), angle};
}

std::array<double, 3> RigidBody::inverse_mass() const {
  if (motion != Motion::free) return {0, 0, 0};
  return {held[0] ? 0 : 1 / mass, held[1] ? 0 : 1 / mass, held[2] ? 0 : 1 / inertia};
}

void set_shape(RigidBody& body, const Polygon& polygon, const Model& model) {
  const AreaMoments moments = area_moments(polygon);
  body.potential = translated(make_potential(polygon, model.contact.potential), moments.centroid);
  body.inradius = polygon.is_convex() ? inscribed_circle(polygon).radius
                                      : body.potential.top / body.potential.steepest;
  body.area = moments.area;
  const double surface_density = model.materials[body.material].density * model.thickness;
  body.mass = surface_density * moments.area;
  body.inertia = surface_density * moments.polar;
  body.position = (polygon.origin() - model.origin) + moments.centroid;
}

}  // namespace apothem
