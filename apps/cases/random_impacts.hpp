// Private header: random impacts of two bodies, for tests and benchmarks. The same seed gives the
// same impact on every platform.
#pragma once

#include <cstdint>
#include <string>

#include "lib/model/model.hpp"
#include "lib/model/settings.hpp"

namespace apothem::samples {

/// What may happen in a random impact.
struct ImpactKind {
  bool fixed_partner = true;  ///< sometimes the second body cannot move
  bool friction = true;       ///< sometimes
  double damping = 0;         ///< largest ratio of normal and tangential dashpots; 0: none
  double least_damping = 0;   ///< smallest ratio
};

struct RandomImpact {
  Model model;
  double time = 0;      ///< s, that it takes at most until the bodies are apart for good
  std::string summary;  ///< what it is, in words
};

/// Two rigid bodies, convex or not, of 3 to 100 corners and a mass ratio of 1e-3 to 1e3, a little
/// before they touch: flat, tilted by up to half a radian, or anyhow.
RandomImpact random_impact(std::uint64_t seed, const ImpactKind& kind = {});

/// What an impact has left of the energy.
struct ImpactResult {
  double error = 0;          ///< total error after the separation, of the kinetic energy before
  double kept = 0;           ///< kinetic energy after it, of that before
  std::int64_t steps = 0;    ///< of which bodies touch
  std::int64_t changes = 0;  ///< of the step
  bool touched = false;
  std::string unstable;  ///< why the run has ended, if it has
};

/// The step that is chosen at the start, s.
double start_step(const RandomImpact& impact, const TimeSettings& time);

/// Runs until the bodies have been apart for some time. Energies are those of the velocities
/// relative to the common centre of mass where both bodies can move.
ImpactResult run_impact(const RandomImpact& impact, const TimeSettings& time);

}  // namespace apothem::samples
