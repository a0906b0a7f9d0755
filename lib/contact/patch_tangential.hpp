// Friction and normal damping between polygons of rigid bodies: the forces beside the normal ones,
// by contact patches (docs/theory.md, Friction). Only scenes that ask for them have this.
//
//   resultant   one spring for each patch, at right angles to its normal force (Eqs. 10-14)
//   per_edge    one spring for each edge of the overlap (Eq. 9), the older law, for comparison
#pragma once

#include <span>
#include <vector>

#include "apothem/contact/law.hpp"
#include "apothem/contact/normal_damping.hpp"
#include "apothem/contact/pair_integrals.hpp"
#include "apothem/contact/pair_table.hpp"
#include "apothem/contact/stiffness.hpp"
#include "apothem/execution/parallel.hpp"
#include "apothem/geometry/integrals/contact_patches.hpp"

namespace apothem {

/// Friction and damping of one pair; moments about the mass centres.
struct TangentialForce {
  RigidIndex a = -1, b = -1;
  PairForce all = {};
  PairForce damping = {};            ///< of this
  PairForce change_of_damping = {};  ///< in the last step
  PairRate rate = {};                ///< in the last half step
  double power_before = 0;           ///< of the change at the rate before that one, W

  /// Finds what has changed since the step before, in which the pair may have touched. With dt = 0
  /// nothing has.
  void compare_with(const TangentialForce* last, const PairRate& now, double dt) {
    rate = now;
    if (!(dt > 0)) return;
    change_of_damping = damping;
    if (last) change_of_damping += -1 * last->damping;
    power_before = change_of_damping.power(last ? last->rate : now);
  }
  void add_damping(const PairForce& f) {
    all += f;
    damping += f;
  }
  void fields(Archive& archive) {
    archive("a", a)("b", b)("all", all)("damping", damping)("change_of_damping", change_of_damping)(
        "rate", rate)("power_before", power_before);
  }
};

class PatchTangential {
 public:
  /// `thickness` in m.
  PatchTangential(const Surfaces& surfaces, const ContactLaw& law, const PairTable& table,
                  double thickness, int threads);

  /// One step further: see Kernel::slide. `touching`: the pairs in contact. Books what friction
  /// loses, and finds how stiff the friction springs of each of these pairs hold its bodies.
  void slide(const PairIntegrals& pairs, std::span<const int> touching, const Kinematics& now,
             double dt, FrictionMemory& memory, std::span<PairStiffness> stiffness);

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
    void step_pair(const PairIntegrals& pairs, size_t pair, const Place& to, const Kinematics& now,
                   double dt);
    // Pairs that touch no more and come before this one.
    void release_until(RigidIndex a, RigidIndex b, const Kinematics& now, double dt);

    SpringRange springs;

   private:
    const PairHistory* find_before(RigidIndex a, RigidIndex b);
    void book_damping(const TangentialForce* last, const TangentialForce& force,
                      const PairRate& rate, double dt);
    void release(const TangentialForce& last, const Kinematics& now, double dt);
    void find_shares(const PairHistory* before);
    [[nodiscard]] bool inherit_whole() const;
    template <class T, class Add>
    void inherit(std::span<const T> before, std::vector<T>& heirs, Add&& add) const;
    [[nodiscard]] double lost_by_balance(std::span<const Spring> before,
                                         const TangentialForce* last, const TangentialForce& force,
                                         const PairRate& rate, double dt) const;
    void resultant(const PairMotion& motion, double dt, const PairLaw& law, SpringKey key,
                   const PairIntegral& patch, double force_error, Spring& spring,
                   PatchDamper* damper);
    void per_edge(const PairMotion& motion, double dt, const PairLaw& law, SpringKey key,
                  std::span<const Spring> before);
    void add_spring(double size, double stiffness, const Vec2& tangent, const Vec2& point,
                    const Vec2& between);

    PatchTangential& all_;
    Place place_;      // of the next pair of the step before
    size_t last_ = 0;  // of its forces
    // Of the pair at hand.
    TangentialForce* total_ = nullptr;
    PairStiffness* stiffness_ = nullptr;
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
  void make_room(const PairIntegrals& pairs, std::span<const int> touching);
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
  std::span<PairStiffness> stiffness_;  // of each touching pair, while it slides
};

}  // namespace apothem
