// Friction of deformable bodies: one elastic slip per boundary edge in contact, both bodies in turn
// being the one that slides on the other's faces (theory: Sec. 5.3).
//
// The slip rate of an edge c against a face a->b is objective,
//   g' = t . (v_c - (1 - s) v_a - s v_b) + (h/L) n . (v_b - v_a),
// its mean is weighted with the pressure, and the nodal forces are the friction force times the
// coefficients of g': they keep linear and angular momentum.
#pragma once

#include <span>
#include <vector>

#include "contact/deformable_contact.hpp"
#include "contact/law.hpp"

namespace apothem {

/// The spring of an edge on another body. Edges of rigid bodies are long: they have one per face of
/// the deformable body, which the face takes with it.
struct EdgeSlip {
  int edge;
  int partner;       ///< the other body; for edges of rigid bodies the face
  double spring;     ///< friction force along the faces, N
  double stiffness;  ///< N/m

  [[nodiscard]] double energy() const {
    return stiffness > 0 ? spring * spring / (2 * stiffness) : 0;
  }
};

/// Everything that friction carries from one step to the next.
struct SlipMemory {
  std::vector<EdgeSlip> slips;  ///< ascending by edge and partner
  double energy = 0;            ///< of the springs, J
  double friction_loss = 0;     ///< J since time 0
};

class DeformableFriction {
 public:
  /// Bodies of the contact, in its order, belong to one of `kinds` kinds; `table` has the friction
  /// between kinds p and q at p kinds + q, and is symmetric.
  DeformableFriction(std::vector<int> kind, int kinds, std::vector<Friction> table)
      : kind_(std::move(kind)), kinds_(kinds), table_(std::move(table)) {}

  /// One step further, after an evaluation of the contact: half-step velocities of all nodes (two
  /// entries each) and rigid bodies (three). With dt = 0 the forces of the memory. Slip that is
  /// spread over more contact keeps its force, and springs of contact that has ended are lost:
  /// friction never adds energy.
  void update(const DeformableContact& contact, std::span<const double> node_velocity,
              std::span<const double> velocity, double dt);

  /// Adds the forces (x and y of each node, N).
  void add_forces(const DeformableContact& contact, std::span<double> node_force) const;
  /// On the vertices of the outlines, N: for DeformableContact::resultant.
  [[nodiscard]] std::span<const double> fx() const { return fx_; }
  [[nodiscard]] std::span<const double> fy() const { return fy_; }
  /// Tangential stiffness of a body's springs, N/m.
  [[nodiscard]] double stiffness(int body) const { return body_stiffness_[body]; }
  /// Tangential traction on each edge by its own springs, along its direction, Pa.
  void tractions(const DeformableContact& contact, std::vector<double>& traction) const;

  [[nodiscard]] const SlipMemory& memory() const { return now_; }
  void restore(const SlipMemory& memory) { now_ = memory; }
  /// What has been lost so far does not count.
  void start_ledger() { now_.friction_loss = 0; }

 private:
  void find_velocities(const DeformableContact& contact, std::span<const double> node_velocity,
                       std::span<const double> velocity);
  [[nodiscard]] const Friction& between(int a, int b) const {
    return table_[static_cast<size_t>(kind_[a]) * kinds_ + kind_[b]];
  }
  [[nodiscard]] double power() const;

  std::vector<int> kind_;
  int kinds_;
  std::vector<Friction> table_;
  SlipMemory now_, before_;
  std::vector<double> vx_, vy_, fx_, fy_;  // of the vertices
  std::vector<double> body_stiffness_;
};

}  // namespace apothem
