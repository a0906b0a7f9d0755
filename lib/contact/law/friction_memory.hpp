// The friction springs of all contacts, which friction remembers from one step to the next (the
// paper, Secs. 3 and 5.3), and the ledger of the energy that friction dissipates.
//
// A friction law decides what has a spring: a contact patch, an edge of an overlap, an edge of a
// mesh's boundary, or a pair of elements. The mechanism is the same for all laws: the spring
// follows the slip of a step and is limited by Coulomb's law. The law gives stiffness, slip and
// limit, and distributes the force.
//
// The friction law of rigid bodies computes the loss of each spring, so that a spring that only
// sticks loses exactly nothing, and the energy error of a step shows errors of friction. The laws
// of meshes give the work of all their friction forces: the energy that is taken from the bodies
// and not stored in springs is dissipated.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "geometry/integrals/contact_patches.hpp"
#include "lib/archive/archive.hpp"
#include "lib/contact/law/contact.hpp"
#include "lib/contact/law/contact_history.hpp"
#include "lib/contact/law/pair_vector.hpp"

namespace apothem {

struct Spring {
  ContactKey key;
  double force = 0;             ///< along the tangent of its contact, N
  double stiffness = 0;         ///< N/m
  Vec2 tangent = Vec2::Zero();  ///< direction of the force; zero if the law does not need it
  double push = 0;              ///< force of the dashpot along the normal, N
  /// The force on two rigid bodies and its moments about their mass centres; zero if one of the
  /// bodies deforms.
  PairForce on_bodies = {};

  [[nodiscard]] double energy() const {
    return stiffness > 0 ? force * force / (2 * stiffness) : 0;
  }
  void fields(Archive& archive) {
    archive("key", key)("force", force)("stiffness", stiffness)("tangent", tangent)("push", push);
    if (key.law == polygon_kernel) archive("on_bodies", on_bodies);
  }
};

/// A boundary segment in the overlap of two rigid bodies that touch in several patches. The patches
/// of the next step are matched by these segments. The part of its key is its number in the pair.
struct PatchSegment {
  ContactKey key;
  SegmentPlace place;
  void fields(Archive& archive) {
    archive("key", key)("of_a", place.of_a)("edge", place.edge)("patch", place.patch)(
        "from", place.from)("to", place.to)("length", place.length);
  }
};

/// The energies of a pair, or of a block of pairs, in a step, J. Each block has a ledger of its
/// own, and these are summed in their order, so that the sums do not depend on which thread works
/// on which pairs.
struct PairLedger {
  double energy = 0;        ///< energy stored in its springs
  double loss = 0;          ///< energy lost by its springs
  double damping_loss = 0;  ///< energy that damping has taken from the bodies

  void add(const PairLedger& other) {
    energy += other.energy;
    loss += other.loss;
    damping_loss += other.damping_loss;
  }
};

class FrictionMemory {
 public:
  /// The springs of this step become those of the step before.
  void begin_step();
  /// Undoes the last step with its losses; the step can then be repeated.
  void undo_step();
  /// A walk along the springs that the pairs of a law had in the step before.
  [[nodiscard]] ContactWalk<const Spring> before(int law) const {
    return ContactWalk(records_of_law(springs_.before(), law));
  }
  /// The same walk for the pairs from that of `first` up to, but not including, that of `end`.
  [[nodiscard]] ContactWalk<const Spring> before(const ContactKey& first,
                                                 const ContactKey& end) const {
    return ContactWalk(records_between(springs_.before(), first, end));
  }
  void add(const PairLedger& ledger) {
    energy_ += ledger.energy;
    loss_ += ledger.loss;
    damping_loss_ += ledger.damping_loss;
  }
  /// Stores a spring for the next step. Springs come in ascending order of their keys.
  void keep(const Spring& spring) {
    springs_.keep(spring);
    energy_ += spring.energy();
    balanced_ += spring.energy();
  }
  /// Stores springs, in ascending order, whose total energy is `energy`, J. The content of
  /// `springs` afterwards is unspecified.
  void keep(std::vector<Spring>& springs, double energy) {
    springs_.keep(springs);
    energy_ += energy;
    balanced_ += energy;
  }
  /// Makes room for `springs` springs of a law that books their energies and losses itself. That
  /// law fills them before other laws store theirs.
  std::span<Spring> make_room(size_t springs) { return springs_.make_room(springs); }
  /// Books the loss of a spring that is not stored here, J.
  void lose(double energy) { loss_ += energy; }
  /// Closes the step. `work` is the work on the bodies since the step before, J, of the springs
  /// whose losses no law books. The energy that the bodies have lost and the springs do not store
  /// is dissipated.
  void end_step(double work);

  [[nodiscard]] std::span<Spring> springs() { return springs_.now(); }
  [[nodiscard]] std::span<const Spring> springs() const { return springs_.now(); }
  [[nodiscard]] std::span<const Spring> springs_before() const { return springs_.before(); }
  /// The springs of a law.
  [[nodiscard]] std::span<Spring> springs_of(int law) {
    return records_of_law(springs_.now(), law);
  }
  [[nodiscard]] ContactHistory<PatchSegment>& segments() { return segments_; }
  [[nodiscard]] const ContactHistory<PatchSegment>& segments() const { return segments_; }
  /// Elastic energy of the springs, J.
  [[nodiscard]] double energy() const { return energy_; }
  /// Energy dissipated by friction since the start, J.
  [[nodiscard]] double loss() const { return loss_; }
  /// Books energy that contact damping takes from the bodies, J.
  void damp(double energy) { damping_loss_ += energy; }
  [[nodiscard]] double damping_loss() const { return damping_loss_; }
  /// Replaces the springs and boundary segments, in ascending order of their keys, at a restart.
  void restore(std::vector<Spring> springs, std::vector<PatchSegment> segments);
  /// Takes over the springs and boundary segments of another memory, which has none of these.
  void absorb(const FrictionMemory& other);
  /// Dashpots exert no force any more.
  void forget_pushes() {
    for (Spring& spring : springs_.now()) spring.push = 0;
  }
  /// Sets the dissipated energies to zero.
  void start_ledger() { loss_ = damping_loss_ = 0; }

  void fields(Archive& archive) {
    springs_.fields(archive, "springs");
    segments_.fields(archive, "runs");
    archive("energy", energy_)("balanced_energy", balanced_)("friction_loss", loss_)("damping_loss",
                                                                                     damping_loss_);
  }

 private:
  ContactHistory<Spring> springs_;
  ContactHistory<PatchSegment> segments_;
  double energy_ = 0;                          // energy of all springs, J
  double balanced_ = 0, balanced_before_ = 0;  // energy of the springs whose losses no law books, J
  double loss_ = 0, damping_loss_ = 0;         // J
  struct Sums {
    double energy = 0, balanced = 0, loss = 0, damping_loss = 0;
  };
  Sums sums_before_;  // sums before the last step
};

}  // namespace apothem
