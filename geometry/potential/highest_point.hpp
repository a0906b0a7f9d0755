// The highest point of a lower envelope of planes over a triangle. This header is private to the
// search for inscribed circles.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace apothem {

/// Heights of a plane at the three corners of a triangle.
using Heights = Eigen::Vector3d;

/// The highest point of a lower envelope of planes over a triangle.
struct Summit {
  Heights place = Heights(1, 0, 0);  ///< barycentric coordinates
  double height = HUGE_VAL;          ///< upper bound of the height
};

/// Finds the highest point by Seidel's incremental linear programming, which takes time linear in
/// the number of planes if their order is random. A plane counts as below another one only if the
/// difference exceeds round-off, so that nothing is cut off wrongly where planes coincide or nearly
/// coincide.
Summit highest_point(const std::vector<Heights>& planes);

}  // namespace apothem
