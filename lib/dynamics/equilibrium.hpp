// Static scenes: the equilibrium of deformable bodies under the loads of one instant.
#pragma once

#include <functional>
#include <vector>

#include "apothem/dynamics/deformables.hpp"
#include "apothem/dynamics/surface_contact.hpp"

namespace apothem {

/// How the equilibrium of a load step was found.
struct LoadStep {
  double time = 0;              ///< s
  std::int64_t iterations = 0;  ///< steps of dynamic relaxation
  double residual = 0;          ///< norm of the nodal forces out of balance / norm of the loads
  double imbalance = 0;         ///< largest sum of the forces on a body / sum of their sizes
  int worst = -1;               ///< the deformable body it is of
  int restless = -1;            ///< the body with most of the residual
  double load = 0;              ///< sum of the sizes of all loads and reactions on nodes, N
  std::vector<double> off{};    ///< size of the sum of all forces on each deformable body, N
  bool complete = true;         ///< false: stopped on the way
};

/// What a checkpoint needs to continue with the next load step.
struct EquilibriumMemory {
  std::vector<double> outside;     ///< forces at the last equilibrium, N
  double loads = 0;                ///< largest norm so far, N
  std::vector<double> body_loads;  ///< largest sum of sizes so far, N
};

/// Dynamic relaxation. Rigid bodies must be fixed or prescribed.
class Equilibrium {
 public:
  /// `contact` may be null. All must outlive this object.
  Equilibrium(const Model& model, Deformables& deformables, SurfaceContact* contact,
              double tolerance);

  /// Moves loads, supports and prescribed bodies to where they are at `time` and finds the
  /// equilibrium there; books the work of loads and supports (trapezoid rule over the load step).
  /// Not complete if `stop`, asked after each step of relaxation, says so. Then, and where it
  /// throws Unstable because there is no equilibrium in reach, the state is not to be trusted.
  LoadStep find(State& state, double time, const std::function<bool()>& stop);

  [[nodiscard]] EquilibriumMemory memory() const { return {outside_, loads_, body_loads_}; }
  void restore(const EquilibriumMemory& memory);

 private:
  [[nodiscard]] double ramp(double from, double until) const;
  void place(State& state) const;
  void find_forces(State& state);
  void find_masses(const State& state);
  void check_shapes(const State& state) const;
  [[nodiscard]] bool reached(const State& state, LoadStep& result);
  void move(State& state, bool first);

  const Model& model_;
  Deformables& deformables_;
  SurfaceContact* contact_;
  double tolerance_;
  std::vector<double> weight_;             // of each coordinate; empty without gravity
  std::vector<double> element_, surface_;  // stiffness of elements and contacts, N/m
  std::vector<double> mass_, inverse_;     // scaled; inverse 0 where held
  std::vector<double> rest_, last_;        // forces out of balance, and a step before, N
  std::vector<double> drive_, velocity_;   // what accelerates, N; velocity
  std::vector<double> outside_;            // forces at the last equilibrium, N
  std::vector<double> rigid_force_;
  double far_ = 0;                  // m
  double loads_ = 0;                // largest norm so far, N
  std::vector<double> body_loads_;  // largest sum of sizes so far, N
  double kinetic_ = 0;              // at the step before
  int searches_ = -1;
};

}  // namespace apothem
