// Detects contact events: pairs that began or ended to touch within a step, so that their impulses
// need a correction (event_impulse.hpp). Rigid bodies and meshes use the same detector.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <tuple>
#include <vector>

#include "lib/archive/archive.hpp"
#include "lib/contact/law/event_impulse.hpp"

namespace apothem {

/// A pair that touches: hashes of the sets of vertices inside the partner, the length of the
/// boundaries inside, m, and whether one body reaches into the saturated region of the other one,
/// so that the force does not follow from the edges near the surfaces alone.
struct TouchingPair {
  int a, b;
  std::uint64_t inside_a, inside_b;
  double length;
  double size, moment;  ///< normal force, N, and its moment over a length of the bodies, N; 0 if
                        ///< they are not known
  bool is_saturated = false;

  [[nodiscard]] bool same_pair(const TouchingPair& other) const {
    return a == other.a && b == other.b;
  }
  [[nodiscard]] bool same_vertices(const TouchingPair& other) const {
    return inside_a == other.inside_a && inside_b == other.inside_b;
  }
  /// True if the force has changed so little that its missing impulse cannot matter: a relative
  /// change e costs e^2/4 of the energy of the contact.
  [[nodiscard]] bool same_force(const TouchingPair& other) const {
    constexpr double kSame = 5e-4;
    const double most = kSame * std::max(size, other.size);
    return most > 0 && std::abs(size - other.size) <= most &&
           std::abs(moment - other.moment) <= most;
  }
  bool operator<(const TouchingPair& other) const {
    return std::tie(a, b) < std::tie(other.a, other.b);
  }
  void fields(Archive& archive) {
    archive("a", a)("b", b)("inside_a", inside_a)("inside_b", inside_b)("length", length);
    archive("size", size)("moment", moment)("deep", is_saturated);
  }
};

/// A pair whose contact has changed within a step.
struct PairChange {
  int a, b;
  int panels;       ///< number of panels of the samples
  int now, before;  ///< index in the lists of this step and of the step before, or -1
};

class EventDetector {
 public:
  /// The pairs of this step become those of the step before. Returns the empty list of this step,
  /// to be filled in ascending order.
  std::vector<TouchingPair>& begin_step() {
    std::swap(now_, before_);
    now_.clear();
    return now_;
  }

  /// Calls changed(change), in ascending order, for every pair whose sets of vertices inside each
  /// other have changed, unless the force is practically the same. The stiffness of a pair grows
  /// with the length of boundary inside the other body. Where this length changes by more than
  /// sudden(a, b), m, within a step, as where a body lands nearly flat, the force is not smooth
  /// even if no vertex enters or leaves; more panels are used where it changes by a large fraction
  /// of itself. Pairs that reach into a saturated region at the start or at the end of the step are
  /// skipped.
  template <class Sudden, class Changed>
  void compare(const Sudden& sudden, const Changed& changed) const {
    auto old = before_.begin();
    const auto judge = [&](const TouchingPair& pair, bool same, double change, bool is_now,
                           bool was_before) {
      if (pair.is_saturated) return;
      PairChange found{pair.a, pair.b, 1, is_now ? static_cast<int>(&pair - now_.data()) : -1,
                       was_before ? static_cast<int>(old - before_.begin()) : -1};
      if (change > sudden(pair.a, pair.b)) {
        found.panels = change > kMuch * pair.length ? kManyPanels : kFewPanels;
      } else if (same) {
        return;
      }
      changed(found);
    };
    for (const TouchingPair& pair : now_) {
      for (; old != before_.end() && *old < pair; ++old) {
        judge(*old, false, old->length, false, true);
      }
      const bool known = old != before_.end() && old->same_pair(pair);
      if (!known || (!old->is_saturated && !old->same_force(pair))) {
        judge(pair, known && old->same_vertices(pair),
              std::abs(pair.length - (known ? old->length : 0)), true, known);
      }
      if (known) ++old;
    }
    for (; old != before_.end(); ++old) judge(*old, false, old->length, false, true);
  }

  void fields(Archive& archive) { archive("touching", now_); }

 private:
  static constexpr double kMuch = .2;

  std::vector<TouchingPair> now_, before_;
};

}  // namespace apothem
