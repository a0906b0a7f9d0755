// Friction and normal damping between polygons of rigid bodies: the forces beside the normal ones,
// by contact patches (docs/theory.md, Friction). Only scenes that ask for them have this.
//
//   resultant   one spring for each patch, at right angles to its normal force (Eqs. 10-14)
//   per_edge    one spring for each edge of the overlap (Eq. 9), the older law, for comparison
#pragma once

#include <span>
#include <vector>

#include "apothem/contact/law.hpp"
#include "apothem/contact/pair_integrals.hpp"
#include "apothem/contact/pair_table.hpp"
#include "apothem/contact/patch_batch.hpp"
#include "apothem/contact/stiffness.hpp"
#include "apothem/execution/parallel.hpp"
#include "apothem/geometry/integrals/contact_patches.hpp"

namespace apothem {

class PatchTangential {
 public:
  /// `thickness` in m.
  PatchTangential(const Surfaces& surfaces, const ContactLaw& law, const PairTable& table,
                  double thickness, int threads);

  /// One step further: see Kernel::slide. Books what friction loses, and finds how stiff the
  /// friction springs of each touching pair hold its bodies.
  void slide(const PairIntegrals& pairs, const Kinematics& now, double dt, FrictionMemory& memory,
             std::span<PairStiffness> stiffness);

  /// Takes back the last slide.
  void undo_slide() {
    std::swap(now_, before_);
    std::swap(forces_, forces_before_);
  }

  /// Of the touching pairs; zero where they have neither friction nor damping.
  [[nodiscard]] const std::vector<TangentialForce>& forces() const { return forces_; }

  /// Where the next pair is looked for first: pairs must be asked for in ascending order.
  struct Cursor {
    size_t pair = 0, damper = 0;
  };
  /// Adds friction and damping to the records of a pair, one for each patch. `runs`: of the pair,
  /// needed by the law per_edge.
  void add_to(std::span<ContactRecord> patches, std::span<const BoundaryRun> runs,
              std::span<const Spring> springs, Cursor& cursor) const;
  [[nodiscard]] bool edgewise() const { return per_edge_; }

  /// What a pair had in the step before; the lists of runs and dampers follow in this order.
  struct PairHistory {
    RigidIndex a, b;
    int patches, runs;
    void fields(Archive& archive) { archive("a", a)("b", b)("patches", patches)("runs", runs); }
  };
  struct History {
    std::vector<PairHistory> pairs;    ///< ascending
    std::vector<BoundaryRun> runs;     ///< of pairs that are not both convex, or of per_edge
    std::vector<PatchDamper> dampers;  ///< of every patch, where any pair is damped
    void clear() { pairs.clear(), runs.clear(), dampers.clear(); }
    void fields(Archive& archive);
  };
  /// Takes over what the patches of another simulation remember.
  void inherit(History history) { now_ = std::move(history); }
  void fields(Archive& archive) {
    now_.fields(archive);
    archive("forces", forces_);
  }

 private:
  struct Place {  // in a History
    size_t pair = 0, run = 0, damper = 0;
    size_t spring = 0;  // in the memory of friction
    void pass(const PairHistory& p) {
      ++pair;
      run += static_cast<size_t>(p.runs);
      damper += static_cast<size_t>(p.patches);
    }
  };

  // The pairs that one thread takes a step further.
  class Range {
   public:
    explicit Range(PatchTangential& all) : all_(all) {}

    // Begins a step behind a pair of the last step, or with the first one.
    void begin(const Place& place, size_t force);
    // Takes the touching pair number i a step further, or adds it to those that wait for others.
    void step_pair(const PairIntegrals& pairs, size_t i, const PatchScene& scene);
    void finish(const PatchScene& scene) { batch_.flush(scene); }
    // Pairs that touch no more and come before this one.
    void release_until(RigidIndex a, RigidIndex b, const PatchScene& scene);

    SpringRange springs;

   private:
    // A pair in a step.
    struct Pair {
      RigidIndex a, b;
      const PairLaw& law;
      bool rough, damped;
      const TangentialForce* last;           // of the step before, or null
      std::span<const Spring> springs;       // of the step before
      std::span<const PatchDamper> dampers;  // of the step before
      Place to;
      TangentialForce& total;
      PairStiffness& held;
      PairBook& book;

      void clear() const {
        total = {};
        total.a = a;
        total.b = b;
        held = {};
        book = {};
      }
    };
    const PairHistory* find_before(RigidIndex a, RigidIndex b);
    void release(const TangentialForce& last, const PatchScene& scene);
    void find_shares(const PairHistory* before);
    [[nodiscard]] bool inherit_whole() const;
    template <class T, class Add>
    void inherit(std::span<const T> before, std::vector<T>& heirs, Add&& add) const;
    [[nodiscard]] double lost_by_balance(const Pair& pair, double dt) const;
    void add_alone(const Pair& pair, const PatchScene& scene);
    void step_patches(const Pair& pair, const PatchScene& scene);
    void per_edge(const Pair& pair, const PatchScene& scene);

    PatchTangential& all_;
    Place place_;      // of the next pair of the step before
    size_t last_ = 0;  // of its forces
    PatchBatch batch_;
    // Of the pair at hand.
    std::span<const BoundaryRun> runs_;
    std::span<const PairIntegral> patches_;
    size_t ancestors_ = 0;
    std::vector<double> shares_;  // of each ancestor that goes to each patch of now
    std::vector<Spring> patch_springs_;
    std::vector<PatchDamper> dampers_;
  };

  [[nodiscard]] bool is_rough(const PairLaw& law) const { return law.friction.coefficient > 0; }
  [[nodiscard]] bool is_damped(const PairLaw& law) const {
    return law.damping.normal > 0 || law.damping.tangential > 0;
  }
  void make_room(std::span<const PairInTouch> pairs);
  // In the step before, behind a pair.
  [[nodiscard]] Place place_behind(const BoxPair& pair) const;
  [[nodiscard]] size_t forces_behind(const BoxPair& pair) const;

  const Surfaces& surfaces_;
  bool per_edge_;
  const PairTable& table_;
  double thickness_;
  Threads threads_;
  std::vector<Range> ranges_;  // one for each thread
  std::vector<Place> places_;  // of each touching pair, and behind the last one
  History now_, before_;
  std::vector<TangentialForce> forces_, forces_before_;
  // Of each touching pair, while it slides.
  std::span<PairStiffness> stiffness_;
  std::span<Spring> springs_;
  std::vector<PairBook> books_;
};

}  // namespace apothem
