// Friction between polygons of rigid bodies, by contact patches (docs/theory.md, Friction). Only
// scenes that ask for it have this.
//
//   resultant   one spring for each patch, at right angles to its normal force (Eqs. 10-14)
//   per_edge    one spring for each edge of the overlap (Eq. 9), the older law, for comparison
//
// What patches remember are the springs of the friction memory, one for each: they are found by
// their pairs, and renewed in every step. Patches of pairs that are split are found again by the
// runs of boundary that they share with those of the step before.
#pragma once

#include <algorithm>
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

namespace apothem {

class PatchTangential {
 public:
  /// `thickness` in m. All must outlive this object.
  PatchTangential(const Surfaces& surfaces, const PairIntegrals& pairs, const ContactLaw& law,
                  const PairTable& table, FrictionMemory& memory, double thickness, int threads);

  /// Begins a step of dt (s): see Kernel::slide. `now` is used until the step ends.
  void begin_step(const Kinematics& now, double dt);
  /// Takes the touching pairs from number `first` to `end`, which are blocks of kBlock pairs, one
  /// step further, and hands the loads of each block to take(loads).
  template <class Take>
  void step(int first, int end, int worker, const Take& take);
  /// Books what friction has lost.
  void end_step();

  /// The friction of a pair that has one patch, now and in the step before; of others it is not
  /// known. Not for every pair.
  [[nodiscard]] std::optional<PairForce> friction(RigidIndex a, RigidIndex b) const {
    const FrictionMemory& memory = memory_;
    return friction_of(a, b, memory.springs(), memory.runs().now());
  }
  [[nodiscard]] std::optional<PairForce> friction_before(RigidIndex a, RigidIndex b) const {
    return friction_of(a, b, memory_.springs_before(), memory_.runs().before());
  }
  /// Force of the spring in a patch, N.
  [[nodiscard]] double spring_in(const PairInTouch& pair, size_t patch) const;
  /// The dashpot there pushes so much, N, which the next step has to know.
  void keep_push(const PairInTouch& pair, size_t patch, double push);

  /// Adds friction to the records of a pair, one for each patch. `runs`: of the pair, needed by the
  /// law per_edge.
  void add_to(std::span<ContactRecord> patches, std::span<const BoundaryRun> runs,
              const PairInTouch& pair) const;

  /// Pairs whose sums are booked together, so that they do not depend on the number of threads.
  static constexpr int kBlock = 32;

 private:
  // Where the springs and the runs of a touching pair begin.
  struct Place {
    size_t spring = 0, run = 0;
  };

  // The pairs that one thread takes a step further.
  class Range {
   public:
    explicit Range(PatchTangential& all) : all_(all) {}

    void begin(size_t first, size_t end);
    void step_block(size_t first, size_t end, PairBook& book);
    void finish();

    std::vector<PairLoad> loads;  // of the block
    std::vector<double> ended;    // what each pair that has ended has lost, J

   private:
    // What the patches of a pair add up to.
    struct Sum {
      PairRate rate;
      PairForce force = {};
      BodyStiffness held_a = {}, held_b = {};  // by its friction springs
    };
    void step_pair(size_t number, PairLoad& load, PairBook& book);
    void step_patches(const PairInTouch& touching, const PairWork& pair);
    void step_springs(const PairWork& pair, Sum& sum);
    void keep_runs(const ContactKey& pair, size_t number) const;
    void find_shares(const ContactKey& pair);
    void inherit();
    [[nodiscard]] double lost_by_balance(const PairWork& pair, const Sum& sum) const;
    void per_edge(const PairWork& pair, std::span<const BoundaryRun> runs, Sum& sum);

    PatchTangential& all_;
    PairBatch batch_;
    std::vector<PairBook> books_;  // of the pairs of the block
    ContactWalk<const Spring> walk_;
    // Of the pair at hand.
    std::span<const RunPlace> runs_;
    std::span<const PairIntegral> patches_;
    std::span<const Spring> before_;
    std::span<Spring> now_;
    std::vector<RunPlace> runs_before_;
    std::vector<double> shares_;  // of each patch before that goes to each patch of now
    std::vector<Spring> patch_springs_;
    std::vector<PatchFriction<double>> friction_;  // of the patches
  };

  void make_room();
  [[nodiscard]] std::optional<PairForce> friction_of(RigidIndex a, RigidIndex b,
                                                     std::span<const Spring> springs,
                                                     std::span<const PatchRun> runs) const;
  [[nodiscard]] double lost_at_end(std::span<const Spring> springs) const;
  [[nodiscard]] Place place_of(size_t number) const {
    return places_.empty() ? Place{number, 0} : places_[number];
  }
  [[nodiscard]] std::span<Spring> springs_of(const PairInTouch& pair) const;
  void fetch(const PairInTouch& pair) const;

  const Surfaces& surfaces_;
  const PairIntegrals& pairs_;
  bool per_edge_;
  const PairTable& table_;
  FrictionMemory& memory_;
  double thickness_;
  std::vector<Range> ranges_;  // one for each thread
  // Of the step at hand.
  Kinematics kinematics_;
  PairScene scene_;
  std::vector<PairBook> books_;  // of each block
  // Of each touching pair, and of the end; none if each of them has one spring.
  std::vector<Place> places_;
  std::span<Spring> springs_;
  std::span<PatchRun> runs_;
};

template <class Take>
void PatchTangential::step(int first, int end, int worker, const Take& take) {
  Range& range = ranges_[static_cast<size_t>(worker)];
  range.begin(static_cast<size_t>(first), static_cast<size_t>(end));
  for (int i = first; i < end; i += kBlock) {
    range.step_block(static_cast<size_t>(i), static_cast<size_t>(std::min(i + kBlock, end)),
                     books_[static_cast<size_t>(i / kBlock)]);
    take(std::span<const PairLoad>(range.loads));
  }
  range.finish();
}

}  // namespace apothem
