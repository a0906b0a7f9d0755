// Friction of deformable bodies that touch by the potentials of their elements (the paper's
// resultant law, Eqs. 10-14, per pair of elements; theory: Sec. 5.3), for comparison with
// DeformableFriction.
//
// One spring per pair of polygons: a number along tangent_of its normal force, which follows the
// relative velocity of the two materials at the action point, SUM N_i v_i, and goes back to the
// corners by the same N_i. It keeps linear and angular momentum, and is lost with its pair: every
// border between elements that slides over another one takes the friction of its neighbours away.
#pragma once

#include <span>
#include <vector>

#include "apothem/contact/element_contact.hpp"
#include "apothem/contact/slip.hpp"

namespace apothem {

class ElementFriction {
 public:
  explicit ElementFriction(FrictionTable table) : table_(std::move(table)) {}

  /// One step further, after an evaluation of the contact: half-step velocities of all nodes (two
  /// entries each) and rigid bodies (three). With dt = 0 the forces of the memory.
  void update(const ElementContact& contact, std::span<const double> node_velocity,
              std::span<const double> velocity, double dt);

  /// Adds the forces (x and y of each node, N).
  void add_forces(const ElementContact& contact, std::span<double> node_force) const;
  /// Force on a body, and the moment about the mass centre of a rigid one (0 for others).
  [[nodiscard]] DeformableContact::Resultant resultant(const ElementContact& /*contact*/,
                                                       int body) const {
    return sums_[body];
  }
  /// The sizes of the springs' forces on a body, summed, N.
  [[nodiscard]] double size(const ElementContact& contact, int body) const;
  /// Adds the friction of each patch of ElementContact::body_contacts.
  void add_to(const ElementContact& contact, std::vector<BodyContact>& contacts) const;
  /// Mean tangential traction on each edge of the surface, along its direction, Pa.
  [[nodiscard]] std::vector<double> tractions(
      const ElementContact& contact, const std::vector<ElementContact::SurfaceEdge>& surface) const;

  [[nodiscard]] const SlipMemory& memory() const { return now_; }
  void restore(const SlipMemory& memory) { now_ = memory; }

 private:
  struct Force {  // at a point relative to the polygon's reference point
    int polygon;
    Vec2 force, point;
  };
  struct NodeForce {
    int node;
    Vec2 force;
  };
  void apply(const ElementContact& contact, const Force& force,
             const ElementContact::Corners& corners);
  [[nodiscard]] double power(const ElementContact& contact, std::span<const double> node_velocity,
                             std::span<const double> velocity) const;

  FrictionTable table_;
  SlipMemory now_, before_;
  std::vector<Force> forces_;  // two per spring
  std::vector<int> touches_;   // of the springs
  std::vector<NodeForce> node_forces_;
  std::vector<DeformableContact::Resultant> sums_;  // of each body
  ElementContact::Corners of_a_, of_b_;
};

}  // namespace apothem
