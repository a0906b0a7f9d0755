// All contact of a scene.
//
//   surfaces -> search -> kernels -> contacts -> friction -> forces
//
// Surfaces move with their bodies. The search finds pairs of surfaces that are near each other. A
// table says which kernel serves a pair (kernel.hpp). The kernels fill one list of contacts.
// Friction follows the contacts with one memory, and the forces go to the degrees of freedom. A
// scene has only those kernels that its surfaces need.
#pragma once

#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include "lib/contact/contact_memory.hpp"
#include "lib/contact/kernel.hpp"
#include "lib/contact/law/friction_memory.hpp"
#include "lib/contact/law/law.hpp"
#include "lib/contact/law/pair_table.hpp"
#include "lib/contact/resting_contacts.hpp"
#include "lib/contact/surface/search.hpp"
#include "lib/contact/surface/surfaces.hpp"

namespace apothem {

/// The largest penetration of a pair of bodies, m, and the largest ratio of a penetration to the
/// smaller of the lengths of its two bodies. The two maxima may belong to different pairs.
struct Penetrations {
  PairPeak largest, relative;
};

class Contacts {
 public:
  /// `thickness` is that of the model, m.
  Contacts(const ContactLaw& law, double thickness, Surfaces surfaces, PairTable table,
           int threads);
  Contacts(const Contacts&) = delete;
  Contacts& operator=(const Contacts&) = delete;

  /// place_all moves all surfaces; place moves only those of bodies that can move. Both throw
  /// NotFinite.
  void place_all(const Kinematics& now) { surfaces_.place_all(now); }
  void place(const Kinematics& now) { surfaces_.place(now, threads_); }
  /// Marks bodies as absent (see Surfaces::set_absent) and forces a new search in the next step.
  void set_absent(const std::vector<std::uint8_t>& absent) {
    surfaces_.set_absent(absent);
    forget_search();
  }
  /// Makes it possible that rigid bodies rest. The arguments are those of the constructor.
  void let_bodies_rest(const ContactLaw& law, double thickness);
  /// The rigid bodies with a nonzero entry rest from now on: they stay where they are, and contacts
  /// in which nothing can move stay as they are. The bodies must be where the surfaces are.
  void set_resting(const std::vector<std::uint8_t>& resting, const Kinematics& now);
  /// Marks resting bodies before refresh(), after `fields` has loaded a checkpoint.
  void restore_resting(const std::vector<std::uint8_t>& resting) { surfaces_.set_resting(resting); }
  /// True if, in the last search, a body that can move was near one that rests.
  [[nodiscard]] bool disturbs_rest() const { return disturbs_rest_; }
  /// All pairs of surfaces that were near each other in the last search.
  [[nodiscard]] std::span<const BoxPair> near() const { return search_.near(); }
  /// Searches for candidate pairs if those of the last search are no longer valid. Returns true if
  /// it did.
  bool search_if_stale();
  /// Finds the contacts and their normal forces at the present positions of the surfaces.
  void evaluate();
  /// The first contact that is out of the range of its method, if there is one.
  [[nodiscard]] std::optional<ContactFault> fault() const;
  /// Updates the friction springs at the end of a step of dt (s). `now` must hold the half-step
  /// velocities (Eq. 18), because full-step velocities would add energy. With dt = 0 the springs
  /// keep their forces.
  void update_friction(const Kinematics& now, double dt);
  /// Updates the friction springs for a trial state. The next update starts from the same springs
  /// as this one did.
  void try_friction(const Kinematics& now, double dt);
  /// Discards the last trial update of the friction springs.
  void drop_trial();
  /// The last trial update becomes what the contacts remember.
  void keep_trial() { tried_ = false; }
  /// Makes the next refresh() keep the present candidates.
  void keep_search() { kept_search_ = search_.places(surfaces_); }
  void add_forces(ForceViews forces);
  /// Adds the dashpot forces on all coordinates, N and N m. It must be called after the friction
  /// update, when all other forces of the step of dt (s) are known. `first` means that nothing has
  /// moved since the last evaluation, so that no work is booked.
  void add_dashpots(const Kinematics& now, const Dashpots::Motion& motion, double dt, bool first,
                    std::span<double> forces);
  /// The same where dashpots do not act: they exert no force.
  void silence_dashpots(const Kinematics& now);

  /// All contacts, kernel by kernel, in ascending order within each kernel. It is too slow for
  /// every step.
  [[nodiscard]] std::vector<Contact> contacts() const;
  /// The number of contacts.
  [[nodiscard]] int count() const;
  /// The two bodies of a contact, and those of the friction spring with a key.
  [[nodiscard]] std::pair<BodyIndex, BodyIndex> bodies(const Contact& contact) const;
  [[nodiscard]] std::pair<BodyIndex, BodyIndex> bodies(const ContactKey& key) const;
  [[nodiscard]] const Surfaces& surfaces() const { return surfaces_; }
  /// Without the contacts of bodies that rest.
  [[nodiscard]] const FrictionMemory& friction() const { return memory_; }

  /// True if there is friction or damping.
  [[nodiscard]] bool dissipates() const { return tangential_; }
  [[nodiscard]] bool damped() const { return table_.damped(); }
  [[nodiscard]] const PairTable& table() const { return table_; }
  /// Adds to the ledger what friction and damping take because the path of a step is curved. It
  /// must be called after the forces at the end of a drift of dt (s) are known.
  void add_bend_losses(Dynamics dynamics, double dt);
  /// Finds and adds the impulses of contact events in the drift of dt (s), see Kernel.
  bool find_event_impulses(const Kinematics& now, Dynamics dynamics, double dt);
  void add_event_impulses(double scale, const ForceViews& forces) const;

