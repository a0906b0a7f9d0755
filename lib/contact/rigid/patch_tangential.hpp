// Friction between polygons of rigid bodies, by contact patches (docs/theory.md, Friction). Only
// scenes that ask for it have this.
//
//   resultant   one spring for each patch, at right angles to its normal force (Eqs. 10-14)
//   per_edge    one spring for each edge of the overlap (Eq. 9), the older law, for comparison
//
// What a pair remembers is kept in its slot (pair_integrals.hpp) and renewed there. The patches of
// pairs that are split are lists, which are made anew in every step.
#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "geometry/integrals/contact_patches.hpp"
#include "lib/contact/law/contact.hpp"
#include "lib/contact/law/friction_memory.hpp"
#include "lib/contact/law/law.hpp"
#include "lib/contact/law/pair_table.hpp"
#include "lib/contact/rigid/pair_batch.hpp"
#include "lib/contact/rigid/pair_integrals.hpp"
#include "lib/execution/parallel.hpp"

namespace apothem {

class PatchTangential {
 public:
  /// What a pair had in a step. The lists of runs and springs follow in the order of the
  /// pairs.
  struct PairHistory {
    RigidIndex a, b;
    int patches, runs;
    PairForce force;  // friction; moments about the mass centres
    void fields(Archive& archive) {
      archive("a", a)("b", b)("patches", patches)("runs", runs)("force", force);
    }
  };
  /// What all pairs remember, for archives and for other simulations.
  struct History {
    std::vector<PairHistory> pairs;  ///< ascending
    std::vector<RunPlace> runs;      ///< of pairs that are not both convex, or of per_edge
    std::vector<Spring> springs;     ///< ascending
    void fields(Archive& archive);
  };

  /// `thickness` in m. All must outlive this object.
  PatchTangential(const Surfaces& surfaces, const PairIntegrals& pairs, const ContactLaw& law,
                  const PairTable& table, double thickness, int threads);

  /// After a search: slots have another order.
  void put_in_order(SlotOrder& order);
  /// Begins a step of dt (s): see Kernel::slide. Pairs that have ended can be forgotten then. `now`
  /// is used until the step ends.
  void begin_step(const Kinematics& now, double dt, FrictionMemory& memory);
  /// Takes the touching pairs from number `first` to `end`, which are blocks of kBlock pairs, one
  /// step further, and hands the loads of each block to take(loads).
  template <class Take>
  void step(int first, int end, int worker, const Take& take);
  /// Books what friction has lost.
  void end_step(FrictionMemory& memory);

  /// undo_step() comes back to what pairs remember now.
  void remember() { kept_ = inherited_ ? *inherited_ : history(); }
  void undo_step() { inherited_ = kept_; }

  /// The friction of a pair that has one patch; of others it is not known.
  struct Alone {
    bool known = false;
    PairForce friction = {};
    void fields(Archive& archive) { archive("known", known)("friction", friction); }
  };
  [[nodiscard]] Alone alone(const PairInTouch& pair) const {
    const PairMemory& memory = memory_[static_cast<size_t>(pair.slot)];
    if (memory.patches != 1) return {};
    return {true, memory.force};
  }
  /// Force of the spring in a patch, N.
  [[nodiscard]] double spring_in(const PairInTouch& pair, size_t patch) const;
  /// The dashpot there pushes so much, N, which the next step has to know.
  void keep_push(const PairInTouch& pair, size_t patch, double push);

  /// Adds friction to the records of a pair, one for each patch. `runs`: of the pair, needed by the
  /// law per_edge.
  void add_to(std::span<ContactRecord> patches, std::span<const BoundaryRun> runs,
              const PairInTouch& pair) const;
  /// Appends the springs of all pairs, ascending.
  void add_springs(std::vector<Spring>& springs) const;

  /// Takes over what pairs have remembered before, or in another simulation: the next step begins
  /// with it.
  void inherit(History history) { inherited_ = std::move(history); }
  /// Has the touching pairs do so now; false if there is nothing to take over.
  bool adopt();
  void fields(Archive& archive);

  /// Pairs whose sums are booked together, so that they do not depend on the number of threads.
  static constexpr int kBlock = 32;

