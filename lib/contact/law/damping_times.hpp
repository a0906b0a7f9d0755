// How strong the dashpots of bodies with a mesh are: time constants beside the springs of their
// contacts. The ratio of critical damping is that of the two bodies as rigid ones on all springs
// between them (docs/theory.md, Friction and damping).
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "geometry/spatial/boxes.hpp"
#include "lib/contact/law/pair_table.hpp"
#include "lib/contact/law/stiffness.hpp"

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

  /// What bounds the frequency of the nodes of a body in contact.
  struct Nodes {
    double slope = 0;  ///< of the body's potential, the steepest, 1/m
    double share = 0;  ///< largest of a node that can move: half of its edges over its mass, m/kg
  };
  /// `nodes` of each body. No dashpot takes more than the speed of a node in a step. The bound of a
  /// pair depends on nothing else than its two bodies as they were given, so that the others in the
  /// scene have no say in their damping. `thickness`, m.
  void limit(std::vector<Nodes> nodes, double thickness) {
    nodes_ = std::move(nodes);
    thickness_ = thickness;
  }

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
      const double rate = rate_of_nodes(pair, law);
      pair.normal_time = time(law.damping.normal, pair.normal, rate);
      pair.tangential_time = time(law.damping.tangential, pair.tangential, rate * softer);
    }
  }

 private:
  // Bound of w^2 of the contact of any node of the two bodies, 1/s^2.
  [[nodiscard]] double rate_of_nodes(const Pair& pair, const PairLaw& law) const {
    if (nodes_.empty()) return 0;
    const Nodes &a = nodes_[pair.a], &b = nodes_[pair.b];
    return node_rate(law.normal_stiffness * thickness_, a.slope + b.slope,
                     std::max(a.share, b.share));
  }

  const PairTable& table_;
  const std::vector<double>& inverse_mass_;
  std::vector<Nodes> nodes_;
  double thickness_ = 0;
  std::vector<Pair> pairs_;
};

}  // namespace apothem
