// What a simulation tells of its present state.
#include <fmt/format.h>

#include <cmath>

#include "apothem/dynamics/simulation.hpp"

namespace apothem {
namespace {

constexpr double kLargestEnergyError = 0.1;  // of the energy in play

}  // namespace

double Simulation::contact_energy() const {
  return model_.stiffness() * contact_.energy(shapes_, state_.position, search_.pairs()) +
         (tangential_ ? tangential_->energy() : 0) + (surface_ ? surface_->energy() : 0);
}

Energies Simulation::energies() {
  Dissipation dissipation{0, mass_damping_loss_};
  if (tangential_) {
    dissipation.friction = tangential_->memory().friction_loss;
    dissipation.damping += tangential_->memory().damping_loss;
  }
  if (surface_) {
    dissipation.friction += surface_->friction_loss();
    const std::vector<ContactRecord> records = surface_->records();
    Vec2 force = Vec2::Zero();  // of the patches of a pair
    for (size_t i = 0; i < records.size(); ++i) {
      const int a = records[i].a, b = records[i].b;
      force += records[i].normal;
      const bool more = i + 1 < records.size() && records[i + 1].a == a && records[i + 1].b == b;
      if (more) continue;
      if (force.norm() > extremes_.force.value) extremes_.force = {force.norm(), state_.time, a, b};
      force = Vec2::Zero();
    }
  }
  const Energies nodes = deformables_ ? deformables_->energies(state_, dt_) : Energies{};
  const Energies e = ledger_->energies(state_, contact_energy(), dissipation, nodes);
  energy_in_play_ =
      std::max(energy_in_play_, e.kinetic + e.strain + e.contact + std::abs(e.external_work));
  extremes_.energy_error = std::max(extremes_.energy_error, std::abs(e.total_error));
  // A load step that comes at once gives off energy; that is no error of the equilibrium.
  if (equilibrium_) return e;
  if (!(std::abs(e.total_error) <= kLargestEnergyError * energy_in_play_ + energy_noise_)) {
    throw Unstable(
        fmt::format("{:.3g} J of the {:.3g} J in play are unaccounted for {}: the step is too "
                    "long for this impact; reduce time.step or time.safety",
                    e.total_error, energy_in_play_, at_time()));
  }
  return e;
}

std::vector<ContactRecord> Simulation::contacts() const {
  static const TangentialMemory kNothing;
  const TangentialMemory& memory = tangential_ ? tangential_->memory() : kNothing;
  size_t next_pair = 0, next_patch = 0,
         next_spring = 0;  // of the memory, in the order of the pairs
  PatchWorkspace workspace;
  std::vector<BoundaryRun> runs;
  std::vector<PairIntegral> patches;
  std::vector<ContactRecord> records;
  const std::vector<BoxPair>& pairs = search_.pairs();
  for (size_t p = 0; p < pairs.size(); ++p) {
    if (!contact_.integrals()[p].touching()) continue;
    const auto [a, b] = pairs[p];
    const Vec2 reference(state_.position[3 * a], state_.position[3 * a + 1]);
    const PairMemory* known = next_pair < memory.pairs.size() &&
                                      memory.pairs[next_pair].pair.first == a &&
                                      memory.pairs[next_pair].pair.second == b
                                  ? &memory.pairs[next_pair++]
                                  : nullptr;
    const PlacedPotential view_a = shapes_.view(a), view_b = shapes_.view(b);
    runs.clear();
    if (view_a.convex() && view_b.convex() && !(known && known->springs > 0)) {
      patches.assign(1, contact_.integrals()[p]);
    } else {
      const Vec2 other(state_.position[3 * b], state_.position[3 * b + 1]);
      contact_patches(view_a, view_b, reference - other, workspace, runs, patches);
    }
    const size_t first = records.size();
    for (const PairIntegral& patch : patches) {
      records.push_back({a, b, reference + loading_point(patch), model_.stiffness() * patch.force,
                         Vec2::Zero(), patch.penetration, patch.largest_phi});
    }
    if (!known) continue;
    for (int i = 0; i < known->patches; ++i) {
      const PatchMemory& patch = memory.patches[next_patch++];
      records[first + i].tangential = patch.spring * patch.tangent + patch.damping;
    }
    for (int i = 0; i < known->springs; ++i) {  // one per run
      records[first + runs[i].patch].tangential +=
          memory.springs[next_spring++].spring * tangent_of(runs[i].force);
    }
  }
  if (surface_) {
    const std::vector<ContactRecord> more = surface_->records();
    records.insert(records.end(), more.begin(), more.end());
  }
  return records;
}

Momenta Simulation::momenta() const {
  return ledger_->momenta(state_, deformables_ ? deformables_->momentum(state_) : Impulse{});
}

std::vector<CauchyStress> Simulation::stresses() const {
  return deformables_ ? deformables_->elements().stresses(state_.displacement)
                      : std::vector<CauchyStress>{};
}

std::vector<CauchyStress> Simulation::stresses(const std::vector<TrackedPoint>& points) const {
  std::vector<CauchyStress> result;
  for (const TrackedPoint& p : points) {
    result.push_back(deformables_->elements().stress(state_.displacement, p.body, p.element));
  }
  return result;
}

const std::vector<double>& Simulation::node_mass() const {
  static const std::vector<double> none;
  return deformables_ ? deformables_->elements().mass() : none;
}

std::vector<BodyForce> Simulation::deformable_forces() const {
  std::vector<BodyForce> forces(model_.deformables.size());
  for (size_t i = 0; surface_ && i < forces.size(); ++i) {
    forces[i] = surface_->on_deformable(static_cast<int>(i));
  }
  return forces;
}

std::vector<SurfaceRecord> Simulation::surfaces() const {
  return surface_ ? surface_->surfaces() : std::vector<SurfaceRecord>{};
}

std::array<double, kPhaseNames.size()> Simulation::phase_seconds() const {
  auto seconds = timed_seconds_;
  for (double& s : seconds) {
    s *= timed_steps_ > 0
             ? static_cast<double>(state_.step - steps_before_) / static_cast<double>(timed_steps_)
             : 0;
  }
  return seconds;
}

}  // namespace apothem
