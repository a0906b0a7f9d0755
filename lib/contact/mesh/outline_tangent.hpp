// The tangent stiffness of the contact of outlines: the forces between an edge and a face with
// their derivatives by the vertices of both (geometry/integrals/collar.hpp with numbers that carry
// them). What a saturated region adds does not count, so that Newton's method takes more iterations
// where contacts are deeper than a collar.
#pragma once

#include <vector>

#include "geometry/integrals/collar.hpp"
#include "geometry/polygon/point.hpp"
#include "lib/contact/surface/outline_surfaces.hpp"
#include "lib/execution/dual.hpp"
#include "lib/solver/tangent.hpp"

namespace apothem {

/// The coordinates that move a vertex: those of its node, or the three of its rigid body.
struct VertexCoordinates {
  int count;
  std::array<size_t, 3> coordinate;
  std::array<Vec2, 3> along;  ///< displacement of the vertex by each of them, m/m or m
};
/// Node i has the coordinates first_node + 2 i and the next one, rigid body i has 3 i to 3 i + 2.
VertexCoordinates coordinates_of(const OutlineSurfaces& outlines, size_t first_node, int vertex);

/// An edge and a face with their derivatives by the vertices that they depend on.
struct MovingEdgeFace {
  /// Both vertices of the edge, both of the face, and the next ones of these, which turn the
  /// bisectors.
  static constexpr size_t kVertices = 6;
  enum Place : size_t { at_p, at_q, at_a, at_b, before_a, after_b };
  /// Derivatives 2 i and 2 i + 1 are those by x and y of vertex i.
  using Number = Dual<16>;
  struct Spot {
    Number x, y;
  };
  struct Line {
    Number tx, ty, length;
    Line(const Spot& from, const Spot& to);
  };

  /// The edge that begins at the vertex p, and the face that begins at a.
  MovingEdgeFace(const OutlineSurfaces& outlines, int p, int a);

  std::array<int, kVertices> vertex;
  std::array<Spot, kVertices> spots;
  Line edge, base;
  bool meet;  ///< false if the edge misses the face; then there is no piece
  CollarPiece<Number> piece;
};

/// Adds minus the derivatives of forces on p, q, a and b, N.
void add_tangent_of_forces(const OutlineSurfaces& outlines, size_t first_node,
                           const std::array<int, MovingEdgeFace::kVertices>& vertex,
                           const std::array<MovingEdgeFace::Spot, 4>& forces, Tangent& tangent);

/// Adds minus the derivatives of the normal forces between the edge that begins at the vertex p and
/// the face that begins at a. `slope` is the stiffness over the reference length, N/m^2.
void add_edge_face_tangent(const OutlineSurfaces& outlines, size_t first_node, int p, int a,
                           double slope, Tangent& tangent);

/// A linear function of the displacements, as its coefficients.
class CoordinateSum {
 public:
  void clear() { terms_.clear(); }
  /// Adds the displacement of a vertex times a vector.
  void add(const VertexCoordinates& vertex, const Vec2& times);
  /// Adds k times the square of the function, as a matrix.
  void add_square(double k, Tangent& tangent) const;

 private:
  struct Part {
    size_t coordinate;
    double value;
  };
  std::vector<Part> terms_;
};

}  // namespace apothem
