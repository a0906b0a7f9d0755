// The normal damping of a pair of rigid bodies along the path of a step in which their contact
// begins or ends, or in which damping begins or ceases to take the whole force.
#pragma once

#include <span>

#include "geometry/integrals/edge_integral.hpp"
#include "lib/contact/law/onset_rule.hpp"
#include "lib/contact/law/patch_laws.hpp"

namespace apothem {

/// The law and the bodies of a pair.
struct DampedPair {
  double stiffness;  ///< k_n times the thickness, N/m
  double ratio;      ///< of critical damping
  double slope_a, slope_b;
  std::array<double, 3> inverse_mass_a, inverse_mass_b;
  double dt;      ///< s
  PairRate rate;  ///< of the drift
};

/// A sample of the path: the integrals for unit stiffness, and the mass centre of a minus that of
/// b.
struct DampedSample {
  PairIntegral integral;
  Vec2 between;
};

struct PathDamping {
  PairForce mean;       ///< over the step, N and N m
  double net_mean = 0;  ///< the mean size of the normal force with it, N
};

/// `samples` and `at` are those of find_onset_samples from theta = 0 to 1. As the law of a step
/// (damp in patch_laws.hpp): the time 2 ratio/omega times the rate of the force, and never so much
/// that the contact would pull.
PathDamping damping_along(const DampedPair& pair, std::span<const OnsetSample> samples,
                          std::span<const DampedSample> at);

}  // namespace apothem
