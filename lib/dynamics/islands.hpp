// Islands of rigid bodies at rest, which are not computed until something moves near them.
//
// An island is a group of bodies that are near each other, directly or through others; bodies that
// cannot move do not connect. It rests when none of its bodies has moved noticeably for long
// enough: then it is held where it is. It is woken when a body that moves comes near one of its
// bodies, before they touch.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "geometry/polygon/disjoint_sets.hpp"
#include "geometry/spatial/boxes.hpp"
#include "lib/archive/archive.hpp"
#include "lib/dynamics/quiet_motion.hpp"
#include "lib/dynamics/term.hpp"
#include "lib/model/model.hpp"
#include "lib/model/settings.hpp"

namespace apothem {

class Islands {
 public:
  /// True if bodies may rest while others move: rigid ones, with the scheme `auto`, where no force
  /// depends on time.
  static bool needed(const Model& model, const TimeSettings& time,
                     std::span<const std::unique_ptr<Term>> terms);
  /// The model and `dofs` must outlive this object.
  Islands(const Model& model, const DegreesOfFreedom& dofs, const TimeSettings& time,
          const State& state);

  /// To be called at regular times. True if bodies have come to rest. `near`: all pairs of surfaces
  /// that are near each other; surfaces of elements are not among them.
  bool look(const State& state, std::span<const BoxPair> near);
  /// Wakes the islands that a moving body is near. True if there are any.
  bool wake(const State& state, std::span<const BoxPair> near);
  bool wake_all(const State& state);
  /// From now on nothing comes to rest.
  void end() { ended_ = true; }

  /// Of each rigid body: 1 if it rests.
  [[nodiscard]] const std::vector<std::uint8_t>& resting() const { return resting_; }
  [[nodiscard]] bool is_resting(BodyIndex body) const {
    return static_cast<size_t>(body) < resting_.size() && resting_[static_cast<size_t>(body)] != 0;
  }
  /// How many bodies rest now, and how often one has come to rest and has been woken.
  [[nodiscard]] std::int64_t count() const;
  [[nodiscard]] std::int64_t stopped() const { return stopped_; }
  [[nodiscard]] std::int64_t woken() const { return woken_; }

  void fields(Archive& archive);

 private:
  // Follows bodies for a part of the run.
  struct Watch {
    double part;               // of the run
    std::vector<double> from;  // of each coordinate: where the body was when it last moved, m, rad
    std::vector<double> since{};  // of each body: when that was, s
  };
  [[nodiscard]] bool is_still(const State& state, const Watch& watch, RigidIndex body) const;
  [[nodiscard]] bool has_rested(const State& state, RigidIndex body) const;
  [[nodiscard]] bool joins(BodyIndex body) const;
  void join(std::span<const BoxPair> near, bool only_resting);
  static void begin_again(const State& state, Watch& watch, RigidIndex body);
  void rouse(const State& state, RigidIndex body);

  const Model& model_;
  const DegreesOfFreedom& dofs_;
  QuietMotion quiet_;
  DisjointSets sets_;
  std::vector<std::uint8_t> resting_;
  std::vector<Watch> watches_;
  double end_;                  // of the run, s
  std::vector<double> fall_;    // of each rigid body: what falls must have been seen to move, s
  std::vector<double> factor_;  // of each rigid body: on the times for which it must rest
  bool ended_ = false;
  std::int64_t stopped_ = 0, woken_ = 0;
};

}  // namespace apothem
