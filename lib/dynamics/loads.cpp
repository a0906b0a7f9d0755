#include "lib/dynamics/loads.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace apothem {

bool Loads::needed(const Model& model) {
  return std::ranges::any_of(model.deformables, [](const DeformableBody& body) {
    return !body.dead_loads.empty() || !body.pressures.empty();
  });
}

std::string Loads::describe() const {
  size_t forces = 0, pressures = 0;
  for (const DeformableBody& body : model_.deformables) {
    forces += body.dead_loads.size();
    pressures += body.pressures.size();
  }
  return fmt::format("loads: {} by forces, {} by pressures", forces, pressures);
}

void Loads::find(const State& state) {
  forces_.clear();
  for (const DeformableBody& body : model_.deformables) {
    const auto add = [&](int node, const Vec2& force) {
      forces_.push_back({body.first_node + node, force, body.mesh.nodes[node]});
    };
    for (const DeadLoad& load : body.dead_loads) {
      const double factor = load.history.at(state.time);
      for (size_t i = 0; i < load.nodes.size(); ++i) add(load.nodes[i], factor * load.forces[i]);
    }
    for (const PressureLoad& load : body.pressures) {
      const double p = load.pressure * model_.thickness * load.history.at(state.time);
      const auto place = [&](int node) -> Vec2 {
        return body.mesh.nodes[node] + state.node(body.first_node + node);
      };
      for (const auto& [a, b] : load.edges) {
        const Vec2 along = place(b) - place(a);
        const Vec2 half = p / 2 * Vec2(-along.y(), along.x());
        add(a, half);
        add(b, half);
      }
    }
  }
}

void Loads::add_forces(const Evaluation& now) {
  find(now.state);
  add_given_forces(now.state.layout.of_nodes(now.state.f));
  now.clock.lap(Phase::elements);
}

void Loads::add_given_forces(std::span<double> of_nodes) const {
  for (const Force& f : forces_) {
    of_nodes[2 * static_cast<size_t>(f.node)] += f.force.x();
    of_nodes[2 * static_cast<size_t>(f.node) + 1] += f.force.y();
  }
}

// Pressures turn and grow with their edges.
bool Loads::add_tangent(const State& state, Tangent& tangent) const {
  for (const DeformableBody& body : model_.deformables) {
    for (const PressureLoad& load : body.pressures) {
      const double half = load.pressure * model_.thickness * load.history.at(state.time) / 2;
      for (const auto& [a, b] : load.edges) {
        const size_t at_a = state.layout.node(body.first_node + a);
        const size_t at_b = state.layout.node(body.first_node + b);
        for (const size_t on : {at_a, at_b}) {
          tangent.add(on, at_b + 1, half);
          tangent.add(on, at_a + 1, -half);
          tangent.add(on + 1, at_b, -half);
          tangent.add(on + 1, at_a, half);
        }
      }
    }
  }
  return true;
}

void Loads::book(const State& state, double h, Ledger& ledger) {
  for (const Force& f : forces_) {
    ledger.add_work(h * f.force.dot(state.node_velocity(f.node)));
    const Vec2 place = f.start + state.node(f.node);
    ledger.add_impulse({h * f.force.x(), h * f.force.y(), h * cross(place, f.force)});
  }
}

}  // namespace apothem
