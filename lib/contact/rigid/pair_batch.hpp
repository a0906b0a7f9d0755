// Steps of touching pairs of rigid bodies, four pairs at a time: the friction of pairs with one
// contact patch, and the loads of all pairs. The formulas are those of patch_laws.hpp and
// pair_load.hpp.
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

/// The relative velocity of the two rigid bodies of a pair.
inline PairRate pair_rate(const Kinematics& now, RigidIndex a, RigidIndex b) {
  const double* va = &now.pose_rate[3 * static_cast<size_t>(a)];
  const double* vb = &now.pose_rate[3 * static_cast<size_t>(b)];
  return {va[0] - vb[0], va[1] - vb[1], va[2], vb[2]};
}

/// The data that all pairs of a step share.
struct PairScene {
  const Surfaces& surfaces;
  double thickness;                 ///< m
  const Kinematics* now = nullptr;  ///< null without friction
  double dt = 0;                    ///< s
};

/// The spring of a patch that did not exist in the step before.
inline const Spring kNoSpring{};

/// A pair, or one of its contact patches, with its memory and the places of its results.
struct PairWork {
  RigidIndex a, b;
  const PairIntegral* integral;
  const PairLaw* law;
  PairLoad* load;
  const Spring* before = &kNoSpring;  ///< the spring in the step before
  bool begins = true;                 ///< true if the pair had no patch in the step before
  Spring* now = nullptr;  ///< the spring of this step, without its key; null without friction
  PairLedger* ledger = nullptr;  ///< null without friction
};

/// Finds the friction of work.size() contact patches, at most kComparedLanes. The results that
/// `work` points to are not written.
void find_patch_friction(const PairScene& scene, std::span<const PairWork> work,
                         PatchFriction<double>* friction);
/// Adds the dashpots of a contact patch of two bodies. Returns false if it has none, because its
/// force has no direction. `spring` is the force of the friction spring in the patch, N.
bool add_dashpot(const PairScene& scene, const std::pair<RigidIndex, RigidIndex>& bodies,
                 const PairIntegral& patch, const PairLaw& law, double spring, Dashpots& dashpots);
/// Finds the load of a pair from its normal force and the given friction. The last two arguments
/// are the stiffnesses of its friction springs for the two bodies.
void load_pair(const PairScene& scene, const PairWork& work, const PairForce& friction,
               const BodyStiffness& body_stiffness_a, const BodyStiffness& body_stiffness_b);

/// Pairs with at most one contact patch, collected until a pack of them is full.
class PairBatch {
 public:
  void add(const PairScene& scene, bool rough, const PairWork& work) {
    if (rough != rough_) flush(scene);
    rough_ = rough;
    work_[static_cast<size_t>(count_)] = work;
    if (++count_ == kAtOnce) flush(scene);
  }
  /// Computes the step of all pairs that have been added.
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
    PairLedger ledger;
  } padding_ = {};
};

}  // namespace apothem
