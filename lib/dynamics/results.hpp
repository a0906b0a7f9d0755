// What a simulation tells of its run besides the state.
#pragma once

#include <cstdint>
#include <vector>

#include "lib/archive/archive.hpp"
#include "lib/mesh/indices.hpp"

namespace apothem {

/// A largest value of a run: when, and of which two bodies.
struct Peak {
  double value = 0;
  double time = 0;  ///< s
  BodyIndex a = -1, b = -1;
  void fields(Archive& archive) { archive("value", value)("time", time)("a", a)("b", b); }
};

/// Largest values over all steps so far.
struct Extremes {
  Peak penetration;  ///< of a pair, m (geometry/integrals/penetration.hpp)
  /// Penetration of a pair over the inradius of the body where that is smaller.
  Peak relative_penetration;
  Peak force;  ///< size of the normal force of a pair of two bodies, N
  /// Largest |total_error| of the looks of the energy guard and of the records, J.
  double energy_error = 0;
  double energy_in_play = 0;  ///< see EnergyGuard, J
  /// What of it may be unaccounted for, J; infinite in static runs, whose load steps give off
  /// energy.
  double energy_allowed = 0;
};

/// Two bodies that overlap.
struct PairDepth {
  BodyIndex a, b;
  double depth;  ///< of the deepest of their contact patches, m
  double share;  ///< of the smaller inradius of the two
};

/// What contact counts, over all steps so far.
struct ContactCounts {
  std::int64_t searches = 0;
  std::int64_t candidate_pairs = 0;  ///< summed over the steps; of meshes edges and faces
  std::int64_t touching_pairs = 0;   ///< likewise
  int touching_now = 0;
  void fields(Archive& archive) {
    archive("searches", searches)("candidate_pairs", candidate_pairs)(
        "touching_pairs", touching_pairs)("touching_now", touching_now);
  }
};

/// What the implicit steps of a run were.
struct ImplicitCounts {
  std::int64_t steps = 0;       ///< that were taken
  std::int64_t ticks = 0;       ///< steps of velocity Verlet in their place
  std::int64_t rejected = 0;    ///< that were too long for the accuracy, or found no places
  std::int64_t phases = 0;      ///< of implicit steps one after the other
  std::int64_t iterations = 0;  ///< of Newton's method
  void fields(Archive& archive) {
    archive("steps", steps)("ticks", ticks)("rejected", rejected)("phases", phases)("iterations",
                                                                                    iterations);
  }
};

/// How the equilibrium of a load step was found.
struct LoadStep {
  double time = 0;              ///< s
  std::int64_t iterations = 0;  ///< of Newton's method, or steps of dynamic relaxation
  bool relaxed = false;         ///< true if it was found by dynamic relaxation
  /// Of the tangent stiffness: the number of ways to fall from the equilibrium; -1 if not known.
  int negative_pivots = -1;
  double residual = 0;        ///< norm of the nodal forces out of balance / norm of the loads
  double imbalance = 0;       ///< largest sum of the forces on a body / sum of their sizes
  BodyIndex worst = -1;       ///< the body with that imbalance
  BodyIndex unbalanced = -1;  ///< the body with most of the residual
  double load = 0;            ///< sum of the sizes of all weights, loads and reactions, N
  /// Size of the sum of all forces on each body, rigid ones first, N. Of a rigid body with that of
  /// the moments over its radius; 0 where it is not free.
  std::vector<double> off{};
  /// The free body that has moved farthest, beyond what prescribed motion does, if that is more
  /// than its inradius; and how far, m.
  BodyIndex moved = -1;
  double way = 0;
  bool complete = true;  ///< false: stopped on the way
  bool found = true;     ///< false: there is no equilibrium near the last one

  void fields(Archive& archive) {
    archive("time", time)("iterations", iterations)("residual", residual)("imbalance", imbalance)(
        "worst", worst)("load", load)("off", off)("relaxed", relaxed)(
        "negative_pivots", negative_pivots)("moved", moved)("way", way);
  }
};

}  // namespace apothem
