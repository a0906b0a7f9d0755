// Damping in proportion to the mass, C = alpha M.
#pragma once

#include <vector>

#include "lib/dynamics/term.hpp"
#include "lib/execution/parallel.hpp"
#include "lib/model/model.hpp"

namespace apothem {

class MassDamping final : public Term {
 public:
  static bool needed(const Model& model);
  MassDamping(const Model& model, const DegreesOfFreedom& dofs, int threads = 1);

  [[nodiscard]] std::string describe() const override;
  /// v' = -alpha v solved exactly over h, so that any alpha is stable.
  void damp(State& state, double h, Ledger& ledger) override;
  void add_losses(double /*dt*/, Energies& e) const override { e.damping_loss += loss_; }
  void start_ledger() override { loss_ = 0; }
  void fields(Archive& archive) override { archive("mass_damping_loss", loss_); }

 private:
  struct Group {
    size_t first, end;  // coordinates
    double rate;        // alpha, 1/s
  };
  using Sum = DegreesOfFreedom::Braked;  // of a part of the groups

  const DegreesOfFreedom& dofs_;
  Threads threads_;
  std::vector<Group> groups_;  // none of them long, so that threads have equal shares
  // Groups that are worked on together: where each part begins, and where the last one ends. They
  // do not depend on the number of threads, nor do the sums over them.
  std::vector<size_t> parts_;
  std::vector<Sum> sums_;
  double loss_ = 0;  // J
};

}  // namespace apothem
