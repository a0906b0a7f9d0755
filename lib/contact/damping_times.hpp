// How strong the dashpots of bodies with a mesh are: time constants beside the springs of their
// contacts. The ratio of critical damping is that of the two bodies as rigid ones on all springs
// between them (docs/theory.md, Friction and damping).
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "apothem/contact/pair_table.hpp"
#include "apothem/geometry/spatial/boxes.hpp"

namespace apothem {

class DampingTimes {
 public:
  struct Pair {
    BodyIndex a, b;         ///< a < b
    double normal = 0;      ///< stiffness of the contact, N/m
    double tangential = 0;  ///< of the friction springs, N/m
    /// Dashpots over springs, s.
    double normal_time = 0, tangential_time = 0;
  };

  /// `inverse_mass` of each body, 1/kg. Both must outlive this object.
  DampingTimes(const PairTable& table, const std::vector<double>& inverse_mass)
      : table_(table), inverse_mass_(inverse_mass) {}

  /// `rate`: bound of w^2 of the contact of any node, 1/s^2. No dashpot takes more than the speed
  /// of a node in a step.
  void limit(double rate) { largest_rate_ = rate; }

  /// The pairs of bodies that may touch, in any order, also twice.
  template <class Bodies>
  void take(const Bodies& bodies) {
    pairs_.clear();
    for (const auto& [a, b] : bodies) pairs_.push_back({std::min(a, b), std::max(a, b)});
    const auto key = [](const Pair& p) { return std::pair(p.a, p.b); };
    std::ranges::sort(pairs_, {}, key);
    const auto same = [&](const Pair& p, const Pair& q) { return key(p) == key(q); };
    pairs_.erase(std::unique(pairs_.begin(), pairs_.end(), same), pairs_.end());
  }
  [[nodiscard]] int index(BodyIndex a, BodyIndex b) const {
    const std::pair<BodyIndex, BodyIndex> key = std::minmax(a, b);
    const auto found = std::ranges::lower_bound(pairs_, key, {},
                                                [](const Pair& p) { return std::pair(p.a, p.b); });
    return static_cast<int>(found - pairs_.begin());
  }
  [[nodiscard]] Pair& operator[](int index) { return pairs_[static_cast<size_t>(index)]; }
  [[nodiscard]] Pair& of(BodyIndex a, BodyIndex b) { return (*this)[index(a, b)]; }

  /// Before the stiffnesses of a step are summed up, and after.
  void begin_step() {
    for (Pair& pair : pairs_) pair.normal = pair.tangential = 0;
  }
  void end_step(double dt) {
    for (Pair& pair : pairs_) {
      pair.normal_time = pair.tangential_time = 0;
      if (pair.normal == 0 && pair.tangential == 0) continue;
      const PairLaw& law = table_.between(pair.a, pair.b);
      const double mobility = inverse_mass_[pair.a] + inverse_mass_[pair.b];
      const double softer = law.friction.tangential_stiffness / law.normal_stiffness;
      const auto time = [&](double ratio, double stiffness, double rate) {
        if (!(ratio > 0 && stiffness > 0 && mobility > 0)) return 0.;
        const double longest = rate > 0 ? 1 / (rate * dt) : HUGE_VAL;
        return std::min(2 * ratio / std::sqrt(stiffness * mobility), longest);
      };
      pair.normal_time = time(law.damping.normal, pair.normal, largest_rate_);
      pair.tangential_time = time(law.damping.tangential, pair.tangential, largest_rate_ * softer);
    }
  }

 private:
  const PairTable& table_;
  const std::vector<double>& inverse_mass_;
  double largest_rate_ = 0;
  std::vector<Pair> pairs_;
};

}  // namespace apothem
