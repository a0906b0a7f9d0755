// The depth of edges of outlines inside bodies, as the Euclidean distance from the whole boundary.
#pragma once

#include <vector>

#include "geometry/integrals/collar.hpp"
#include "geometry/integrals/penetration.hpp"
#include "lib/contact/surface/outline_surfaces.hpp"

namespace apothem {

class OutlineDepths {
 public:
  /// `outlines` must outlive this object.
  explicit OutlineDepths(const OutlineSurfaces& outlines)
      : outlines_(outlines), boundaries_(outlines.bodies.size()) {}

  /// True if the height of a piece in a face is certainly its depth. Where faces overlap it may not
  /// be, and the piece may even lie outside the body.
  [[nodiscard]] bool is_depth(int face, const CollarPiece<double>& piece) const;
  /// Must be called when the outlines have moved.
  void forget();
  /// The largest depth of a piece of an edge in a face, m, or `floor` if it is not larger.
  [[nodiscard]] double of_piece(int edge, int face, const CollarPiece<double>& piece, double floor);
  /// The largest depth of all parts of an edge that lie inside a body, m, or `floor` if it is not
  /// larger.
  [[nodiscard]] double of_edge(int edge, BodyIndex body, double floor);

 private:
  BoundaryDistance& boundary(BodyIndex body);

  const OutlineSurfaces& outlines_;
  std::vector<BoundaryDistance> boundaries_;  // boundaries of the bodies that were asked for
};

}  // namespace apothem
