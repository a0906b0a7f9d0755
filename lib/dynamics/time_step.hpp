// Bounds of the time step that are known before a run.
#pragma once

#include <limits>
#include <string>

#include "lib/model/model.hpp"
#include "lib/model/settings.hpp"

namespace apothem {

/// A bound on the time step and what sets it.
struct StepLimit {
  double step = std::numeric_limits<double>::infinity();  ///< s; infinite if nothing limits it
  std::string reason = {};  ///< e.g. `contact of "falling" with "target"`
};

/// Limits of stability, which the terms find.
struct StepBounds {
  StepLimit bodies{.reason = "no contact can occur"};  ///< of the contacts of rigid bodies
  StepLimit nodes;                                     ///< of nodes with elements and contacts
};

/// lambda / (k_n x sum of the slopes 1/r) of a body that lies flat on its worst edge, m/kg.
double flat_mobility(const RigidBody& body);

/// Limit known before the run: every pair that can meet lies flat on each other along its stiffest
/// edges. Vertex contacts are softer.
StepLimit contact_step_limit(const Model& model);

/// Fraction of the smallest inradius that a body may move in one step without risking to miss a
/// contact.
inline constexpr double kLargestStride = 0.25;

/// Limit so that no body moves farther than that in one step, at the speeds the scene starts with
/// or gains by falling through its own height.
StepLimit motion_step_limit(const Model& model);

/// The step of a run.
struct StepChoice {
  double step = 0;       ///< s
  StepLimit limit;       ///< what limits it
  double stability = 0;  ///< largest stable step, s; infinite if nothing can touch
  /// An automatic step over the limit of the contacts of rigid bodies, and over that of the nodes.
  double safety = 0, element_safety = 0;
  bool damped = false;  ///< contacts of rigid bodies have dashpots
};

/// Parts of the limits of stability that keep the energy error of an impact below `accuracy` of its
/// energy: fits to the worst landings, nearly flat ones of squares and flat ones of meshed blocks
/// (docs/verification.md, "Contacts that begin or end within a step").
double contact_safety(double accuracy);
double element_safety(double accuracy);
/// The same for contacts of rigid bodies that are damped: keeps the kinetic energy that an impact
/// leaves to ten times the accuracy, in parts of that before it.
double damped_safety(double accuracy);

/// With an automatic step, `frames` equal intervals of the run get a whole number of steps each.
/// `node_contact`: nodes can touch something. Throws Unrunnable if a fixed step is above the
/// stability limit, or if the step makes no progress.
StepChoice choose_step(const Model& model, const TimeSettings& time, const StepBounds& bounds,
                       int frames, bool node_contact);

}  // namespace apothem