 private:
  // What a pair has in the lists.
  struct Place {
    int runs = 0, first_run = 0;
    int springs = 0, first_spring = 0;
  };
  // Of pairs that are split. The spring of an only patch is in the slot of its pair.
  struct Lists {
    std::vector<Place> places;
    std::vector<RunPlace> runs;
    std::vector<Spring> springs;

    void clear() { places.clear(), runs.clear(), springs.clear(); }
    [[nodiscard]] std::span<const RunPlace> runs_of(const PairMemory& pair) const;
    [[nodiscard]] std::span<const Spring> springs_of(const PairMemory& pair) const;
  };
  // What a pair takes over.
  struct Inherited {
    const PairHistory& old;
    std::span<const RunPlace> runs = {};
    std::span<const Spring> springs = {};
  };
  // A pair of another state that does not touch in this one.
  struct Left {
    RigidIndex a, b;
    PairForce force;
    double energy;  // of its springs, J
  };

  // The pairs that one thread takes a step further.
  class Range {
   public:
    explicit Range(PatchTangential& all) : all_(all) {}

    void step_block(int first, int end, PairBook& book);

    std::vector<PairLoad> loads;         // of the block
    std::vector<Spring> springs_before;  // of the pair at hand

   private:
    // What the patches of a pair add up to.
    struct Sum {
      PairRate rate;
      PairForce force = {};
      BodyStiffness held_a = {}, held_b = {};  // by its friction springs
    };
    void step_pair(const PairInTouch& touching, PairLoad& load, PairBook& book);
    void step_patches(const PairInTouch& touching, const PairWork& pair, const Place& to);
    void step_springs(const PairWork& pair, const Place& to, Sum& sum);
    void find_shares();
    void inherit();
    [[nodiscard]] double lost_by_balance(const PairWork& pair, const Sum& sum) const;
    void per_edge(const PairWork& pair, std::span<const BoundaryRun> runs, const Place& to,
                  Sum& sum);

    PatchTangential& all_;
    PairBatch batch_;
    std::vector<PairBook> books_;  // of the pairs of the block
    // Of the pair at hand.
    std::span<const RunPlace> runs_;
    std::span<const PairIntegral> patches_;
    PairMemory before_;
    size_t ancestors_ = 0;
    std::vector<double> shares_;  // of each ancestor that goes to each patch of now
    std::vector<Spring> patch_springs_;
    std::vector<PatchFriction<double>> friction_;  // of the patches
  };

  void make_room();
  void release(const Left& last, FrictionMemory& memory) const;
  void release_ended(FrictionMemory& memory);
  [[nodiscard]] History history() const;
  void take(const PairInTouch& pair, const Inherited& from);
  void add_springs(const PairInTouch& pair, const PairMemory& memory, const Lists& lists,
                   std::vector<Spring>& springs) const;
  void fetch(const PairInTouch& pair) const;
  // Null where a pair has not touched in the last step.
  [[nodiscard]] const PairMemory* memory_of(const PairInTouch& pair) const;

  const Surfaces& surfaces_;
  const PairIntegrals& pairs_;
  bool per_edge_;
  const PairTable& table_;
  double thickness_;
  Threads threads_;
  std::vector<Range> ranges_;  // one for each thread
  // Of each slot; those that are free remember nothing.
  std::vector<PairMemory> memory_;
  Lists now_, before_;
  std::optional<History> inherited_;  // not adopted yet
  std::vector<Left> left_;
  History kept_;
  // Of the step at hand.
  Kinematics kinematics_;
  PairScene scene_;
  std::vector<PairBook> books_;  // of each block
};

template <class Take>
void PatchTangential::step(int first, int end, int worker, const Take& take) {
  Range& range = ranges_[static_cast<size_t>(worker)];
  const int count = static_cast<int>(pairs_.touching().size());
  for (int i = first; i < end; i += kBlock) {
    range.step_block(i, std::min(i + kBlock, count), books_[static_cast<size_t>(i / kBlock)]);
    take(std::span<const PairLoad>(range.loads));
  }
}

}  // namespace apothem
