// What touching pairs of rigid bodies do to their bodies: the force, and how stiff the contact
// holds them, four pairs at a time.
#pragma once

#include <span>
#include <vector>

#include "apothem/contact/kernel.hpp"
#include "apothem/contact/pair_integrals.hpp"
#include "apothem/contact/pair_table.hpp"
#include "apothem/contact/pair_vector.hpp"
#include "apothem/contact/patch_batch.hpp"
#include "apothem/contact/stiffness.hpp"

namespace apothem {

/// The force of a pair, with its friction and damping.
struct PairLoad {
  PairForce force;  ///< on a, N, with the moments about both mass centres, N m
  RigidIndex a, b;
};

/// The touching pairs of a step. Lists are in their order.
struct TouchingPairs {
  const Surfaces& surfaces;
  const PairTable& table;
  double thickness;  ///< m
  std::span<const PairInTouch> pairs;
  std::span<const TangentialForce> tangential;  ///< empty where no pair has any
};

/// Finds the loads of the touching pairs from number `first` to `end`, and how they hold their
/// bodies. `held` has the stiffness of their friction springs where there are tangential forces,
/// and gets the sum. Returns the largest normal force, the first one of equals.
PairPeak find_loads(const TouchingPairs& all, int first, int end, std::span<PairLoad> loads,
                    std::span<PairStiffness> held);

}  // namespace apothem
