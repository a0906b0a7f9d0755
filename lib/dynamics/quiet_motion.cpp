#include "lib/dynamics/quiet_motion.hpp"

#include <algorithm>
#include <cmath>

#include "lib/mesh/measure.hpp"

namespace apothem {

Lengths::Lengths(const Model& model, const Layout& layout)
    : model_(model), first_node_(layout.node(0)), shortest_(HUGE_VAL) {
  for (const DeformableBody& body : model.deformables) {
    shortest_ = std::min(shortest_, mesh_quality(body.mesh).shortest_edge);
  }
  for (const RigidBody& body : model.bodies) {
    double& radius = radius_.emplace_back(0);
    for (const Vec2& v : body.potential.vertices) radius = std::max(radius, v.norm());
    if (body.motion == Motion::free || body.servo) shortest_ = std::min(shortest_, body.inradius);
  }
}

QuietMotion::QuietMotion(const Model& model, const DegreesOfFreedom& dofs, double accuracy)
    : dofs_(dofs) {
  const Lengths lengths(model, dofs.layout());
  const double g = model.strongest_gravity();
  for (size_t c = 0; c < dofs.layout().size(); ++c) {
    const bool angle = c < dofs.layout().node(0) && c % 3 == 2;
    const double length = lengths.of(angle ? c - 2 : c);
    const double part = lengths.of(c) / length;
    way_.push_back(accuracy * length * part);
    if (!angle && dofs.can_move(c)) energy_ += dofs.mass(c) * g * way_.back() / 2;  // x and y
    const double fall = 2 * g * accuracy * length;
    speed_.push_back(fall > 0 ? std::sqrt(fall) * part : HUGE_VAL);
  }
}

bool QuietMotion::holds(const State& state, double dt) const {
  const double h = static_cast<double>(kSteps) * dt;
  for (size_t c = 0; c < state.v.size(); ++c) {
    const double gravity = dofs_.acceleration().empty() ? 0 : dofs_.acceleration()[c];
    const double a = dofs_.inverse_mass()[c] * state.f[c] + gravity;
    const double v = std::abs(state.v[c]) + h * std::abs(a);
    if (v * h > way_[c] || v > speed_[c]) return false;
  }
  return true;
}

}  // namespace apothem
