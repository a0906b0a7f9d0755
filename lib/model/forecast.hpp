// What a run will probably see, from closed formulas: how deep bodies press into each other, and
// how long they fall.
#pragma once

#include <span>

#include "lib/model/model.hpp"

namespace apothem {

/// A depth of contact and the body with the largest share of its inradius.
struct ExpectedDepth {
  double depth = 0;   ///< flat on the other body, m
  double corner = 0;  ///< by the body's sharpest corner, m; 0 if it has none
  double share = 0;   ///< the larger of the two, of the body's inradius
  BodyIndex body = -1;
};

/// Bodies flat on each other press with p = k_n (1/r_a + 1/r_b) depth. A corner of the angle 2
/// alpha of body b, with the depth h at its tip, holds the energy k_n (1/r_a + sin(alpha)/r_b)
/// tan(alpha) h^3 / 3 per thickness.
struct Forecast {
  /// Under the weight of a pile as high as all free bodies together: p = density g height.
  ExpectedDepth by_weight;
  /// Of the first impact on something fixed, at the speeds of the start and after the free fall
  /// onto what lies below: the energy of contact is m v^2 / 2. Of two free bodies that meet it is
  /// at most that of both. Flat on another one, a body with a mesh presses with about the pressure
  /// of its elastic wave, density c v.
  ExpectedDepth by_speed;
  /// When the last body has fallen freely onto what lies below it, from its speed at the start, s;
  /// 0 if none falls.
  double last_landing = 0;
};

/// `slopes`: 1/r of the potential of each body, rigid ones first, 1/m.
Forecast forecast(const Model& model, std::span<const double> slopes);

/// Normal stiffnesses k_n, Pa; 0 where no free body has a weight or a speed.
struct NeededStiffness {
  double flat = 0;    ///< for the weight of the pile, and for first impacts that are flat
  double corner = 0;  ///< for first impacts by the sharpest corner
};

/// The smallest normal stiffnesses, rounded up to two digits, with which no body presses deeper
/// into another one than `share` of the smallest inradius of all bodies, by the formulas of
/// Forecast; a pile that is not pressed at first sinks twice as deep as it rests. Meshes count with
/// the surface of a body, and rules for pairs not at all.
NeededStiffness stiffness_for(const Model& model, double share);

}  // namespace apothem
