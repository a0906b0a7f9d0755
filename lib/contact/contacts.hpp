// All contact of a scene.
//
//   surfaces -> search -> kernels -> contacts -> friction -> forces
//
// Surfaces move with their bodies; the search finds pairs that are near each other; a table says
// which kernel serves a pair (kernel.hpp); the kernels fill one list of contacts; friction follows
// them with one memory; forces go to the degrees of freedom. A scene has the kernels that its
// surfaces need and no others.
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
#include "lib/contact/surface/search.hpp"
#include "lib/contact/surface/surfaces.hpp"

namespace apothem {

/// The largest penetration of a pair of bodies, m, and the largest ratio of one to the smaller of
/// two lengths that belong to the bodies. They may be of different pairs.
struct Penetrations {
  PairPeak largest, relative;
};

class Contacts {
 public:
  /// `thickness` of the model in m.
  Contacts(const ContactLaw& law, double thickness, Surfaces surfaces, PairTable table,
           int threads);
  Contacts(const Contacts&) = delete;
  Contacts& operator=(const Contacts&) = delete;

  /// Moves all surfaces, or those of bodies that can move. Throws NotFinite.
  void place_all(const Kinematics& now) { surfaces_.place_all(now); }
  void place(const Kinematics& now) { surfaces_.place(now, threads_); }
  /// See Surfaces. Has the next step search anew.
  void set_absent(const std::vector<std::uint8_t>& absent) {
    surfaces_.set_absent(absent);
    forget_search();
  }
  /// Renews the candidates if they do not serve any more; true if it did.
  bool search_if_stale();
  /// Contacts and normal forces where the surfaces are.
  void evaluate();
  /// The first contact out of the range of its method, if there is one.
  [[nodiscard]] std::optional<ContactFault> fault() const;
  /// Friction of a step of dt (s) that ends here, with half-step velocities (Eq. 18: the full-step
  /// ones would pump energy in). With dt = 0 the springs keep their forces.
  void slide(const Kinematics& now, double dt);
  /// The same for a state that is tried: the next slide begins where this one has begun.
  void try_slide(const Kinematics& now, double dt);
  /// Contacts remember what they did before the last slide that was tried.
  void drop_trial();
  /// Has the next refresh() keep the candidates.
  void keep_search() { kept_search_ = search_.places(surfaces_); }
  void add_forces(ForceViews forces);
  /// After the slide, when all other forces of the step of dt (s) are known: adds those of the
  /// dashpots to the forces on every coordinate, N and N m. `first`: nothing has moved since the
  /// last look, and no work is booked.
  void add_dashpots(const Kinematics& now, const Dashpots::Motion& motion, double dt, bool first,
                    std::span<double> forces);

  /// Ascending within a kernel, one kernel after the other. Not for every step.
  [[nodiscard]] std::vector<Contact> contacts() const;
  /// How many there are.
  [[nodiscard]] int count() const;
  /// The bodies of a contact, and of a spring.
  [[nodiscard]] std::pair<BodyIndex, BodyIndex> bodies(const Contact& contact) const;
  [[nodiscard]] std::pair<BodyIndex, BodyIndex> bodies(const ContactKey& key) const;
  [[nodiscard]] const Surfaces& surfaces() const { return surfaces_; }
  [[nodiscard]] const FrictionMemory& friction() const { return memory_; }

  /// True if there is friction or damping.
  [[nodiscard]] bool dissipates() const { return tangential_; }
  [[nodiscard]] bool damped() const { return table_.damped(); }
  /// After the forces at the end of a drift of dt (s): books what friction and damping take on a
  /// path that bends within the step.
  void book_bend(Dynamics dynamics, double dt);
  /// Impulses of contacts that have begun or ended in the drift of dt (s): see Kernel.
  bool find_onsets(const Kinematics& now, Dynamics dynamics, double dt);
  void add_onsets(double scale, const ForceViews& forces) const;

