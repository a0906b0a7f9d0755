// Static scenes: the equilibrium of deformable bodies under the loads of one instant.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "apothem/dynamics/results.hpp"
#include "apothem/dynamics/term.hpp"
#include "apothem/model/model.hpp"

namespace apothem {

/// Dynamic relaxation. Rigid bodies must be fixed or prescribed.
class Equilibrium {
 public:
  using Terms = std::vector<std::unique_ptr<Term>>;
  /// All must outlive this object.
  Equilibrium(const Model& model, const DegreesOfFreedom& dofs, const Terms& terms,
              double tolerance);

  /// Moves loads, supports and prescribed bodies to where they are at `time` and finds the
  /// equilibrium there; books the work of loads and supports (trapezoid rule over the load step).
  /// Not complete, with the state as it was, if `stop`, asked after each step of relaxation, says
  /// so. Throws Unstable if there is no equilibrium in reach; the state is then not to be trusted.
  LoadStep find(State& state, Ledger& ledger, double time, const std::function<bool()>& stop);

  void fields(Archive& archive) {
    archive.sized("outside", outside_);
    archive("loads", loads_);
    archive.sized("body_loads", body_loads_);
  }

 private:
  [[nodiscard]] double ramp(double from, double until) const;
  void find_forces(State& state);
  void find_masses(const State& state);
  [[nodiscard]] std::int64_t revision() const;
  void check_shapes(const State& state) const;
  [[nodiscard]] std::vector<double> given_forces(const State& state) const;
  [[nodiscard]] bool reached(const State& state, LoadStep& result);
  [[nodiscard]] bool body_balanced(const State& state, DeformableIndex body,
                                   const std::vector<double>& outside, LoadStep& result);
  [[noreturn]] void refuse_diverged(const State& state, const std::string& body) const;
  [[noreturn]] void refuse(const State& state, const LoadStep& result) const;
  void move(State& state, bool first);
  /// Of a node's coordinate among the vectors of this object.
  [[nodiscard]] bool held(size_t coordinate) const { return !dofs_.can_move(first_ + coordinate); }

  const Model& model_;
  const DegreesOfFreedom& dofs_;
  const Terms& terms_;
  double tolerance_;
  size_t first_;                // coordinate of the nodes
  double shortest_edge_;        // of the elements, m
  std::vector<double> weight_;  // of each coordinate, N; empty without gravity
  NodeStiffness stiffness_;
  std::vector<double> mass_, inverse_;    // scaled; inverse 0 where held
  std::vector<double> rest_, last_;       // forces out of balance, and a step before, N
  std::vector<double> drive_, velocity_;  // what accelerates, N; velocity
  std::vector<double> outside_;           // forces at the last equilibrium, N
  std::vector<double> lambda_;            // of rigid bodies; not used
  double far_ = 0;                        // m
  double loads_ = 0;                      // largest norm so far, N
  std::vector<double> body_loads_;        // largest sum of sizes so far, N
  double sum_loads_ = 0, sum_residual_ = 0, sum_noise_ = 0, most_ = 0;  // in a look: see reached
  double kinetic_ = 0;                                                  // at the step before
  std::int64_t revision_ = -1;
};

}  // namespace apothem
