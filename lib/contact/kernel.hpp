// A kernel finds the contacts of some pairs of surfaces and the forces in them. Kernels keep their
// own mathematics; what surrounds them exists once, in Contacts.
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
#include "lib/contact/law/friction_memory.hpp"
#include "lib/contact/law/kinematics.hpp"
#include "lib/contact/law/onset_rule.hpp"
#include "lib/contact/surface/surfaces.hpp"

namespace apothem {

/// Two bodies that are deeper in each other than their potentials reach, so that the forces are not
/// to be trusted, or an element out of the range of its method.
struct ContactFault {
  enum class Kind { singular_area, centre, element, not_convex };
  Kind kind;
  BodyIndex a, b;             ///< a is in b where that makes a difference
  Vec2 place = Vec2::Zero();  ///< m
  double depth = 0;           ///< m
};

/// A largest value and the two bodies it is of.
struct PairPeak {
  double value = 0;
  BodyIndex a = -1, b = -1;
};

/// Of all contacts of a kernel.
struct ContactSummary {
  int count = 0;
  double deepest = 0;  ///< none is deeper, m
  double share = 0;    ///< largest: see Contact
  /// None is deeper than so many inradii of one of its bodies; HUGE_VAL if that is not known.
  double relative = HUGE_VAL;

  void include(double depth, double inradius, double of_range) {
    ++count;
    deepest = std::max(deepest, depth);
    share = std::max(share, of_range);
    relative = std::max(relative, depth / inradius);
  }
  void include(const ContactSummary& other) {
    count += other.count;
    deepest = std::max(deepest, other.deepest);
    share = std::max(share, other.share);
    relative = std::max(relative, other.relative);
  }
};

using ContactVisitor = std::function<void(const Contact&)>;

class Kernel {
 public:
  virtual ~Kernel() = default;

  /// After a search: the pairs that this kernel serves. A body that touches itself is a pair with
  /// itself.
  virtual void take(std::span<const BoxPair> pairs) = 0;
  /// Finds the contacts of its pairs and the normal forces in them. The same bits for any number of
  /// threads. No allocation unless there are more contacts than ever before.
  virtual void evaluate() = 0;
  /// What a step asks of them.
  [[nodiscard]] virtual ContactSummary summary() const = 0;
  /// Shows those that may be deeper than `least`, m, in ascending order. Not for every step.
  virtual void visit_contacts(double least, const ContactVisitor& visit) const = 0;
  /// The penetration of one of its contacts, m; `floor` if it is not larger than that. It is the
  /// largest distance from the boundary of one body of a point on the boundary of the other one
  /// that lies inside it (geometry/integrals/penetration.hpp). Not for every contact and step.
  [[nodiscard]] virtual double penetration(const Contact& contact, double floor) = 0;
  /// Where and why one of its contacts, with a share of 1 or more, is out of range. Outlines have
  /// no such contacts: beyond a collar the potential is constant.
  [[nodiscard]] virtual ContactFault fault(const Contact& /*contact*/) const { return {}; }
  /// Friction of a step of dt (s) that ends here, with half-step velocities. With dt = 0 the
  /// springs keep their forces. Returns the work on the bodies since the last call, J, of springs
  /// whose losses it does not book itself.
  virtual double slide(const Kinematics& now, double dt, FrictionMemory& memory) = 0;
  /// Takes back the last slide, whose step the memory takes back.
  virtual void undo_slide() {}
  /// After the memory has been restored: finds the forces of friction again that the next slide
  /// needs.
  virtual void refresh(const Kinematics& now, FrictionMemory& memory) { slide(now, 0, memory); }
  /// Adds all forces but those of dashpots, normal ones first.
  virtual void add_forces(const ForceViews& forces) = 0;
  /// After a slide: the dashpots of its contacts.
  virtual void add_dashpots(const Kinematics& now, Dashpots& to) = 0;
  /// Takes note of what these have been found to do; they begin at the number `next`, which goes on
  /// to the first one of the next kernel.
  virtual void keep_pushes(const Dashpots& from, size_t& next, FrictionMemory& memory) = 0;
  /// At the end of a drift of dt (s): finds the impulses that contacts lack that have begun or
  /// ended in it (onset.hpp); true if there is one.
  virtual bool find_onsets(const Kinematics& /*now*/, const Dynamics& /*dynamics*/, double /*dt*/,
                           FrictionMemory& /*memory*/) {
    return false;
  }
  /// Adds these impulses over dt, times `scale`, to the forces.
  virtual void add_onsets(double /*scale*/, const ForceViews& /*forces*/) const {}
  /// Of the last call: the largest normal force of a pair of bodies, N.
  [[nodiscard]] virtual PairPeak largest_force() const = 0;

  /// Elastic energy of the normal contact, J. Not for every step.
  [[nodiscard]] virtual double energy() const = 0;
  /// Bound of w^2 of boundary nodes of these masses in kg (0 where held), 1/s^2.
  [[nodiscard]] virtual double rate(std::span<const double> /*node_mass*/) const { return 0; }
  /// Adds to each node near another body the same bound as a stiffness, N/m, and to x, y and angle
  /// of each rigid body what nodes near it have, N/m and N m.
  virtual void add_stiffness(std::span<double> /*nodes*/, std::span<double> /*rigid*/) const {}

  [[nodiscard]] virtual size_t candidates() const = 0;
  /// The force on a deformable body, N.
  [[nodiscard]] virtual Vec2 force_on(BodyIndex /*body*/) const { return Vec2::Zero(); }
  /// Adds the sizes of the normal forces in its contacts to both bodies, N. Not known to all
  /// kernels.
  virtual void add_force_sizes(std::span<double> /*of_bodies*/) const {}
  /// Appends one record for each contact patch; ascending pairs of bodies.
  virtual void add_records(std::vector<ContactRecord>& records) const = 0;
  /// Appends the boundary edges of its surfaces.
  virtual void add_surfaces(std::vector<SurfaceRecord>& /*records*/) const {}

  virtual void fields(Archive& /*archive*/) {}
};

/// Which kernel serves a pair of surfaces.
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
