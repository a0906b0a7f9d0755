// The boundary of a body that can come to lie on another one, before it does: what the stiffness of
// a contact, and so the time step, follows from.
#pragma once

#include <vector>

#include "lib/model/model.hpp"

namespace apothem {

/// A part of a body's boundary that pushes in one direction: a strip across the line of action.
struct Landing {
  double length;    ///< of boundary, across the direction, m
  double breadth;   ///< of the strip, m
  double arm;       ///< of its middle, across the direction, from the mass centre, m
  double height;    ///< of the mass centre over it, m
  double mobility;  ///< of the body against a force spread over the strip, 1/kg: strip_mobility()
  double slide;     ///< the same against a force along it, 1/kg
  int pieces;       ///< of boundary that are not connected, at twice the depth
};

/// All landings of a body that may be the stiffest of a contact: the straight parts of its
/// boundary, and at each edge of its convex hull all boundary down to the depth at which a flat
/// partner has taken up an energy: the integral of (depth - x) length(x) over x from 0 to the depth
/// is `compliant_energy`, m^3 (energy over k_n, the sum of the slopes 1/r and the thickness).
/// Vertices in the middle of a straight part change nothing.
std::vector<Landing> landings(const RigidBody& body, double compliant_energy);

/// For each body of a model, the speed that its fastest point may reach, m/s: at the start, by its
/// own motion if it is prescribed, or by falling through the height of the scene.
std::vector<double> fastest_speeds(const Model& model);

}  // namespace apothem
