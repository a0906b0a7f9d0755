#include "apothem/dynamics/mass_damping.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace apothem {

bool MassDamping::needed(const Model& model) {
  return model.contact.mass_damping > 0 ||
         std::any_of(model.deformables.begin(), model.deformables.end(),
                     [&](const DeformableBody& body) {
                       return model.materials[body.material].mass_damping > 0;
                     });
}

MassDamping::MassDamping(const Model& model, const DegreesOfFreedom& dofs) : dofs_(dofs) {
  const Layout& layout = dofs.layout();
  const auto add = [&](size_t first, size_t end, double rate) {
    if (rate > 0 && first < end) groups_.push_back({first, end, rate});
  };
  add(0, layout.node(0), model.contact.mass_damping);
  for (const DeformableBody& body : model.deformables) {
    const auto nodes = static_cast<NodeIndex>(body.mesh.nodes.size());
    add(layout.node(body.first_node), layout.node(body.first_node + nodes),
        model.materials[body.material].mass_damping + model.contact.mass_damping);
  }
}

std::string MassDamping::describe() const {
  double least = HUGE_VAL, most = 0;
  for (const Group& group : groups_) {
    least = std::min(least, group.rate);
    most = std::max(most, group.rate);
  }
  return least == most ? fmt::format("mass damping, {:g} 1/s", most)
                       : fmt::format("mass damping, {:g} to {:g} 1/s", least, most);
}

void MassDamping::damp(State& state, double h, Ledger& ledger) {
  for (const Group& group : groups_) {
    const double rest = std::exp(-group.rate * h);
    for (size_t c = group.first; c < group.end; ++c) {
      if (!dofs_.can_move(c)) continue;
      double& v = state.v[c];
      const double p = dofs_.mass(c) * v;
      loss_ += p * v / 2 * (1 - rest * rest);
      ledger.add_impulse(dofs_.impulse(state, c, p * (rest - 1)));
      v *= rest;
    }
  }
}

}  // namespace apothem
