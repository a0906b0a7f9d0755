#include <algorithm>

#include "lib/dynamics/contact_term.hpp"
#include "lib/dynamics/simulation.hpp"

namespace apothem {

bool Simulation::linearise(Tangent& tangent, std::vector<double>& out_of_balance) {
  // Nothing moves, so that each friction spring keeps its force.
  const std::vector<double> still(state_.v.size(), 0);
  std::ranges::fill(state_.layout.of_rigid(state_.f), 0.);
  std::ranges::fill(lambda_, 0.);
  for (const auto& term : terms_)
    term->add_forces({state_, still, 1, lambda_, clock_, 0, true, true});
  tangent.clear();
  tangent.let_friction_stick();
  const bool known =
      std::ranges::all_of(terms_, [&](auto& term) { return term->add_tangent(state_, tangent); });
  out_of_balance.assign(state_.f.size(), 0);
  const std::vector<double>& weight = dofs_.weight();
  for (size_t c = 0; c < state_.f.size(); ++c) {
    if (dofs_.can_move(c)) out_of_balance[c] = state_.f[c] + (weight.empty() ? 0 : weight[c]);
  }
  restore_forces();
  return known;
}

}  // namespace apothem
