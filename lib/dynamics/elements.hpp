// The finite elements of all deformable bodies as a term: internal forces, strain energy, damping
// in proportion to the stiffness.
#pragma once

#include <vector>

#include "lib/dynamics/term.hpp"
#include "lib/fem/finite_elements.hpp"
#include "lib/model/model.hpp"

namespace apothem {

class Elements final : public Term {
 public:
  static bool needed(const Model& model) { return !model.deformables.empty(); }
  Elements(const Model& model, int threads);
  /// Before the first step: `dofs` and `state` belong to the masses of these elements.
  void start(const DegreesOfFreedom& dofs, State& state);

  [[nodiscard]] std::string describe() const override;
  /// Sets the forces on the nodes, which nobody has touched before.
  void add_forces(const Evaluation& evaluation) override;
  /// Throws Unstable if an element has turned inside out.
  void watch(const State& state) override;
  void add_energies(const State& state, Energies& energies) override;
  void add_losses(double dt, Energies& energies) const override {
    energies.damping_loss += damping_loss(dt);
  }
  void bound_step(StepBounds& bounds) override;
  bool add_tangent(const State& state, Tangent& tangent) const override;
  void add_stiffness(const State& state, NodeStiffness& stiffness) override;
  void fields(Archive& archive) override {
    archive("summed_damping_loss", summed_damping_loss_)("damping_power", damping_power_);
    archive("first_damping_power", first_damping_power_)("step", step_);
  }

  [[nodiscard]] const FiniteElements& elements() const { return elements_; }

  /// Why elements alone would end a run here: St. Venant-Kirchhoff material that is compressed so
  /// far that it no longer resists. Empty if that has not happened.
  [[nodiscard]] std::string collapse(const State& state) const;

 private:
  [[nodiscard]] double stiffness_damping() const;
  [[nodiscard]] double damping_loss(double dt) const;
  void book_damping(double power, const Evaluation& now);
  [[nodiscard]] Vec2 centre_of(const FiniteElements::Collapse& where) const;
  void find_limit(const DegreesOfFreedom& dofs, const State& state);

  const Model& model_;
  std::vector<double> bulk_damping_;  // of each body, s
  FiniteElements elements_;
  StepLimit limit_;
  // Of an implicit step, where the forces were found last: see Evaluation.
  double span_ = 0;
  std::vector<double> moved_;       // of the nodes, m/s
  double summed_damping_loss_ = 0;  // J
  double damping_power_ = 0;        // at the last step, W
  double first_damping_power_ = 0;  // where steps of velocity Verlet began, W
  double step_ = 0;                 // of the last of them, s
};

}  // namespace apothem
