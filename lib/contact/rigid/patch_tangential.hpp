// Friction between polygons of rigid bodies, by contact patches (docs/theory.md, Friction). It
// exists only in scenes with friction.
//
//   resultant   one spring for each patch, at right angles to its normal force (Eqs. 10-14)
//   per_edge    one spring for each edge of the overlap (Eq. 9), the older law, for comparison
//
// The memory of a patch is its spring in the friction memory. The springs of a pair are found by
// its key and renewed in every step. In pairs that touch in several patches, patches are matched by
// the boundary segments that they share with those of the step before.
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
#include "lib/contact/rigid/pair_tangent.hpp"

namespace apothem {

class PatchTangential {
 public:
  /// `thickness` is in m. All arguments must outlive this object.
  PatchTangential(const Surfaces& surfaces, const PairIntegrals& pairs, const ContactLaw& law,
                  const PairTable& table, FrictionMemory& memory, double thickness, int threads);

  /// Begins a step of dt (s), see Kernel::update_friction. `now` is used until the step ends.
  void begin_step(const Kinematics& now, double dt);
  /// Updates the friction of the touching pairs from `first` to `end`, in blocks of kBlock pairs,
  /// and passes the loads of each block to consume(loads).
  template <class Consume>
  void step(int first, int end, int worker, const Consume& consume);
  /// Books the losses of friction.
  void end_step();

  /// The friction of a pair with one patch, in this step and in the step before; nothing for pairs
  /// with several patches, where it is not known. It is too slow for every pair.
  [[nodiscard]] std::optional<PairForce> friction(RigidIndex a, RigidIndex b) const {
    const FrictionMemory& memory = memory_;
    return friction_of(a, b, memory.springs(), memory.segments().now());
  }
  [[nodiscard]] std::optional<PairForce> friction_before(RigidIndex a, RigidIndex b) const {
    return friction_of(a, b, memory_.springs_before(), memory_.segments().before());
  }
  /// The friction in a patch after a trial, for its tangent. False with the law per_edge, whose
  /// springs do not belong to patches.
  [[nodiscard]] bool tried(const PairInTouch& pair, size_t patch, TriedFriction& friction) const;
  /// The force of the spring in a patch, N.
  [[nodiscard]] double spring_in(const PairInTouch& pair, size_t patch) const;
  /// Stores the force of the dashpot in a patch, N, for the next step.
  void keep_push(const PairInTouch& pair, size_t patch, double push);

  /// Adds friction to the records of a pair, one for each patch. The law per_edge needs the
  /// boundary segments of the pair.
  void add_to(std::span<ContactRecord> patches, std::span<const BoundarySegment> segments,
              const PairInTouch& pair) const;

  /// The number of pairs in a block. The sums of a block are booked together, so that they do not
  /// depend on the number of threads.
  static constexpr int kBlock = 32;

 private:
  // The indices of the first spring and of the first segment of a touching pair.
  struct ListOffsets {
    size_t spring = 0, segment = 0;
  };

  // The pairs that one thread works on.
  class Range {
   public:
    explicit Range(PatchTangential& all) : all_(all) {}

    void begin(size_t first, size_t end);
    void step_block(size_t first, size_t end, PairLedger& ledger);
    void finish();

    std::vector<PairLoad> loads;  // loads of the block
    std::vector<double> ended;    // energy lost by each pair that has ended, J

   private:
    // The sums over the patches of a pair.
    struct Sum {
      PairRate rate;
      PairForce force = {};
      BodyStiffness body_stiffness_a = {}, body_stiffness_b = {};  // of its friction springs
    };
    void step_pair(size_t number, PairLoad& load, PairLedger& ledger);
    void step_patches(const PairInTouch& touching, const PairWork& pair);
    void step_springs(const PairWork& pair, Sum& sum);
    void keep_segments(const ContactKey& pair, size_t number) const;
    void match_patches(const ContactKey& pair);
    void transfer_springs();
    [[nodiscard]] double lost_by_balance(const PairWork& pair, const Sum& sum) const;
    void per_edge(const PairWork& pair, std::span<const BoundarySegment> segments, Sum& sum);

    PatchTangential& all_;
    PairBatch batch_;
    std::vector<PairLedger> ledgers_;  // ledgers of the pairs of the block
    ContactWalk<const Spring> walk_;
    // The present pair.
    std::span<const SegmentPlace> segments_;
    std::span<const PairIntegral> patches_;
    std::span<const Spring> before_;
    std::span<Spring> now_;
    std::vector<SegmentPlace> segments_before_;
    // The fraction of each earlier patch that goes to each present patch.
    std::vector<double> fractions_;
    std::vector<Spring> patch_springs_;
    std::vector<PatchFriction<double>> friction_;  // friction of each patch
  };

  void make_room();
  [[nodiscard]] std::optional<PairForce> friction_of(RigidIndex a, RigidIndex b,
                                                     std::span<const Spring> springs,
                                                     std::span<const PatchSegment> segments) const;
  [[nodiscard]] double lost_at_end(std::span<const Spring> springs) const;
  [[nodiscard]] ListOffsets offsets_of(size_t number) const {
    return offsets_.empty() ? ListOffsets{number, 0} : offsets_[number];
  }
  [[nodiscard]] std::span<Spring> springs_of(const PairInTouch& pair) const;
  void fetch(const PairInTouch& pair) const;

  const Surfaces& surfaces_;
  const PairIntegrals& pairs_;
  bool per_edge_;
  const PairTable& table_;
  FrictionMemory& memory_;
  double thickness_;
  std::vector<Range> ranges_;  // one range for each thread
  // The present step.
  Kinematics kinematics_;
  PairScene scene_;
  std::vector<PairLedger> ledgers_;  // ledger of each block
  // Offsets of each touching pair, and of the end; empty if each pair has one spring.
  std::vector<ListOffsets> offsets_;
  std::span<Spring> springs_;
  std::span<PatchSegment> segments_;
};

template <class Consume>
void PatchTangential::step(int first, int end, int worker, const Consume& consume) {
  Range& range = ranges_[static_cast<size_t>(worker)];
  range.begin(static_cast<size_t>(first), static_cast<size_t>(end));
  for (int i = first; i < end; i += kBlock) {
    range.step_block(static_cast<size_t>(i), static_cast<size_t>(std::min(i + kBlock, end)),
                     ledgers_[static_cast<size_t>(i / kBlock)]);
    consume(std::span<const PairLoad>(range.loads));
  }
  range.finish();
}

}  // namespace apothem
