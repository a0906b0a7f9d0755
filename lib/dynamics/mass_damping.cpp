#include "lib/dynamics/mass_damping.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "lib/execution/elementary.hpp"
#include "lib/fem/mass.hpp"

namespace apothem {
namespace {

constexpr size_t kPart = 384;      // coordinates of a part: x, y, angle or x, y are not torn apart
constexpr double kDampTime = 1.5;  // of a coordinate, ns

// Of each node of a body with several materials: its alphas, weighted with the masses of the
// elements around it, 1/s.
std::vector<double> node_rates(const Model& model, const DeformableBody& body) {
  const Mesh& mesh = body.mesh;
  std::vector<double> rate(mesh.nodes.size(), 0), mass(mesh.nodes.size(), 0);
  for (ElementIndex e = 0; e < mesh.element_count(); ++e) {
    const Material& m = model.materials[body.material_of(e)];
    const std::vector<double> areas = corner_areas(mesh.places(mesh.element(e)));
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
         std::ranges::any_of(model.deformables, [&](const DeformableBody& body) {
           const std::vector<MaterialIndex> materials = body.materials();
           return std::ranges::any_of(materials, [&](auto material) {
             return model.materials[material].mass_damping > 0;
           });
         });
}

MassDamping::MassDamping(const Model& model, const DegreesOfFreedom& dofs, int threads)
    : dofs_(dofs), threads_(threads) {
  const Layout& layout = dofs.layout();
  const auto add = [&](size_t first, size_t end, double rate) {
    if (!(rate > 0)) return;
    for (; first < end; first += kPart)
      groups_.push_back({first, std::min(first + kPart, end), rate});
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
  size_t coordinates = kPart;
  for (size_t g = 0; g < groups_.size(); ++g) {
    if (coordinates >= kPart) parts_.push_back(g), coordinates = 0;
    coordinates += groups_[g].end - groups_[g].first;
  }
  sums_.resize(parts_.size());
  parts_.push_back(groups_.size());
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
  const auto parts = static_cast<int>(sums_.size());
  threads_.chunks(parts, kPart * kDampTime, [&](int first, int end, int) {
    for (auto part = static_cast<size_t>(first); part < static_cast<size_t>(end); ++part) {
      Sum sum;
      for (size_t g = parts_[part]; g < parts_[part + 1]; ++g) {
        const Group& group = groups_[g];
        const Sum of_group =
            dofs_.brake(state, group.first, group.end, exponential(-group.rate * h));
        sum.energy += of_group.energy;
        sum.impulse.add(of_group.impulse);
      }
      sums_[part] = sum;
    }
  });
  for (const Sum& sum : sums_) {
    loss_ += sum.energy;
    ledger.add_impulse(sum.impulse);
  }
}

}  // namespace apothem
