// Given forces and pressures on deformable bodies, as a term.
#pragma once

#include <vector>

#include "lib/dynamics/term.hpp"
#include "lib/model/model.hpp"

namespace apothem {

class Loads final : public Term {
 public:
  static bool needed(const Model& model);
  explicit Loads(const Model& model) : model_(model) {}

  [[nodiscard]] std::string describe() const override;
  [[nodiscard]] bool changes_with_time() const override { return true; }
  void add_forces(const Evaluation& evaluation) override;
  void book(const State& state, double h, Ledger& ledger) override;
  bool add_tangent(const State& state, Tangent& tangent) const override;
  void add_given_forces(std::span<double> of_nodes) const override;
  void refresh(const State& state) override { find(state); }

 private:
  void find(const State& state);

  const Model& model_;
  struct Force {
    NodeIndex node;
    Vec2 force;  // N
    Vec2 start;  // place of the node in the mesh as given, m
  };
  std::vector<Force> forces_;  // at the time of the last evaluation
};

}  // namespace apothem
