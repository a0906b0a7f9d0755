// Which pairs have begun or ended to touch within a step, so that their impulses need a correction
// (onset_rule.hpp). The same for rigid bodies and for meshes.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <tuple>
#include <vector>

#include "lib/archive/archive.hpp"
#include "lib/contact/law/onset_rule.hpp"

namespace apothem {

/// A pair that touches: which vertices are inside the partner, as numbers that differ where the
/// sets do, the length of the boundaries inside, m, and whether the bodies are so deep in each
/// other that the force does not follow from the edges near surfaces alone.
struct TouchingPair {
  int a, b;
  std::uint64_t inside_a, inside_b;
  double length;
  double size, moment;  ///< of the normal force, N, and its moment over a length of the bodies, N;
                        ///< or 0, not known
  bool deep = false;

  [[nodiscard]] bool same_pair(const TouchingPair& other) const {
    return a == other.a && b == other.b;
  }
  [[nodiscard]] bool same_vertices(const TouchingPair& other) const {
    return inside_a == other.inside_a && inside_b == other.inside_b;
  }
  /// True if the force is the same but for so little that what a step misses of its impulse cannot
  /// matter: with a change of the part e of it, e^2/4 of the energy of the contact.
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
    archive("size", size)("moment", moment)("deep", deep);
  }
};

/// A pair whose contact has changed within a step.
struct PairChange {
  int a, b;
  int panels;       ///< of the samples
  int now, before;  ///< its number in the lists of the step and of the step before, or -1
};

class OnsetWatch {
 public:
  /// What touched becomes what touched before; the empty list is to be filled, ascending.
  std::vector<TouchingPair>& begin_step() {
    std::swap(now_, before_);
    now_.clear();
    return now_;
  }

  /// Calls changed(change), ascending, for every pair whose vertices inside each other have
  /// changed, unless its force has not. The stiffness of a pair grows with the boundary of one
  /// inside the other: where this changes by more than sudden(a, b), m, within a step, as where a
  /// body lands nearly flat, the force is not smooth even if no vertex enters or leaves. `panels`
  /// of the samples: more where it changes by much of itself. Steps that begin or end with the
  /// bodies deep in each other are left as they are.
  template <class Sudden, class Changed>
  void compare(const Sudden& sudden, const Changed& changed) const {
    auto old = before_.begin();
    const auto judge = [&](const TouchingPair& pair, bool same, double change, bool is_now,
                           bool was_before) {
      if (pair.deep) return;
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
      if (!known || (!old->deep && !old->same_force(pair))) {
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
