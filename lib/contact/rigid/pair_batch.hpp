// Steps of touching pairs of rigid bodies, four at a time: friction of pairs that have one contact
// patch, and the loads of all. The formulas are those of patch_laws.hpp and pair_load.hpp.
#pragma once

#include <array>
#include <span>

#include "lib/contact/law/dashpots.hpp"
#include "lib/contact/law/friction_memory.hpp"
#include "lib/contact/law/kinematics.hpp"
#include "lib/contact/law/law.hpp"
#include "lib/contact/rigid/pair_load.hpp"
#include "lib/contact/surface/surfaces.hpp"

namespace apothem {

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
  const Kinematics* now = nullptr;  ///< not needed without friction
  double dt = 0;                    ///< s
};

/// What a patch remembers that was not there in the step before.
inline const Spring kNoSpring{};

/// A pair, or one of its contact patches, what it remembers, and where its results go.
struct PairWork {
  RigidIndex a, b;
  const PairIntegral* integral;
  const PairLaw* law;
  PairLoad* load;
  const Spring* before = &kNoSpring;  ///< in the step before
  bool begins = true;                 ///< the pair had no patch in the step before
  Spring* now = nullptr;              ///< but for its key; null without friction
  PairBook* book = nullptr;           ///< null without friction
};

/// Friction of so many contact patches, kComparedLanes at most. Those of `work` are not written to.
void find_patch_friction(const PairScene& scene, std::span<const PairWork> work,
                         PatchFriction<double>* friction);
/// The dashpots of a contact patch of two bodies; false if it has none, because its force has no
/// direction. `spring`: force of the friction spring in it, N.
bool add_dashpot(const PairScene& scene, const std::pair<RigidIndex, RigidIndex>& bodies,
                 const PairIntegral& patch, const PairLaw& law, double spring, Dashpots& to);
/// The load of a pair with this friction beside the normal force. `held_a`, `held_b`: how its
/// friction springs hold the bodies.
void load_pair(const PairScene& scene, const PairWork& work, const PairForce& friction,
               const BodyStiffness& held_a, const BodyStiffness& held_b);

/// Pairs of at most one contact patch, collected until there are enough of them.
class PairBatch {
 public:
  void add(const PairScene& scene, bool rough, const PairWork& work) {
    if (rough != rough_) flush(scene);
    rough_ = rough;
    work_[static_cast<size_t>(count_)] = work;
    if (++count_ == kAtOnce) flush(scene);
  }
  /// Takes all pairs that have been added a step further.
  void flush(const PairScene& scene);

 private:
  static constexpr int kAtOnce = kComparedLanes;

  void step(const PairScene& scene);

  int count_ = 0;
  bool rough_ = false;
  std::array<PairWork, kAtOnce> work_{};
  struct {
    PairLoad load;
    Spring now;
    PairBook book;
  } spare_ = {};
};

}  // namespace apothem
