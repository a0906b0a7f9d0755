// Steps of contact patches of rigid bodies with friction or damping, four at a time. The formulas
// are those of patch_laws.hpp.
#pragma once

#include <array>

#include "apothem/contact/friction_memory.hpp"
#include "apothem/contact/kinematics.hpp"
#include "apothem/contact/law.hpp"
#include "apothem/contact/patch_laws.hpp"
#include "apothem/contact/surfaces.hpp"

namespace apothem {

using PatchDamper = DamperOf<double>;

/// Friction and damping of one pair; moments about the mass centres.
struct TangentialForce : TangentialForceOf<double> {
  RigidIndex a = -1, b = -1;

  void fields(Archive& archive) {
    archive("a", a)("b", b)("all", all)("damping", damping)("change_of_damping", change_of_damping)(
        "rate", rate)("power_before", power_before);
  }
};

/// How the two rigid bodies of a pair move against each other.
inline PairRate pair_rate(const Kinematics& now, RigidIndex a, RigidIndex b) {
  const double* va = &now.pose_rate[3 * static_cast<size_t>(a)];
  const double* vb = &now.pose_rate[3 * static_cast<size_t>(b)];
  return {va[0] - vb[0], va[1] - vb[1], va[2], vb[2]};
}

/// What all patches of a step have in common.
struct PatchScene {
  const Surfaces& surfaces;
  const Kinematics& now;
  double dt;         ///< s
  double thickness;  ///< m
};

/// A patch of the bodies a and b and what it remembers.
struct PatchWork {
  PatchWork() = default;
  /// `last`: of the step before, or null if the bodies did not touch; `begins`: the pair had no
  /// patch in the step before; `spring`: the force of the friction spring before, N; `damper`:
  /// before, or null.
  PatchWork(RigidIndex a, RigidIndex b, const PairIntegral* patch, const PairLaw* law,
            const TangentialForce* last, bool begins, double spring, const PatchDamper* damper);
  RigidIndex a, b;
  const PairIntegral* patch;
  const PairLaw* law;
  const TangentialForce* last;
  const PatchDamper* damper;
  double touched, begins;  // 1 or 0
  double spring;
};

/// Where the results of a pair go that has this patch alone.
struct PatchTarget {
  TangentialForce* force;
  PairStiffness* held;
  Spring* spring;  ///< null without friction
  PatchDamper* damper;
  PairBook* book;
};

/// Takes one patch of a pair a step further.
PatchForces<double> step_one(const PatchScene& scene, const PatchWork& work, bool rough,
                             bool damped, PatchDamper& damper);

/// Patches of pairs that have no other one, collected until there are enough of them.
class PatchBatch {
 public:
  /// All must have the same `rough` and `damped` until flush() is called.
  void add(const PatchScene& scene, bool rough, bool damped, const PatchWork& work,
           const PatchTarget& target) {
    if (rough != rough_ || damped != damped_) flush(scene);
    rough_ = rough;
    damped_ = damped;
    work_[static_cast<size_t>(count_)] = work;
    targets_[static_cast<size_t>(count_)] = target;
    if (++count_ == kAtOnce) flush(scene);
  }
  /// Takes all patches that have been added a step further.
  void flush(const PatchScene& scene);

 private:
  static constexpr int kAtOnce = kComparedLanes;

  void step(const PatchScene& scene);

  int count_ = 0;
  bool rough_ = false, damped_ = false;
  std::array<PatchWork, kAtOnce> work_{};
  std::array<PatchTarget, kAtOnce> targets_{};
  struct {
    TangentialForce force;
    PairStiffness held;
    Spring spring;
    PatchDamper damper;
    PairBook book;
  } spare_ = {};
};

}  // namespace apothem
