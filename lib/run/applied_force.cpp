#include "lib/run/applied_force.hpp"

#include <algorithm>

namespace apothem {

AppliedForce::AppliedForce(std::string name, const DegreesOfFreedom& dofs, Function function)
    : name_(std::move(name)),
      dofs_(dofs),
      function_(std::move(function)),
      force_(dofs.layout().size()) {}

void AppliedForce::find(const State& state) {
  std::ranges::fill(force_, 0.);
  function_(state, force_);
}

void AppliedForce::add_forces(const Evaluation& now) {
  find(now.state);
  for (size_t c = 0; c < force_.size(); ++c) now.state.f[c] += force_[c];
}

void AppliedForce::book(const State& state, double h, Ledger& ledger) {
  for (size_t c = 0; c < force_.size(); ++c) {
    if (force_[c] == 0) continue;
    ledger.add_impulse(dofs_.impulse(state, c, h * force_[c]));
    ledger.add_work(h * force_[c] * state.v[c]);
  }
}

void AppliedForce::add_given_forces(std::span<double> of_nodes) const {
  const size_t first = force_.size() - of_nodes.size();
  for (size_t c = 0; c < of_nodes.size(); ++c) of_nodes[c] += force_[first + c];
}

}  // namespace apothem
