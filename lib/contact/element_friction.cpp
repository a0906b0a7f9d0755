#include "apothem/contact/element_friction.hpp"

#include <algorithm>
#include <cmath>

#include "apothem/contact/tangential.hpp"

namespace apothem {
namespace {

Vec2 rate_of(std::span<const double> velocity, int entry, const Vec2& point) {
  const double* v = &velocity[3 * static_cast<size_t>(entry)];
  return Vec2(v[0], v[1]) + cross(v[2], point);
}

}  // namespace

void ElementFriction::update(const ElementContact& contact, std::span<const double> node_velocity,
                             std::span<const double> velocity, double dt) {
  const double power_before = power(contact, node_velocity, velocity);
  std::swap(now_, before_);
  now_.slips.clear();
  now_.energy = 0;
  now_.friction_loss = before_.friction_loss;
  forces_.clear(), node_forces_.clear(), touches_.clear();
  sums_.assign(contact.body_count(), {Vec2::Zero(), 0});

  // Of the material at a point.
  const auto velocity_at = [&](int polygon, const Vec2& point, ElementContact::Corners& corners) {
    contact.find_corners(polygon, point, corners);
    if (contact.entry(polygon) >= 0) return rate_of(velocity, contact.entry(polygon), point);
    Vec2 sum = Vec2::Zero();
    for (size_t k = 0; k < corners.nodes.size(); ++k) {
      const double* v = &node_velocity[2 * static_cast<size_t>(corners.nodes[k])];
      sum += corners.weights[k] * Vec2(v[0], v[1]);
    }
    return sum;
  };
  auto old = before_.slips.begin();
  for (const ElementContact::Touch& t : contact.touches()) {
    const Friction& friction = table_.between(contact.body(t.a), contact.body(t.b));
    if (!(friction.coefficient > 0)) continue;
    const double normal = t.force.norm();
    if (!(normal > kNoResultant * t.pressure)) continue;
    EdgeSlip slip{t.a, t.b, 0, friction.tangential_stiffness * contact.thickness()};
    while (old != before_.slips.end() && old->key() < slip.key()) ++old;
    const bool known = old != before_.slips.end() && old->key() == slip.key();
    const Vec2 tangent = tangent_of(t.force);
    const Vec2 point_b = t.point + t.offset;
    const Vec2 rate = velocity_at(t.a, t.point, of_a_) - velocity_at(t.b, point_b, of_b_);
    const double limit = friction.coefficient * normal;
    slip.spring = std::clamp((known ? old->spring : 0) - slip.stiffness * (rate.dot(tangent) * dt),
                             -limit, limit);
    now_.slips.push_back(slip);
    touches_.push_back(static_cast<int>(&t - contact.touches().data()));
    now_.energy += slip.energy();
    const Vec2 force = slip.spring * tangent;
    apply(contact, {t.a, force, t.point}, of_a_);
    apply(contact, {t.b, -force, point_b}, of_b_);
  }
  // What the bodies lose between the two forces, and the springs do not store.
  now_.friction_loss -= dt / 2 * (power_before + power(contact, node_velocity, velocity));
  now_.friction_loss -= now_.energy - before_.energy;
}

void ElementFriction::apply(const ElementContact& contact, const Force& force,
                            const ElementContact::Corners& corners) {
  forces_.push_back(force);
  DeformableContact::Resultant& sum = sums_[contact.body(force.polygon)];
  sum.force += force.force;
  if (contact.entry(force.polygon) >= 0) sum.moment += cross(force.point, force.force);
  for (size_t k = 0; k < corners.nodes.size(); ++k) {
    node_forces_.push_back({corners.nodes[k], corners.weights[k] * force.force});
  }
}

// Of the forces on the bodies, W.
double ElementFriction::power(const ElementContact& contact, std::span<const double> node_velocity,
                              std::span<const double> velocity) const {
  double sum = 0;
  for (const auto& [node, force] : node_forces_) {
    const double* v = &node_velocity[2 * static_cast<size_t>(node)];
    sum += force.x() * v[0] + force.y() * v[1];
  }
  for (const auto& [polygon, force, point] : forces_) {
    const int entry = contact.entry(polygon);
    if (entry >= 0) sum += force.dot(rate_of(velocity, entry, point));
  }
  return sum;
}

void ElementFriction::add_forces(const ElementContact& /*contact*/,
                                 std::span<double> node_force) const {
  for (const auto& [node, force] : node_forces_) {
    node_force[2 * static_cast<size_t>(node)] += force.x();
    node_force[2 * static_cast<size_t>(node) + 1] += force.y();
  }
}

double ElementFriction::size(const ElementContact& contact, int body) const {
  double sum = 0;
  for (const Force& f : forces_) {
    if (contact.body(f.polygon) == body) sum += f.force.norm();
  }
  return sum;
}

void ElementFriction::add_to(const ElementContact& contact,
                             std::vector<BodyContact>& contacts) const {
  const std::vector<int> patch = contact.patches();
  for (size_t i = 0; i < touches_.size(); ++i) {
    contacts[patch[touches_[i]]].friction += forces_[2 * i].force;  // on a
  }
}

std::vector<double> ElementFriction::tractions(
    const ElementContact& contact, const std::vector<ElementContact::SurfaceEdge>& surface) const {
  std::vector<double> traction(surface.size());
  for (const auto& [polygon, force, point] : forces_) {
    const int i = contact.nearest_edge(surface, polygon, point);
    traction[i] += force.dot(surface[i].along()) / (surface[i].length() * contact.thickness());
  }
  return traction;
}

}  // namespace apothem
