// Shapes of blocks for packings: counter-clockwise rings about their centroid, of area 1 m^2.
#pragma once

#include <vector>

#include "geometry/polygon/polygon.hpp"
#include "geometry/polygon/random_numbers.hpp"

namespace apothem {

/// A convex quadrilateral: corners at 90 degrees plus up to `turn` (rad) either way, at distances
/// between .5 and .72 of each other, drawn anew until all angles lie between `smallest` and
/// `largest` (rad). Throws std::invalid_argument if a thousand draws give none.
std::vector<Vec2> random_quadrilateral(RandomNumbers& random, double smallest, double largest);

/// A convex polygon inscribed in an ellipse with this ratio of its axes. `roundness` from 0 to 1:
/// with 1 the corners divide the circle that the ellipse is stretched from evenly; below, each may
/// be off by (1 - roundness) / 2 of the distance of two corners either way.
std::vector<Vec2> random_polygon(RandomNumbers& random, int corners, double aspect,
                                 double roundness);

/// A cross whose four arms are as wide as the square in the middle and `arm` times as long.
std::vector<Vec2> cross_shape(double arm);

/// A ring moved to its centroid and scaled to area 1; its vertices turn counter-clockwise. The ring
/// must be simple.
std::vector<Vec2> normalised(std::vector<Vec2> ring);
/// A polygon with holes, moved to the centroid of its outer ring and scaled to area 1, which does
/// not include the holes.
PolygonWithHoles normalised_with_holes(const Polygon& polygon);

/// The ring turned by `angle` (rad), scaled and moved to `place`. `place_into` writes it into
/// `result`.
std::vector<Vec2> placed(const std::vector<Vec2>& ring, const Vec2& place, double angle,
                         double scale);
void place_into(const std::vector<Vec2>& ring, const Vec2& place, double angle, double scale,
                std::vector<Vec2>& result);

}  // namespace apothem
