// A force of the user's own on rigid bodies and nodes, as a term: an extension in a few lines.
#pragma once

#include <functional>
#include <vector>

#include "lib/dynamics/term.hpp"

namespace apothem {

class AppliedForce final : public Term {
 public:
  /// Adds to `force` (laid out like State::f: N, and N m about mass centres) what acts in `state`.
  /// It must depend on the state alone.
  using Function = std::function<void(const State& state, std::span<double> force)>;

  /// `name`: what it is in words.
  AppliedForce(std::string name, const DegreesOfFreedom& dofs, Function function);

  [[nodiscard]] std::string describe() const override { return name_; }
  [[nodiscard]] bool changes_with_time() const override { return true; }
  void add_forces(const Evaluation& evaluation) override;
  /// The ledger counts its work as external.
  void book(const State& state, double h, Ledger& ledger) override;
  void add_given_forces(std::span<double> of_nodes) const override;
  void refresh(const State& state) override { find(state); }

 private:
  void find(const State& state);

  std::string name_;
  const DegreesOfFreedom& dofs_;
  Function function_;
  std::vector<double> force_;  // of the last evaluation
};

}  // namespace apothem
