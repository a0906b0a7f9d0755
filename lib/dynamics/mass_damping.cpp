#include "apothem/dynamics/mass_damping.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apothem/execution/elementary.hpp"
#include "apothem/fem/mass.hpp"

namespace apothem {
namespace {

// Of each node of a body with several materials: its alphas, weighted with the masses of the
// elements around it, 1/s.
std::vector<double> node_rates(const Model& model, const DeformableBody& body) {
  const Mesh& mesh = body.mesh;
  std::vector<double> rate(mesh.nodes.size(), 0), mass(mesh.nodes.size(), 0);
  std::vector<Vec2> corners;
  for (ElementIndex e = 0; e < mesh.element_count(); ++e) {
    const Material& m = model.materials[body.material_of(e)];
    corners.clear();
    for (const int node : mesh.element(e)) corners.push_back(mesh.nodes[node]);
    const std::vector<double> areas = corner_areas(corners);
    for (size_t i = 0; i < areas.size(); ++i) {
      const int node = mesh.element(e)[i];
      rate[node] += m.mass_damping * m.density * areas[i];
      mass[node] += m.density * areas[i];
    }
  }
  for (size_t i = 0; i < rate.size(); ++i) rate[i] /= mass[i];
  return rate;
}

}  // namespace

bool MassDamping::needed(const Model& model) {
  return model.contact.mass_damping > 0 ||
         std::any_of(model.deformables.begin(), model.deformables.end(),
                     [&](const DeformableBody& body) {
                       const std::vector<MaterialIndex> materials = body.materials();
                       return std::any_of(materials.begin(), materials.end(), [&](auto material) {
                         return model.materials[material].mass_damping > 0;
                       });
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
    if (!body.element_material.empty()) {
      const std::vector<double> rates = node_rates(model, body);
      for (NodeIndex i = 0; i < nodes; ++i) {
        const size_t first = layout.node(body.first_node + i);
        add(first, first + 2, rates[i] + model.contact.mass_damping);
      }
      continue;
    }
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
    const double rest = exponential(-group.rate * h);
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
