// Finds points in a mesh and their interpolation weights.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "lib/mesh/mesh.hpp"

namespace apothem {

/// A material point of a mesh: an element and a weight for each of its corners; the weights sum to
/// one. The same weighted sum of the corners' positions or of any nodal values gives the position
/// of the point or the interpolated value.
struct MeshPoint {
  int element;
  std::vector<double> weights;  ///< one per corner
};

/// The point `p` (m) as a material point of the element that contains it, the lowest one of
/// several. A point outside the mesh by up to 1e-9 of its size belongs to the nearest element; one
/// farther away to none. The search visits every element. Weights are barycentric coordinates in
/// triangles, those of the bilinear map in convex quadrilaterals, and mean-value coordinates in all
/// other elements (M. Floater, Comput. Aided Geom. Des. 20 (2003)).
std::optional<MeshPoint> find_point(const Mesh& mesh, const Vec2& p);

/// The interpolation weights, as in find_point, of a point in the element or outside by round-off.
/// `ring` holds the positions of its corners relative to the point, m, in any configuration;
/// `weights` receives one weight for each.
void interpolation_weights(std::span<const Vec2> ring, std::span<double> weights);
/// The same for the point `p` (m) of an element in the reference configuration.
std::vector<double> interpolation_weights(const Mesh& mesh, int element, const Vec2& p);

}  // namespace apothem
