// Points in a mesh.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "mesh/mesh.hpp"

namespace apothem {

/// A material point: an element and the shares of its corners, which sum to one. The point is the
/// same combination of the corners' places, and what the elements interpolate at it is that of
/// their values.
struct MeshPoint {
  int element;
  std::vector<double> weights;  ///< one per corner
};

/// The element that holds p, the first of those that share it; a point outside by up to 1e-9 of the
/// mesh's size belongs to the nearest element; none farther away. Looks at every element. Weights
/// are barycentric in triangles, those of the bilinear map in convex quadrilaterals, and mean-value
/// coordinates in all others (M. Floater, Comput. Aided Geom. Des. 20 (2003)).
std::optional<MeshPoint> find_point(const Mesh& mesh, const Vec2& p);

/// Of a point in or hardly outside the element. The first form takes its corners relative to the
/// point, where they are now, and fills one weight for each.
void interpolation_weights(std::span<const Vec2> ring, std::span<double> weights);
std::vector<double> interpolation_weights(const Mesh& mesh, int element, const Vec2& p);

}  // namespace apothem
