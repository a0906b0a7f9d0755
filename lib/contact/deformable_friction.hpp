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

#include "apothem/contact/deformable_contact.hpp"
#include "apothem/contact/slip.hpp"

namespace apothem {

class DeformableFriction {
 public:
  explicit DeformableFriction(FrictionTable table) : table_(std::move(table)) {}

  /// One step further, after an evaluation of the contact: half-step velocities of all nodes (two
  /// entries each) and rigid bodies (three). With dt = 0 the forces of the memory. Slip that is
  /// spread over more contact keeps its force, and springs of contact that has ended are lost:
  /// friction never adds energy.
  void update(const DeformableContact& contact, std::span<const double> node_velocity,
              std::span<const double> velocity, double dt);

  /// Adds the forces (x and y of each node, N).
  void add_forces(const DeformableContact& contact, std::span<double> node_force) const;
  /// Force on a body, and the moment about the mass centre of a rigid one.
  [[nodiscard]] DeformableContact::Resultant resultant(const DeformableContact& contact,
                                                       int body) const {
    return contact.resultant(body, fx_, fy_);
  }
  /// The sizes of the springs' forces on a body, summed, N.
  [[nodiscard]] double size(const DeformableContact& contact, int body) const;
  /// Adds the friction of each patch of DeformableContact::body_contacts.
  void add_to(const DeformableContact& contact, std::vector<BodyContact>& contacts) const;
  /// Mean tangential traction on each edge, along its direction, Pa.
  void tractions(const DeformableContact& contact, std::vector<double>& traction) const;

  [[nodiscard]] const SlipMemory& memory() const { return now_; }
  void restore(const SlipMemory& memory) { now_ = memory; }

 private:
  void find_velocities(const DeformableContact& contact, std::span<const double> node_velocity,
                       std::span<const double> velocity);
  [[nodiscard]] double power() const;
  template <class Use>
  void each_share(const DeformableContact& contact, Use&& use) const;

  FrictionTable table_;
  SlipMemory now_, before_;
  std::vector<double> vx_, vy_, fx_, fy_;  // of the vertices
};

}  // namespace apothem