  /// Elastic energy of contacts and springs, J. Not for every step.
  [[nodiscard]] double energy() const;
  [[nodiscard]] double friction_loss() const { return memory_.loss(); }
  [[nodiscard]] double damping_loss() const { return memory_.damping_loss(); }
  /// What has been dissipated so far does not count.
  void start_ledger() { memory_.start_ledger(); }

  [[nodiscard]] std::int64_t searches() const { return searches_; }
  [[nodiscard]] size_t candidates() const;
  /// Of the last step: the largest penetrations of pairs of bodies, to one part in a million, or
  /// `floors` where they are not above these, which is soon found out. `lengths`: of every body, m.
  [[nodiscard]] Penetrations penetrations(std::span<const double> lengths,
                                          const Penetrations& floors = {}) const;
  /// False if no contact is deeper than `floors`, for bodies of no length below `shortest` (m); the
  /// lengths of rigid ones are their inradii. Most steps bring nothing new, and this says so soon.
  [[nodiscard]] bool may_be_deeper(const Penetrations& floors, double shortest) const;
  /// Of the last step: the largest normal force of a pair of bodies, N. That of a body with itself
  /// is none.
  [[nodiscard]] PairPeak largest_force() const;

  /// Bound of w^2 of the boundary nodes of meshes, 1/s^2: see OutlineKernel::rate.
  [[nodiscard]] double node_rate(std::span<const double> node_mass) const;
  void add_stiffness(std::span<double> nodes, std::span<double> rigid) const;
  /// The force on a deformable body, N.
  [[nodiscard]] Vec2 force_on(BodyIndex body) const;
  /// Adds the sizes of the normal forces on each body, N.
  void add_force_sizes(std::span<double> of_bodies) const;
  /// The sizes of the friction forces on each body, summed, N.
  [[nodiscard]] std::vector<double> friction_sizes() const;
  /// One for each contact patch.
  [[nodiscard]] std::vector<ContactRecord> records() const;
  /// The friction springs of all contacts, in ascending order of their keys.
  [[nodiscard]] std::vector<Spring> springs() const {
    return {memory_.springs().begin(), memory_.springs().end()};
  }
  /// The boundary edges that take part in contact with meshes.
  [[nodiscard]] std::vector<SurfaceRecord> surface_records() const;

  /// Has the next step search anew.
  void forget_search();
  /// Finds candidates, contacts and forces again. After keep_search() the candidates are those of
  /// that moment, and after `fields` has been loaded those that its simulation had.
  void refresh(const Kinematics& now);
  void fields(Archive& archive);

  /// The numbers that the memory of contacts goes by.
  [[nodiscard]] ContactNumbers numbers() const;
  /// Takes over the memory of other contacts, by the numbers of these.
  void inherit(const FrictionMemory& memory);

 private:
  void hand_out_pairs();
  // Those that may be deeper than `least`, m.
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
  std::optional<SearchPlaces> kept_search_;  // and not used yet
  std::array<std::unique_ptr<Kernel>, kernel_kinds> kernels_;
  bool tangential_;  // there is friction or damping
  FrictionMemory memory_;
  Dashpots dashpots_;
  // What friction and damping do to rigid bodies, N and N m: now and in the step before.
  std::vector<double> beside_, beside_before_;
  bool tried_ = false;  // the last slide was a trial
  std::int64_t searches_ = 0;
};

/// A vertex of a body that lies farther inside another body than potentials near surfaces reach, so
/// that contact would not feel it. Pairs of rigid bodies are not looked at: their potentials reach
/// to their centres.
struct Buried {
  BodyIndex inner, outer;
  Vec2 place;  ///< m
};
/// Bodies of which `absent` is not 0 are not there; it may be empty.
std::optional<Buried> find_buried(const Outlines& outlines,
                                  const std::vector<std::uint8_t>& absent = {});

}  // namespace apothem
