// Friction and viscous damping of deformable bodies: one elastic slip for each boundary edge in
// contact, both bodies in turn being the one that slides on the other's faces (docs/theory.md,
// Friction).
//
// The slip rate of an edge c against a face a->b is objective,
//   g' = t . (v_c - (1 - s) v_a - s v_b) + (h/L) n . (v_b - v_a),
// its mean is weighted with the pressure, and the nodal forces are the friction force times the
// coefficients of g': they keep linear and angular momentum. A dashpot along t acts beside the
// spring, within Coulomb's limit. Dashpots along n act in two points of each piece of an edge in a
// face, on the edge and on the foot of the point on the face, and never pull.
#pragma once

#include <span>
#include <vector>

#include "apothem/contact/damping_times.hpp"
#include "apothem/contact/edge_face.hpp"
#include "apothem/contact/friction_memory.hpp"
#include "apothem/contact/kinematics.hpp"
#include "apothem/contact/outlines.hpp"
#include "apothem/contact/pair_table.hpp"

namespace apothem {

class OutlineFriction {
 public:
  /// `thickness` in m; `inverse_mass` of each body, 1/kg. All must outlive this object.
  OutlineFriction(const Outlines& outlines, const PairTable& table, double thickness,
                  const std::vector<double>& inverse_mass)
      : outlines_(outlines), table_(table), thickness_(thickness), times_(table, inverse_mass) {}

  /// See Kernel.
  void limit_damping(double rate) { times_.limit(rate); }
  /// After a search: the pairs of bodies that may touch.
  void take(std::span<const BoxPair> pairs) { times_.take(pairs); }

  /// One step further: see Kernel::slide. Slip that is spread over more contact keeps its force,
  /// and springs of contact that has ended are lost: friction never adds energy.
  double slide(const std::vector<EdgeFaceContact>& contacts, const Kinematics& now, double dt,
               FrictionMemory& memory);

  void fields(Archive& archive) {
    if (table_.damped()) archive("damping_x", damping_.x)("damping_y", damping_.y);
  }
  /// Takes back the last slide of a scene without damping.
  void undo_slide() { std::swap(friction_, friction_before_); }

  /// Forces on the vertices of the outlines, N.
  struct VertexForces {
    std::vector<double> x, y;
  };
  [[nodiscard]] const VertexForces& friction() const { return friction_; }
  /// Of all dashpots; none where no pair is damped.
  [[nodiscard]] const VertexForces& damping() const { return damping_; }
  /// The friction force in each contact along its face with the dashpot beside it, and the force of
  /// the dashpots against its face, on the body of the edge, N.
  [[nodiscard]] const std::vector<double>& shares() const { return shares_; }
  [[nodiscard]] const std::vector<double>& pushes() const { return pushes_; }

 private:
  /// Pressure-weighted coefficients of a slip rate: see the implementation.
  struct SlipRate;

  void find_velocities(const Kinematics& now, double dt);
  [[nodiscard]] double power(const VertexForces& forces) const;
  void find_times(const std::vector<EdgeFaceContact>& contacts, double dt);
  void damp_normal(const EdgeFaceContact& contact, double time, double& push);
  [[nodiscard]] SlipRate slip_rate(const EdgeFaceContact& contact, double weight) const;
  void apply(const EdgeFaceContact& contact, double weight, VertexForces& forces) const;

  const Outlines& outlines_;
  const PairTable& table_;
  double thickness_;
  DampingTimes times_;
  std::vector<double> vx_, vy_;  // of the vertices
  VertexForces friction_, friction_before_, damping_;
  std::vector<double> shares_, pushes_;
};

}  // namespace apothem
