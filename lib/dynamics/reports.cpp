// What a simulation tells of its present state.
#include <algorithm>

#include "lib/dynamics/contact_term.hpp"
#include "lib/dynamics/elements.hpp"
#include "lib/dynamics/simulation.hpp"
#include "lib/model/inradius.hpp"

namespace apothem {

std::vector<ContactRecord> Simulation::contacts() const {
  return contact_ ? contact_->contacts().records() : std::vector<ContactRecord>{};
}

ContactNumbers Simulation::contact_numbers() const {
  return contact_ ? contact_->contacts().numbers() : ContactNumbers{};
}

std::vector<BodyForce> Simulation::contact_forces() const {
  std::vector<BodyForce> forces(model_.bodies.size() + model_.deformables.size());
  if (!contact_) return forces;
  const std::vector<double> friction = contact_->contacts().friction_sizes();
  for (size_t i = 0; i < forces.size(); ++i) forces[i].friction = friction[i];
  for (size_t i = 0; i < model_.deformables.size(); ++i) {
    const Vec2 force = contact_->force_on(static_cast<DeformableIndex>(i));
    BodyForce& on = forces[model_.bodies.size() + i];
    on.fx = force.x(), on.fy = force.y();
  }
  return forces;
}

std::vector<SurfaceRecord> Simulation::surfaces() const {
  return contact_ ? contact_->contacts().surface_records() : std::vector<SurfaceRecord>{};
}

std::vector<CauchyStress> Simulation::stresses() const {
  return elements_ ? elements_->elements().stresses(state_.layout.of_nodes(state_.x))
                   : std::vector<CauchyStress>{};
}

std::vector<CauchyStress> Simulation::stresses(const std::vector<TrackedPoint>& points) const {
  std::vector<CauchyStress> result;
  for (const TrackedPoint& p : points) {
    result.push_back(
        elements_->elements().stress(state_.layout.of_nodes(state_.x), p.body, p.element));
  }
  return result;
}

Extremes Simulation::extremes() const {
  Extremes extremes;
  if (contact_) {
    extremes.penetration = contact_->penetration();
    extremes.relative_penetration = contact_->relative_penetration();
    extremes.force = contact_->force();
  }
  extremes.energy_error = guard_.largest_error();
  extremes.energy_in_play = guard_.in_play();
  extremes.energy_allowed = equilibrium_ ? HUGE_VAL : guard_.allowed();
  return extremes;
}

ContactCounts Simulation::counts() const { return contact_ ? contact_->counts() : ContactCounts{}; }

std::vector<PairDepth> Simulation::overlaps() const {
  std::vector<PairDepth> pairs;
  for (const ContactRecord& patch : contacts()) {
    if (!(patch.penetration > 0)) continue;
    if (pairs.empty() || pairs.back().a != patch.a || pairs.back().b != patch.b) {
      pairs.push_back({patch.a, patch.b, 0, 0});
    }
    pairs.back().depth = std::max(pairs.back().depth, patch.penetration);
  }
  std::vector<double> inradius(model_.bodies.size() + model_.deformables.size());
  const auto inradius_once = [&](BodyIndex body) {
    if (inradius[body] == 0) inradius[body] = inradius_of(model_, body);
    return inradius[body];
  };
  for (PairDepth& pair : pairs) {
    pair.share = pair.depth / std::min(inradius_once(pair.a), inradius_once(pair.b));
  }
  std::ranges::stable_sort(
      pairs, [](const PairDepth& p, const PairDepth& q) { return p.share > q.share; });
  return pairs;
}

Forecast Simulation::forecast() const {
  return contact_ ? apothem::forecast(model_, contact_->contacts().surfaces().slopes())
                  : Forecast{};
}

PhaseSeconds Simulation::phase_seconds() const {
  PhaseSeconds seconds = clock_.seconds();
  for (double& s : seconds) {
    s *= timed_steps_ > 0 ? static_cast<double>(verlet_steps_) / static_cast<double>(timed_steps_)
                          : 0;
  }
  return seconds;
}

}  // namespace apothem
