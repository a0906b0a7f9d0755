// The friction springs of all contacts: what friction remembers from one step to the next (theory:
// Secs. 3 and 5.3), and the ledger of what it dissipates.
//
// A friction law decides what has a spring: a contact patch, an edge of an overlap, an edge of a
// mesh's boundary, or a pair of elements. The mechanism is the same for all of them. The spring
// follows the slip of a step and is clamped by Coulomb's law; the laws give stiffness, slip and
// limit, and distribute the force.
//
// The law of rigid bodies says itself what its springs lose, so that a spring that only sticks
// loses exactly nothing, and the energy error of a step shows what is wrong with friction. The laws
// of meshes give the work of all their friction: what it takes from the bodies and the springs do
// not store is dissipated.
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
  Vec2 tangent = Vec2::Zero();  ///< direction of the force; zero where the law does not need it
  double push = 0;              ///< of the dashpot across it, N
  /// What it does to two rigid bodies, with the moments about their mass centres; zero where one of
  /// the bodies deforms.
  PairForce on_bodies = {};

  [[nodiscard]] double energy() const {
    return stiffness > 0 ? force * force / (2 * stiffness) : 0;
  }
  void fields(Archive& archive) {
    archive("key", key)("force", force)("stiffness", stiffness)("tangent", tangent)("push", push);
    if (key.law == polygon_kernel) archive("on_bodies", on_bodies);
  }
};

/// A run of boundary in the overlap of two rigid bodies that are split into patches, by which their
/// patches are found again. Its part is its number in the pair.
struct PatchRun {
  ContactKey key;
  RunPlace place;
  void fields(Archive& archive) {
    archive("key", key)("of_a", place.of_a)("edge", place.edge)("patch", place.patch)(
        "from", place.from)("to", place.to)("length", place.length);
  }
};

/// What a pair, or a block of pairs, books in a step, J. Blocks have entries of their own, which
/// are summed in their order, so that sums do not depend on who works on which pairs.
struct PairBook {
  double energy = 0;        ///< that its springs store
  double loss = 0;          ///< that its springs have lost
  double damping_loss = 0;  ///< that damping has taken from the bodies

  void add(const PairBook& other) {
    energy += other.energy;
    loss += other.loss;
    damping_loss += other.damping_loss;
  }
};

class FrictionMemory {
 public:
  /// The springs of this step become those of the step before.
  void begin_step();
  /// Takes back the last step, with all that has been lost in it: that step can be made anew.
  void undo_step();
  /// Finds the springs that pairs of a law had in the step before.
  [[nodiscard]] ContactWalk<const Spring> before(int law) const {
    return ContactWalk(records_of_law(springs_.before(), law));
  }
  /// The same for the pairs from `first` on that come before `end`.
  [[nodiscard]] ContactWalk<const Spring> before(const ContactKey& first,
                                                 const ContactKey& end) const {
    return ContactWalk(records_between(springs_.before(), first, end));
  }
  void add(const PairBook& book) {
    energy_ += book.energy;
    loss_ += book.loss;
    damping_loss_ += book.damping_loss;
  }
  /// Keeps a spring for the next step; in ascending order of the keys.
  void keep(const Spring& spring) {
    springs_.keep(spring);
    energy_ += spring.energy();
    balanced_ += spring.energy();
  }
  /// Keeps springs that store `energy` together, J; in ascending order. What the list holds
  /// afterwards is of no use.
  void keep(std::vector<Spring>& springs, double energy) {
    springs_.keep(springs);
    energy_ += energy;
    balanced_ += energy;
  }
  /// Keeps so many springs of a law that books itself what they store and lose; it writes them
  /// before others keep theirs.
  std::span<Spring> make_room(size_t springs) { return springs_.make_room(springs); }
  /// What a spring has lost that is not kept here, J.
  void lose(double energy) { loss_ += energy; }
  /// Closes the step. `work`: what the springs whose losses no law books have done on the bodies
  /// since the step before, J. What the bodies have lost and the springs do not store is
  /// dissipated.
  void end_step(double work);

  [[nodiscard]] std::span<Spring> springs() { return springs_.now(); }
  [[nodiscard]] std::span<const Spring> springs() const { return springs_.now(); }
  [[nodiscard]] std::span<const Spring> springs_before() const { return springs_.before(); }
  /// Those of a law.
  [[nodiscard]] std::span<Spring> springs_of(int law) {
    return records_of_law(springs_.now(), law);
  }
  [[nodiscard]] ContactHistory<PatchRun>& runs() { return runs_; }
  [[nodiscard]] const ContactHistory<PatchRun>& runs() const { return runs_; }
  /// Elastic energy of the springs, J.
  [[nodiscard]] double energy() const { return energy_; }
  /// Energy dissipated by friction since the start, J.
  [[nodiscard]] double loss() const { return loss_; }
  /// Energy that contact damping takes from the bodies, J, and its sum since the start.
  void damp(double energy) { damping_loss_ += energy; }
  [[nodiscard]] double damping_loss() const { return damping_loss_; }
  /// Takes over the springs and runs of another simulation, in ascending order of their keys.
  void inherit(std::vector<Spring> springs, std::vector<PatchRun> runs);
  /// What has been dissipated so far does not count.
  void start_ledger() { loss_ = damping_loss_ = 0; }

  void fields(Archive& archive) {
    springs_.fields(archive, "springs");
    runs_.fields(archive, "runs");
    archive("energy", energy_)("balanced_energy", balanced_)("friction_loss", loss_)("damping_loss",
                                                                                     damping_loss_);
  }

 private:
  ContactHistory<Spring> springs_;
  ContactHistory<PatchRun> runs_;
  double energy_ = 0;                          // of all springs, J
  double balanced_ = 0, balanced_before_ = 0;  // of those whose losses no law books, J
  double loss_ = 0, damping_loss_ = 0;         // J
  struct Sums {
    double energy = 0, balanced = 0, loss = 0, damping_loss = 0;
  };
  Sums sums_before_;  // of the step before
};

}  // namespace apothem
