// A kernel finds the contacts of certain pairs of surfaces and the forces in them. Each kernel has
// its own mathematics; everything around it exists once, in Contacts.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "geometry/spatial/boxes.hpp"
#include "lib/contact/law/contact.hpp"
#include "lib/contact/law/dashpots.hpp"
#include "lib/contact/law/event_impulse.hpp"
#include "lib/contact/law/friction_memory.hpp"
#include "lib/contact/law/kinematics.hpp"
#include "lib/contact/surface/surfaces.hpp"
#include "lib/solver/tangent.hpp"

namespace apothem {

/// Two bodies that overlap more deeply than their potentials reach, so that the forces are not
/// reliable, or an element that is out of the range of its method.
struct ContactFault {
  enum class Kind { singular_area, centre, element, not_convex };
  Kind kind;
  BodyIndex a, b;             ///< the two bodies; a lies in b where that makes a difference
  Vec2 place = Vec2::Zero();  ///< m
  double depth = 0;           ///< m
};

/// A largest value and the two bodies that it belongs to.
struct PairPeak {
  double value = 0;
  BodyIndex a = -1, b = -1;
};

/// Sums and maxima over all contacts of a kernel.
struct ContactSummary {
  int count = 0;
  double deepest = 0;         ///< upper bound of all penetrations, m
  double relative_depth = 0;  ///< largest Contact::relative_depth
  /// Upper bound of the penetration over the inradius of one of the two bodies; HUGE_VAL if it is
  /// not known.
  double inradius_ratio = HUGE_VAL;

  void include(double depth, double inradius, double of_range) {
    ++count;
    deepest = std::max(deepest, depth);
    relative_depth = std::max(relative_depth, of_range);
    inradius_ratio = std::max(inradius_ratio, depth / inradius);
  }
  void include(const ContactSummary& other) {
    count += other.count;
    deepest = std::max(deepest, other.deepest);
    relative_depth = std::max(relative_depth, other.relative_depth);
    inradius_ratio = std::max(inradius_ratio, other.inradius_ratio);
  }
};

using ContactVisitor = std::function<void(const Contact&)>;

class Kernel {
 public:
  virtual ~Kernel() = default;

  /// Sets the pairs that this kernel serves, after a search. A body that may touch itself is a pair
  /// with itself.
  virtual void set_pairs(std::span<const BoxPair> pairs) = 0;
  /// Finds the contacts of all pairs and the normal forces in them. The result has the same bits
  /// for any number of threads. Memory is allocated only if there are more contacts than ever
  /// before.
  virtual void evaluate() = 0;
  /// The summary of all contacts that every step needs.
  [[nodiscard]] virtual ContactSummary summary() const = 0;
  /// Calls visit(contact) for the contacts that may be deeper than `least`, m, in ascending order.
  /// It is too slow for every step.
  virtual void visit_contacts(double least, const ContactVisitor& visit) const = 0;
  /// The penetration of a contact of this kernel, m, or `floor` if the penetration is not larger.
  /// It is the largest distance from the boundary of one body of a point on the boundary of the
  /// other body that lies inside the first one (geometry/integrals/penetration.hpp). It is too slow
  /// for all contacts in every step.
  [[nodiscard]] virtual double penetration(const Contact& contact, double floor) = 0;
  /// Where and why a contact with a relative depth of 1 or more is out of range. Contacts of
  /// outlines never are, because the potential is constant beyond a collar.
  [[nodiscard]] virtual ContactFault fault(const Contact& /*contact*/) const { return {}; }
  /// Updates the friction springs at the end of a step of dt (s), with half-step velocities. With
  /// dt = 0 the springs keep their forces. Returns the work on the bodies since the last call, J,
  /// of those springs whose losses the kernel does not book itself.
  virtual double update_friction(const Kinematics& now, double dt, FrictionMemory& memory) = 0;
  /// Undoes the last friction update. The caller undoes the same step of the memory.
  virtual void undo_friction() {}
  /// Recomputes the friction forces that the next update needs, after the memory has been restored.
  virtual void refresh(const Kinematics& now, FrictionMemory& memory) {
    update_friction(now, 0, memory);
  }
  /// Adds all forces except those of dashpots, the normal forces first.
  virtual void add_forces(const ForceViews& forces) = 0;
  /// Adds the dashpots of the contacts of the last friction update.
  virtual void add_dashpots(const Kinematics& now, Dashpots& dashpots) = 0;
  /// Stores the forces that the dashpots have been found to exert. The dashpots of this kernel
  /// begin at the index `next`, which is advanced to the first one of the next kernel.
  virtual void keep_pushes(const Dashpots& dashpots, size_t& next, FrictionMemory& memory) = 0;
  /// Finds the impulses that velocity Verlet misses because contacts have begun or ended in the
  /// drift of dt (s) that ends now (law/event_impulse.hpp). Returns true if there is one.
  virtual bool find_event_impulses(const Kinematics& /*now*/, const Dynamics& /*dynamics*/,
                                   double /*dt*/, FrictionMemory& /*memory*/) {
    return false;
  }
  /// Adds these impulses divided by dt and multiplied by `scale` to the forces.
  virtual void add_event_impulses(double /*scale*/, const ForceViews& /*forces*/) const {}
  /// The largest normal force of a pair of bodies in the last evaluation, N.
  [[nodiscard]] virtual PairPeak largest_force() const = 0;

