// The limit of rigid bodies: a static run with ever stiffer contacts, and what its results tend to.
//
// Where bodies touch along edges and turn about corners, the pressed length shrinks like
// k_n^(-1/3) to k_n^(-1/2), and with it what the load factor of a collapse lacks. Such differences
// are too large to be ignored at any stiffness that double precision allows, but they are so
// regular that they can be extrapolated (docs/theory.md, Rigid limit).
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "lib/archive/archive.hpp"
#include "lib/model/model.hpp"
#include "lib/model/settings.hpp"

namespace apothem {

/// A value and how far it may be from the limit.
struct Estimate {
  double value = 0, error = 0;
};

/// What values at stiffnesses that grow by a factor of 10 tend to; at least three, each known to
/// within +- `noise`. Two laws are tried: a + b k^(-1/3) + c k^(-2/3), and a + b k^(-p) with the
/// exponent p that the last three values show. The one that has changed less with the last value
/// is taken; this change and what it makes of the noise are its error. Of three values alone the
/// first law is taken, and the difference of the laws instead of the change.
Estimate extrapolate(std::span<const double> values, double noise);

/// The same run with the stiffnesses of the scene times `scale`.
struct RigidPass {
  double stiffness = 0;         ///< k_n, Pa
  double lower = 0, upper = 0;  ///< load factors at which it stands, and collapses
  bool collapsed = false;
  void fields(Archive& archive) {
    archive("stiffness", stiffness)("lower", lower)("upper", upper)("collapsed", collapsed);
  }
  [[nodiscard]] double factor() const { return (lower + upper) / 2; }
};

struct RigidLimit {
  static constexpr double kTolerance = 1e-3;  ///< of the load factor, or of `change`

  std::vector<RigidPass> passes;
  /// Between the last two passes, at the end of runs that do not collapse: the longest way of a
  /// point of a free rigid body over its inradius, or of a node over the longest way that a node of
  /// its body has gone under the loads.
  double change = 0;
  void fields(Archive& archive) { archive("passes", passes)("change", change); }

  [[nodiscard]] bool collapses() const { return !passes.empty() && passes.back().collapsed; }
  /// Of the load factor at collapse; nothing if fewer than three passes tell.
  [[nodiscard]] std::optional<Estimate> factor() const;
};

/// The model with the stiffnesses of all contacts and friction springs times `scale`.
Model stiffened(Model model, double scale);

/// The largest k_n (Pa) for which the rounding of places changes the forces on no body by more
/// than a two-millionth of its weight or, of a body with a mesh and where nothing has weight, of
/// what presses on it: `forces` (N), of rigid bodies first. Where these are not known yet, it may
/// be empty.
double stiffest(const Model& model, std::span<const double> forces);

/// Passes from the model's own stiffness on, or from a thousandth of stiffest() if that is less,
/// each with ten times the stiffness of the one before, until the results stand still within
/// RigidLimit::kTolerance or stiffest() is reached. Throws Stopped if `stop` says so.
RigidLimit find_rigid_limit(const Model& model, const TimeSettings& time, int threads,
                            const std::function<bool()>& stop);

}  // namespace apothem
