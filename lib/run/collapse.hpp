// How a static run ends whose loads cannot be carried any more.
#pragma once

#include <string>
#include <vector>

#include "lib/archive/archive.hpp"
#include "lib/model/model.hpp"
#include "lib/model/state.hpp"
#include "lib/run/rigid_limit.hpp"

namespace apothem {

/// A limit of the loads: there is an equilibrium at `lower`, and none near it at `upper`.
struct Collapse {
  double lower = 0, upper = 0;  ///< load factors: times of the load histories
  /// How the bodies begin to move at the limit: the change of all coordinates in the failing load
  /// step, which is not an equilibrium.
  std::vector<double> motion = {};
  double scale = 1;  ///< of the motion in the frame that shows it
  int frame = -1;    ///< its number; -1: no frame is written
  /// Of the load factor for rigid bodies, if the scene asks for that and it is known.
  std::optional<Estimate> rigid = {};

  [[nodiscard]] double factor() const { return rigid ? rigid->value : (lower + upper) / 2; }
  /// How far the factor may be from the limit of this model.
  [[nodiscard]] double error() const { return rigid ? rigid->error : (upper - lower) / 2; }
};

/// How a body takes part in a mechanism: the motion of its mass centre and its rotation; of a body
/// with a mesh those of its nodes in the mean.
struct MovingBody {
  BodyIndex body;
  double x, y;   ///< m
  double angle;  ///< rad
  double most;   ///< of its points, the longest way, m
};

/// The bodies that move by more than a hundredth of the longest way of all.
std::vector<MovingBody> moving_bodies(const Model& model, const State& state,
                                      const std::vector<double>& motion);

/// Whether the motion is that of a mechanism: over a load step as short as LoadPath::kResolution
/// some body moves by more than a hundredth of its inradius, or of its size if it has a mesh. Where
/// nothing does, the equilibrium has not been found for another reason.
bool is_mechanism(const Model& model, const State& state, const std::vector<double>& motion);

/// Scales the motion to a twentieth of the size of all free bodies together.
double shown_scale(const Model& model, const State& state, const std::vector<double>& motion);

/// "collapses at load factor 0.3531 (between 0.35306 and 0.35314); 12 of 27 bodies move, ..."
std::string describe(const Model& model, const State& state, const Collapse& collapse);

}  // namespace apothem
