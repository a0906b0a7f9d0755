// The loads of all touching pairs on each rigid body, summed in the order of the pairs.
//
// A thread adds a load to its body immediately, unless the body may also touch in an earlier pair,
// which another thread works on. Such loads are deferred until all threads are done. So every sum
// is taken in the order of the pairs and has the same bits for any number of threads.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "geometry/spatial/boxes.hpp"
#include "lib/contact/law/kinematics.hpp"
#include "lib/contact/rigid/pair_integrals.hpp"
#include "lib/contact/rigid/pair_load.hpp"
#include "lib/contact/surface/surfaces.hpp"
#include "lib/execution/parallel.hpp"

namespace apothem {

class BodyLoads {
 public:
  BodyLoads(const Surfaces& surfaces, int threads);

  /// Sets the pairs that may touch, which ascend.
  void set_pairs(std::span<const BoxPair> pairs);
  /// Begins the work of one thread in a step. `first` is the first body of its first pair, or -1 if
  /// no other thread has earlier pairs.
  void begin(int worker, RigidIndex first) { workers_[static_cast<size_t>(worker)].begin(first); }
  void add(int worker, RigidIndex body, const BodyLoad& load) {
    DeferredLoads& deferred_loads = workers_[static_cast<size_t>(worker)];
    if (deferred_loads.first >= 0 &&
        first_partner_[static_cast<size_t>(body)] <= deferred_loads.first) {
      deferred_loads.deferred.push_back({load, body});
    } else {
      sums_[static_cast<size_t>(body)].add(load);
    }
  }
  /// Adds the deferred loads, after all threads are done.
  void end();
  /// Adds the sums to the forces and to the bounds of the rates, and clears the sums.
  void add_to(const ForceViews& forces, std::span<const PairInTouch> touching);

 private:
  struct DeferredLoad {
    BodyLoad load;
    RigidIndex body;
  };
  // The loads that one thread has deferred.
  struct DeferredLoads {
    RigidIndex first = -1;
    std::vector<DeferredLoad> deferred;
    void begin(RigidIndex body) {
      first = body;
      deferred.clear();
    }
  };

  // The squared frequency w^2 of the contact stiffness of a body, and the largest one of its
  // partners, 1/s^2.
  struct Rate {
    double own = 0, partner = 0;
    bool exact = false;  // true if `own` is exact, and not an upper bound
  };
  [[nodiscard]] const std::array<double, 3>& inverse_mass(size_t body) const {
    return surfaces_.rigid(static_cast<RigidIndex>(body)).inverse_mass;
  }
  void find_rates(double limit, std::span<const PairInTouch> touching);

  const Surfaces& surfaces_;
  Threads threads_;
  std::vector<BodyLoad> sums_;             // sum of the loads of each rigid body
  std::vector<RigidIndex> busy_;           // the bodies that have pairs, ascending
  std::vector<RigidIndex> first_partner_;  // for each body, the lowest number among itself and the
                                           // bodies that it may touch
  std::vector<DeferredLoads> workers_;
  std::vector<Rate> rates_;      // rates of each rigid body
  std::vector<double> fastest_;  // largest rate found by each thread
};

}  // namespace apothem
