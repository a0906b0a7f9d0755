// Friction and normal damping between polygons of rigid bodies: the forces beside the normal ones,
// by contact patches (docs/theory.md, Friction). Only scenes that ask for them have this.
//
//   resultant   one spring for each patch, at right angles to its normal force (Eqs. 10-14)
//   per_edge    one spring for each edge of the overlap (Eq. 9), the older law, for comparison
#pragma once

#include <algorithm>
#include <limits>
#include <span>
#include <vector>

#include "apothem/contact/law.hpp"
#include "apothem/contact/pair_batch.hpp"
#include "apothem/contact/pair_integrals.hpp"
#include "apothem/contact/pair_table.hpp"
#include "apothem/execution/parallel.hpp"
#include "apothem/geometry/integrals/contact_patches.hpp"

namespace apothem {

class PatchTangential {
 public:
  /// What a pair had in a step. The lists of runs and dampers follow in the order of the pairs.
  struct PairHistory {
    RigidIndex a, b;
    int patches, runs;
    int first_run, first_damper;  // in the lists; not archived
    PairForce force;              // friction and damping; moments about the mass centres
    void fields(Archive& archive) {
      archive("a", a)("b", b)("patches", patches)("runs", runs)("force", force);
    }
  };
  struct History {
    std::vector<PairHistory> pairs;    ///< ascending
    std::vector<BoundaryRun> runs;     ///< of pairs that are not both convex, or of per_edge
    std::vector<PatchDamper> dampers;  ///< of every patch, where any pair is damped
    std::vector<PairDamping> damping;  ///< of every pair, where any pair is damped
    void fields(Archive& archive);
    /// Finds where what each pair has begins in the lists.
    void number();
  };

  /// `thickness` in m.
  PatchTangential(const Surfaces& surfaces, const ContactLaw& law, const PairTable& table,
                  double thickness, int threads);

  /// Begins a step of dt (s): see Kernel::slide. `pairs` and `now` are used until it ends.
  void begin_step(const PairIntegrals& pairs, const Kinematics& now, double dt,
                  FrictionMemory& memory);
  /// Takes the touching pairs from number `first` to `end`, which are blocks of kBlock pairs, one
  /// step further, and hands the loads of each block to take(loads).
  template <class Take>
  void step(int first, int end, int worker, FrictionMemory& memory, const Take& take);
  /// Books what friction and damping have lost.
  void end_step(FrictionMemory& memory);

  /// Takes back the last step.
  void undo_step() { std::swap(now_, before_); }

  /// Adds friction and damping to the records of a pair, one for each patch. `runs`: of the pair,
  /// needed by the law per_edge.
  void add_to(std::span<ContactRecord> patches, std::span<const BoundaryRun> runs,
              std::span<const Spring> springs) const;
  [[nodiscard]] bool edgewise() const { return per_edge_; }

  /// Takes over what the patches of another simulation remember.
  void inherit(History history);
  void fields(Archive& archive) { now_.fields(archive); }

  /// Pairs whose sums are booked together, so that they do not depend on the number of threads.
  static constexpr int kBlock = 32;

 private:
  // Where what a pair has begins in the lists of now.
  struct Place {
    int run = 0, damper = 0;
    size_t spring = 0;  // in the memory of friction
    void pass(int patches, int runs, Tangential kind, const PatchTangential& all);
  };

  // The pairs that one thread takes a step further.
  class Range {
   public:
    explicit Range(PatchTangential& all) : all_(all) {}

    // Begins a step behind a pair of the last step, or with the first one.
    void begin(size_t next) { next_ = next; }
    void step_block(int first, int end, PairBook& book);
    // Pairs that touch no more and come before this one.
    void release_until(RigidIndex a, RigidIndex b);

    SpringRange springs;
    std::vector<PairLoad> loads;  // of the block

   private:
    // A pair in a step.
    struct Pair {
      RigidIndex a, b;
      const PairIntegral* integral;
      const PairLaw& law;
      Tangential kind;
      const PairHistory* before;        // null if the bodies did not touch
      const PairDamping* last;          // the same, where any pair is damped
      std::span<const Spring> springs;  // of the step before
      Place to;
      PairHistory& now;
      PairDamping* damping;  // null where no pair is damped
      PairLoad& load;
      PairBook& book;
    };
    void step_pair(const PairInTouch& touching, size_t number, Place& to, PairLoad& load,
                   PairBook& book);
    // What the patches of a pair add up to.
    struct Sum {
      PairRate rate;
      PairForce force = {}, damping = {};
      BodyStiffness held_a = {}, held_b = {};  // by its friction springs
    };
    void release(const PairHistory& last, const PairDamping* damping);
    void find_shares(const PairHistory* before);
    [[nodiscard]] bool inherit_whole() const;
    template <class T, class Add>
    void inherit(std::span<const T> before, std::vector<T>& heirs, Add&& add) const;
    [[nodiscard]] double lost_by_balance(const Pair& pair, const Sum& sum) const;
    void add_alone(const Pair& pair);
    void step_patches(const Pair& pair);
    void per_edge(const Pair& pair, Sum& sum);

    PatchTangential& all_;
    size_t next_ = 0;  // of the pairs of the step before
    PairBatch batch_;
    std::vector<PairBook> books_;  // of the pairs of the block
    // Of the pair at hand.
    std::span<const BoundaryRun> runs_;
    std::span<const PairIntegral> patches_;
    size_t ancestors_ = 0;
    std::vector<double> shares_;  // of each ancestor that goes to each patch of now
    std::vector<Spring> patch_springs_;
    std::vector<PatchDamper> dampers_;
  };

  [[nodiscard]] Tangential kind_of(const PairLaw& law) const {
    return {law.friction.coefficient > 0, law.damping.normal > 0 || law.damping.tangential > 0};
  }
  size_t make_room();
  // Of pair number i of the step before, where any pair is damped.
  [[nodiscard]] const PairDamping* damping_before(size_t i) const {
    return i < before_.damping.size() ? &before_.damping[i] : nullptr;
  }
  // Of the patches of a pair in the step before; nothing where it is not damped.
  [[nodiscard]] std::span<const PatchDamper> dampers_of(const PairHistory* pair) const;
  void begin_range(Range& range, int first, FrictionMemory& memory);

  const Surfaces& surfaces_;
  bool per_edge_;
  const PairTable& table_;
  double thickness_;
  Threads threads_;
  std::vector<Range> ranges_;  // one for each thread
  History now_, before_;
  // Of the step at hand.
  const PairIntegrals* pairs_ = nullptr;
  Kinematics kinematics_;
  PairScene scene_;
  std::vector<Place> places_;  // of each block
  std::span<Spring> springs_;
  std::vector<PairBook> books_;  // of each block
};

template <class Take>
void PatchTangential::step(int first, int end, int worker, FrictionMemory& memory,
                           const Take& take) {
  Range& range = ranges_[static_cast<size_t>(worker)];
  begin_range(range, first, memory);
  const int count = static_cast<int>(pairs_->touching().size());
  for (int i = first; i < end; i += kBlock) {
    range.step_block(i, std::min(i + kBlock, count), books_[static_cast<size_t>(i / kBlock)]);
    take(std::span<const PairLoad>(range.loads));
  }
  if (end >= count) range.release_until(std::numeric_limits<RigidIndex>::max(), 0);
}

}  // namespace apothem
