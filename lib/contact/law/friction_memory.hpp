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

#include <algorithm>
#include <compare>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "lib/archive/archive.hpp"

namespace apothem {

/// Who touches what. Keys ascend within a step.
struct SpringKey {
  int law;   ///< of the kernel whose contact it is: see kernel.hpp
  int a, b;  ///< two surfaces, or an edge and its partner
  int part;  ///< patch of the pair, or edge of its overlap; 0 where a pair has one spring
  auto operator<=>(const SpringKey&) const = default;
  void fields(Archive& archive) { archive("law", law)("a", a)("b", b)("part", part); }
};

struct Spring {
  SpringKey key;
  double force = 0;             ///< along the tangent of its contact, N
  double stiffness = 0;         ///< N/m
  Vec2 tangent = Vec2::Zero();  ///< direction of the force; zero where the law does not need it
  double push = 0;              ///< of the dashpot across it, N

  [[nodiscard]] double energy() const {
    return stiffness > 0 ? force * force / (2 * stiffness) : 0;
  }
  void fields(Archive& archive) {
    archive("key", key)("force", force)("stiffness", stiffness)("tangent", tangent)("push", push);
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
  /// The springs that a pair had in the step before, in the order of their parts; empty if it is
  /// new. Pairs must be asked for in ascending order.
  [[nodiscard]] std::span<const Spring> before(int law, int a, int b);
  /// All springs that a law had in the step before. The next law to be asked for must be a later
  /// one.
  [[nodiscard]] std::span<const Spring> before(int law);
  void add(const PairBook& book) {
    energy_ += book.energy;
    loss_ += book.loss;
    damping_loss_ += book.damping_loss;
  }
  /// Keeps a spring for the next step; in ascending order of the keys.
  void keep(const Spring& spring) {
    now_.push_back(spring);
    energy_ += spring.energy();
    balanced_ += spring.energy();
  }
  /// Keeps springs that store `energy` together, J; in ascending order. What the list holds
  /// afterwards is of no use.
  void keep(std::vector<Spring>& springs, double energy) {
    if (now_.empty()) {
      now_.swap(springs);
    } else {
      now_.insert(now_.end(), springs.begin(), springs.end());
    }
    energy_ += energy;
    balanced_ += energy;
  }
  /// What a spring has lost that is not kept here, J.
  void lose(double energy) { loss_ += energy; }
  /// Closes the step. `work`: what the springs that are kept here have done on the bodies since the
  /// step before, J. What the bodies have lost and the springs do not store is dissipated.
  void end_step(double work);

  [[nodiscard]] std::span<const Spring> springs() const { return now_; }
  /// Those of a law.
  [[nodiscard]] std::span<Spring> springs_of(int law);
  /// Elastic energy of the springs, J.
  [[nodiscard]] double energy() const { return energy_; }
  /// Energy dissipated by friction since the start, J.
  [[nodiscard]] double loss() const { return loss_; }
  /// Energy that contact damping takes from the bodies, J, and its sum since the start.
  void damp(double energy) { damping_loss_ += energy; }
  [[nodiscard]] double damping_loss() const { return damping_loss_; }
  /// Takes over the springs of another simulation, in ascending order of their keys.
  void inherit(std::vector<Spring> springs);
  /// What has been dissipated so far does not count.
  void start_ledger() { loss_ = damping_loss_ = 0; }

  void fields(Archive& archive) {
    archive("springs", now_)("energy", energy_)("balanced_energy", balanced_)(
        "friction_loss", loss_)("damping_loss", damping_loss_);
  }

 private:
  std::vector<Spring> now_, before_;
  size_t next_ = 0;                            // of the springs before
  double energy_ = 0;                          // of all springs, J
  double balanced_ = 0, balanced_before_ = 0;  // of those that are kept here, J
  double loss_ = 0, damping_loss_ = 0;         // J
  struct Sums {
    double energy = 0, balanced = 0, loss = 0, damping_loss = 0;
  };
  Sums sums_before_;  // of the step before
};

}  // namespace apothem