  /// Elastic energy of contacts and friction springs, J. It is too slow for every step.
  [[nodiscard]] double energy() const;
  [[nodiscard]] double friction_loss() const { return memory_.loss(); }
  [[nodiscard]] double damping_loss() const { return memory_.damping_loss(); }
  /// Sets the dissipated energies to zero.
  void start_ledger() { memory_.start_ledger(); }

  [[nodiscard]] std::int64_t searches() const { return searches_; }
  [[nodiscard]] size_t candidates() const;
  /// The largest penetrations of pairs of bodies in the last step, accurate to one part in a
  /// million, or `floors` where no pair exceeds them. `lengths` has one length per body, m.
  [[nodiscard]] Penetrations penetrations(std::span<const double> lengths,
                                          const Penetrations& floors = {}) const;
  /// A quick test that is false if no contact is deeper than `floors`, for bodies whose lengths are
  /// at least `shortest` (m). The length of a rigid body must be its inradius. Most steps bring no
  /// new maximum.
  [[nodiscard]] bool may_be_deeper(const Penetrations& floors, double shortest) const;
  /// The largest normal force between two different bodies in the last step, N.
  [[nodiscard]] PairPeak largest_force() const;

  /// Upper bound of the squared frequency w^2 of the boundary nodes of meshes, 1/s^2, see
  /// OutlineKernel::rate.
  [[nodiscard]] double node_rate(std::span<const double> node_mass) const;
  void add_stiffness(std::span<double> nodes, std::span<double> rigid) const;
  /// See Kernel::add_tangent.
  bool add_tangent(size_t first_node, Tangent& tangent) const {
    return std::ranges::all_of(kernels_, [&](const auto& kernel) {
      return !kernel || kernel->add_tangent(first_node, tangent);
    });
  }
  /// The total contact force on a deformable body, N.
  [[nodiscard]] Vec2 force_on(BodyIndex body) const;
  /// Adds the magnitudes of the normal forces on each body, N.
  void add_force_sizes(std::span<double> of_bodies) const;
  /// The sum of the magnitudes of the friction forces on each body, N.
  [[nodiscard]] std::vector<double> friction_sizes() const;
  /// One record for each contact patch.
  [[nodiscard]] std::vector<ContactRecord> records() const;
  /// The friction springs of all contacts, in ascending order of their keys.
  [[nodiscard]] std::vector<Spring> springs() const;
  /// The boundary edges that take part in contact with meshes.
  [[nodiscard]] std::vector<SurfaceRecord> surface_records() const;

  /// Forces a new search in the next step.
  void forget_search();
  /// Finds candidates, contacts and forces again for a state that was set from outside. After
  /// keep_search() the candidates are those of that moment. After `fields` has loaded a checkpoint,
  /// they are those of the simulation that wrote it.
  void refresh(const Kinematics& now);
  void fields(Archive& archive);

  /// The numbers that the keys of the friction memory refer to.
  [[nodiscard]] ContactNumbers numbers() const;
  /// Replaces the friction memory. Its keys must refer to the numbers of these contacts.
  void set_memory(const FrictionMemory& memory);

 private:
  void hand_out_pairs();
  [[nodiscard]] bool is_between_rest_and_motion(const BoxPair& pair) const;
  // Calls show(contact) for the contacts that may be deeper than `least`, m.
  void visit(double least, const ContactVisitor& show) const;
  template <class F>
  void each(F&& f) const {
    for (const auto& kernel : kernels_) {
      if (kernel) f(*kernel);
    }
  }
  template <class T, class F>
  [[nodiscard]] T sum(F&& f) const {
    T all{};
    each([&](const Kernel& kernel) { all += f(kernel); });
    return all;
  }

  Threads threads_;
  Surfaces surfaces_;
  PairTable table_;
  FrictionLaw friction_law_;
  Search search_;
  bool disturbs_rest_ = false;
  std::optional<SearchPlaces> kept_search_;  // places that the next refresh() searches at
  std::array<std::unique_ptr<Kernel>, kernel_kinds> kernels_;
  std::unique_ptr<RestingContacts> resting_;  // null if bodies cannot rest
  bool tangential_;                           // true if there is friction or damping
  FrictionMemory memory_;
  Dashpots dashpots_;
  // Forces of friction and damping on rigid bodies, N and N m, in this step and in the step before.
  std::vector<double> beside_, beside_before_;
  bool tried_ = false;  // true if the last friction update was a trial
  std::int64_t searches_ = 0;
};

/// A body that is engulfed by another one: one of its vertices lies deeper inside the other body
/// than the potentials near the surface reach, so that contact would not feel it. Pairs of rigid
/// bodies are not checked, because their potentials reach to the centre.
struct EngulfedBody {
  BodyIndex inner, outer;
  Vec2 place;  ///< m
};
/// Finds an engulfed body. Bodies with a nonzero entry in `absent` are ignored; `absent` may be
/// empty.
std::optional<EngulfedBody> find_engulfed(const OutlineSurfaces& outlines,
                                          const std::vector<std::uint8_t>& absent = {});

}  // namespace apothem
