// What a simulation tells of its present state.
#include "apothem/dynamics/contact_term.hpp"
#include "apothem/dynamics/elements.hpp"
#include "apothem/dynamics/simulation.hpp"

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

const std::vector<double>& Simulation::node_mass() const {
  static const std::vector<double> kNone;
  return elements_ ? elements_->elements().mass() : kNone;
}

Extremes Simulation::extremes() const {
  return {contact_ ? contact_->penetration() : Peak{}, contact_ ? contact_->force() : Peak{},
          energy_error_};
}

ContactCounts Simulation::counts() const { return contact_ ? contact_->counts() : ContactCounts{}; }

PhaseSeconds Simulation::phase_seconds() const {
  PhaseSeconds seconds = clock_.seconds();
  for (double& s : seconds) {
    s *=
        timed_steps_ > 0 ? static_cast<double>(own_steps()) / static_cast<double>(timed_steps_) : 0;
  }
  return seconds;
}

}  // namespace apothem
