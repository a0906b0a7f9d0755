// Steps of touching pairs of rigid bodies, four at a time: friction and damping of pairs that have
// one contact patch, and the loads of all. The formulas are those of patch_laws.hpp and
// pair_load.hpp.
#pragma once

#include <array>
#include <span>

#include "lib/contact/law/friction_memory.hpp"
#include "lib/contact/law/kinematics.hpp"
#include "lib/contact/law/law.hpp"
#include "lib/contact/rigid/pair_load.hpp"
#include "lib/contact/surface/surfaces.hpp"

namespace apothem {

using PatchDamper = DamperOf<double>;
using PairDamping = PairDampingOf<double>;

/// How the two rigid bodies of a pair move against each other.
inline PairRate pair_rate(const Kinematics& now, RigidIndex a, RigidIndex b) {
  const double* va = &now.pose_rate[3 * static_cast<size_t>(a)];
  const double* vb = &now.pose_rate[3 * static_cast<size_t>(b)];
  return {va[0] - vb[0], va[1] - vb[1], va[2], vb[2]};
}

/// What all pairs of a step have in common.
struct PairScene {
  const Surfaces& surfaces;
  double thickness;                 ///< m
  const Kinematics* now = nullptr;  ///< not needed without friction and damping
  double dt = 0;                    ///< s
};

/// What acts between two bodies beside the normal force.
struct Tangential {
  bool rough = false, damped = false;
  [[nodiscard]] bool any() const { return rough || damped; }
  bool operator==(const Tangential&) const = default;
};

/// What a pair remembers from step to step. Its patches and edges have more, if it has several.
struct PairMemory {
  PairForce force = {};           ///< friction and damping; moments about the mass centres
  double spring = 0;              ///< force of the friction spring of the only patch, N
  VectorOf<double> tangent = {};  ///< along which it acts
  int patches = -1;               ///< in the last step; -1 if the bodies did not touch
  int split = -1;                 ///< number among the pairs that are split, or -1

  [[nodiscard]] bool touched() const { return patches >= 0; }
};

/// The same where any pair is damped.
struct DampingMemory {
  PairDamping pair;
  PatchDamper patch;  ///< of the only patch
};

/// A pair, or one of its contact patches, what it remembers, and where its results go.
struct PairWork {
  RigidIndex a, b;
  const PairIntegral* integral;
  const PairLaw* law;
  PairLoad* load;
  PairMemory* memory = nullptr;      ///< null without friction and damping
  DampingMemory* damping = nullptr;  ///< null without damping
  PairBook* book = nullptr;          ///< null without friction and damping
};

/// Friction and damping of so many contact patches, kComparedLanes at most. Those of `work` are not
/// written to.
void find_patch_forces(const PairScene& scene, std::span<const PairWork> work, Tangential kind,
                       PatchDamper* dampers, PatchForces<double>* forces);
/// The load of a pair with these forces beside the normal one. `held_a`, `held_b`: how its friction
/// springs hold the bodies.
void load_pair(const PairScene& scene, const PairWork& work, const PairForce& beside,
               const BodyStiffness& held_a, const BodyStiffness& held_b);

/// Pairs of at most one contact patch, collected until there are enough of them.
class PairBatch {
 public:
  void add(const PairScene& scene, Tangential kind, const PairWork& work) {
    if (!(kind == kind_)) flush(scene);
    kind_ = kind;
    work_[static_cast<size_t>(count_)] = work;
    if (++count_ == kAtOnce) flush(scene);
  }
  /// Takes all pairs that have been added a step further.
  void flush(const PairScene& scene);

 private:
  static constexpr int kAtOnce = kComparedLanes;

  void step(const PairScene& scene);

  int count_ = 0;
  Tangential kind_;
  std::array<PairWork, kAtOnce> work_{};
  struct {
    PairLoad load;
    PairMemory memory;
    DampingMemory damping;
    PairBook book;
  } spare_ = {};
};

}  // namespace apothem
