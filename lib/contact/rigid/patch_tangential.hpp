// Friction and normal damping between polygons of rigid bodies: the forces beside the normal ones,
// by contact patches (docs/theory.md, Friction). Only scenes that ask for them have this.
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
  /// What a pair had in a step. The lists of runs, dampers and springs follow in the order of the
  /// pairs.
  struct PairHistory {
    RigidIndex a, b;
    int patches, runs;
    PairForce force;  // friction and damping; moments about the mass centres
    void fields(Archive& archive) {
      archive("a", a)("b", b)("patches", patches)("runs", runs)("force", force);
    }
  };
  /// What all pairs remember, for archives and for other simulations.
  struct History {
    std::vector<PairHistory> pairs;    ///< ascending
    std::vector<RunPlace> runs;        ///< of pairs that are not both convex, or of per_edge
    std::vector<PatchDamper> dampers;  ///< of every patch, where any pair is damped
    std::vector<PairDamping> damping;  ///< of every pair, where any pair is damped
    std::vector<Spring> springs;       ///< ascending
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
  /// Books what friction and damping have lost.
  void end_step(FrictionMemory& memory);

  /// undo_step() comes back to what pairs remember now.
  void remember() { kept_ = inherited_ ? *inherited_ : history(); }
  void undo_step() { inherited_ = kept_; }

  /// What acts beside the normal force of a pair.
  struct Beside {
    bool alone = false;       ///< the pair has one patch; otherwise it is not known
    bool free = false;        ///< damping takes the whole normal force
    PairForce damping = {};   ///< along the normal
    PairForce friction = {};  ///< of the spring
    PairForce drag = {};      ///< of the dashpot beside the spring
    void fields(Archive& archive) {
      archive("alone", alone)("free", free)("damping", damping)("friction", friction)("drag", drag);
    }
  };
  [[nodiscard]] Beside beside(const PairInTouch& pair) const {
    const PairMemory& memory = memory_[static_cast<size_t>(pair.slot)];
    if (memory.patches != 1) return {};
    if (!table_.damped()) return {true, false, {}, memory.force};
    const DampingMemory& damping = damping_[static_cast<size_t>(pair.slot)];
    const PairForce& normal = damping.patch.damping;
    return {true, false, normal, memory.force - damping.pair.damping,
            damping.pair.damping - normal};
  }

  /// Adds friction and damping to the records of a pair, one for each patch. `runs`: of the pair,
  /// needed by the law per_edge.
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
    int dampers = 0, first_damper = 0;
    int springs = 0, first_spring = 0;
  };
  // Of pairs that are split. Dampers and springs of only one patch are in the slot of its pair.
  struct Lists {
    std::vector<Place> places;
    std::vector<RunPlace> runs;
    std::vector<PatchDamper> dampers;
    std::vector<Spring> springs;

    void clear() { places.clear(), runs.clear(), dampers.clear(), springs.clear(); }
    [[nodiscard]] std::span<const RunPlace> runs_of(const PairMemory& pair) const;
    [[nodiscard]] std::span<const PatchDamper> dampers_of(const PairMemory& pair) const;
    [[nodiscard]] std::span<const Spring> springs_of(const PairMemory& pair) const;
  };
  // What a pair takes over.
  struct Inherited {
    const PairHistory& old;
    PairDamping damping;
    std::span<const RunPlace> runs = {};
    std::span<const PatchDamper> dampers = {};
    std::span<const Spring> springs = {};
  };
  // A pair of another state that does not touch in this one.
  struct Left {
    RigidIndex a, b;
    PairForce force;
    PairDamping damping;
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
      PairForce force = {}, damping = {};
      BodyStiffness held_a = {}, held_b = {};  // by its friction springs
    };
    void step_pair(const PairInTouch& touching, PairLoad& load, PairBook& book);
    void step_patches(const PairInTouch& touching, const PairWork& pair, Tangential kind,
                      const Place& to);
    void find_shares();
    template <class T, class Add>
    void inherit(std::span<const T> before, std::vector<T>& heirs, Add&& add) const;
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
    DampingMemory damping_before_;
    size_t ancestors_ = 0;
    std::vector<double> shares_;  // of each ancestor that goes to each patch of now
    std::vector<Spring> patch_springs_;
    std::vector<PatchDamper> dampers_;
    std::vector<PatchForces<double>> forces_;  // of the patches
  };

  [[nodiscard]] Tangential kind_of(const PairLaw& law) const {
    const bool damped = law.damping.normal > 0 || law.damping.tangential > 0;
    return {law.friction.coefficient > 0, damped && !kinematics_.still};
  }
  void make_room();
  void release(const Left& last, FrictionMemory& memory) const;
  void release_ended(FrictionMemory& memory);
  [[nodiscard]] History history() const;
  void take(const PairInTouch& pair, const Inherited& from);
  void add_springs(const PairInTouch& pair, const PairMemory& memory, const Lists& lists,
                   std::vector<Spring>& springs) const;
  [[nodiscard]] std::span<const PatchDamper> dampers_of(const PairInTouch& pair,
                                                        const PairMemory& memory) const;
  void fetch(const PairInTouch& pair) const;
  [[nodiscard]] DampingMemory* damping_of(const PairInTouch& pair) {
    return table_.damped() ? &damping_[static_cast<size_t>(pair.slot)] : nullptr;
  }
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
  std::vector<DampingMemory> damping_;  // where any pair is damped
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
