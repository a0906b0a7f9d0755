// Gravity whose strength or direction follows histories, as a term. Scenes with constant gravity
// have none: the degrees of freedom know it.
//
// The energy of gravity is that of the places of all bodies in gravity as it is now. Where it
// changes, this energy changes at the same places: that is work from outside.
#pragma once

#include "lib/dynamics/degrees_of_freedom.hpp"
#include "lib/dynamics/term.hpp"

namespace apothem {

class GravityHistory final : public Term {
 public:
  static bool needed(const Model& model);
  /// Both must outlive this object.
  GravityHistory(const Model& model, DegreesOfFreedom& dofs) : model_(model), dofs_(dofs) {}

  [[nodiscard]] std::string describe() const override;
  [[nodiscard]] bool changes_with_time() const override { return true; }
  /// Brings gravity to the time of the state; it is no part of the forces.
  void add_forces(const Evaluation& evaluation) override;
  void add_energies(const State& /*state*/, Energies& e) override { e.external_work += work_; }
  void start_ledger() override { work_ = 0; }
  void fields(Archive& archive) override { archive("work", work_); }
  void refresh(const State& state) override;

 private:
  void set(double time);

  const Model& model_;
  DegreesOfFreedom& dofs_;
  double work_ = 0;  // J
  // At the last evaluation that was not a trial: the factor, and the energy at factor 1, J.
  double factor_ = 0, energy_ = 0;
  // Where gravity has parts: its value, m/s^2, and mass times displacement, kg m.
  Vec2 value_ = Vec2::Zero(), moved_ = Vec2::Zero();
};

}  // namespace apothem
