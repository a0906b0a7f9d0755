// What touching pairs of rigid bodies do to their bodies: the normal force, and how stiff the
// contact holds them, four pairs at a time.
#pragma once

#include <span>
#include <vector>

#include "apothem/contact/pair_integrals.hpp"
#include "apothem/contact/pair_vector.hpp"
#include "apothem/contact/stiffness.hpp"

namespace apothem {

/// The normal force of a pair.
struct PairLoad {
  PairForce force;  ///< on a, N, with the moments about both mass centres, N m
  RigidIndex a, b;
};

/// The touching pairs of a step. Lists are in their order.
struct TouchingPairs {
  const Surfaces& surfaces;
  const PairIntegrals& pairs;
  std::span<const int> touching;
  std::span<const double> stiffness;          ///< k_n times the thickness, N/m
  std::span<const double> contact_stiffness;  ///< of the contact (Contact::stiffness), N/m
};

/// Finds the loads of the touching pairs from number `first` to `end`, and how they hold their
/// bodies. `held` has the stiffness of their friction springs where there are any (`springs`), and
/// gets the sum. Returns the number of the pair with the largest force, the first one of equals.
int find_loads(const TouchingPairs& all, int first, int end, bool springs,
               std::span<PairLoad> loads, std::span<PairStiffness> held);

}  // namespace apothem
