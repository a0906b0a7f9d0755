// Private header: polygons in which decisions about sides and directions are hard. They have almost
// straight vertices, vertices that almost coincide, and structure that repeats (steps, teeth and
// notches of one size), all of it next to reflex vertices, in many sizes and turns.
#pragma once

#include <vector>

#include "apps/cases/samples.hpp"

namespace apothem::samples {

/// Steps of the same width and height, with the corner below them at the origin.
Polygon stairs(int steps, double width, double height);
/// Bar of height 1 with notches of width 1 at equal distances, rectangular or with the shape of
/// wedges.
Polygon notched_bar(int notches, double depth, bool wedges);

/// A polygon, and the same with vertices that it does not need.
struct NearDegenerate {
  Polygon plain;    ///< without the needless vertices
  Polygon polygon;  ///< with them
};

/// A random outline, turned, scaled and shifted. No point of the boundary of `polygon` is farther
/// from that of `plain` than about `most` times the size, m/m.
NearDegenerate near_degenerate(Random& random, double most);

/// Two of them, or one in a large square, or one on itself, with an exact or random contact.
struct NearDegeneratePair {
  NearDegenerate a, b;
};
NearDegeneratePair near_degenerate_pair(Random& random, double most);

}  // namespace apothem::samples