  /// Elastic energy of the normal contact, J. It is too slow for every step.
  [[nodiscard]] virtual double energy() const = 0;
  /// Upper bound of the squared frequency w^2 of boundary nodes with these masses in kg (0 where a
  /// support fixes the node), 1/s^2.
  [[nodiscard]] virtual double rate(std::span<const double> /*node_mass*/) const { return 0; }
  /// Adds the same bound as a stiffness to each node near another body, N/m. Each rigid body gets,
  /// for x, y and angle, the sum over the nodes near it, N/m and N m.
  virtual void add_stiffness(std::span<double> /*nodes*/, std::span<double> /*rigid*/) const {}

  /// Adds the derivatives of minus the forces of the last evaluation, whose friction was tried, by
  /// the coordinates: rigid body i has 3 i to 3 i + 2, node j first_node + 2 j and the next one.
  /// Returns false if it does not know them.
  virtual bool add_tangent(size_t /*first_node*/, Tangent& /*tangent*/) const {
    return candidates() == 0;
  }

  [[nodiscard]] virtual size_t candidates() const = 0;
  /// The total contact force on a deformable body, N.
  [[nodiscard]] virtual Vec2 force_on(BodyIndex /*body*/) const { return Vec2::Zero(); }
  /// Adds the magnitudes of the normal forces in the contacts to both bodies, N. Not all kernels
  /// know them.
  virtual void add_force_sizes(std::span<double> /*of_bodies*/) const {}
  /// Appends one record for each contact patch, in ascending order of the pairs of bodies.
  virtual void add_records(std::vector<ContactRecord>& records) const = 0;
  /// Appends one record for each boundary edge of the surfaces.
  virtual void add_surfaces(std::vector<SurfaceRecord>& /*records*/) const {}

  virtual void fields(Archive& /*archive*/) {}
};

/// The kernel that serves a pair of surfaces.
inline constexpr std::array<std::array<KernelKind, 3>, 3> kKernelOf{{
    // polygon         element         outline
    {polygon_kernel, element_kernel, outline_kernel},  // polygon
    {element_kernel, element_kernel, kernel_kinds},    // element
    {outline_kernel, kernel_kinds, outline_kernel},    // outline
}};

inline KernelKind kernel_of(SurfaceKind a, SurfaceKind b) {
  return kKernelOf[static_cast<size_t>(a)][static_cast<size_t>(b)];
}

}  // namespace apothem
