// Damping in proportion to the mass, C = alpha M.
#pragma once

#include <vector>

#include "apothem/dynamics/term.hpp"
#include "apothem/model/model.hpp"

namespace apothem {

class MassDamping final : public Term {
 public:
  static bool needed(const Model& model);
  MassDamping(const Model& model, const DegreesOfFreedom& dofs);

  [[nodiscard]] std::string describe() const override;
  /// v' = -alpha v solved exactly over h, so that any alpha is stable.
  void damp(State& state, double h, Ledger& ledger) override;
  void add_energies(const State& /*state*/, double /*dt*/, Energies& e) override {
    e.damping_loss += loss_;
  }
  void start_ledger() override { loss_ = 0; }
  void fields(Archive& archive) override { archive("mass_damping_loss", loss_); }

 private:
  struct Group {
    size_t first, end;  // coordinates
    double rate;        // alpha, 1/s
  };
  const DegreesOfFreedom& dofs_;
  std::vector<Group> groups_;
  double loss_ = 0;  // J
};

}  // namespace apothem
