// How deep edges of outlines are inside bodies: the Euclidean distance from the whole boundary.
#pragma once

#include <vector>

#include "geometry/integrals/collar.hpp"
#include "geometry/integrals/penetration.hpp"
#include "lib/contact/surface/outlines.hpp"

namespace apothem {

class OutlineDepths {
 public:
  /// `outlines` must outlive this object.
  explicit OutlineDepths(const Outlines& outlines)
      : outlines_(outlines), boundaries_(outlines.bodies.size()) {}

  /// False if the height in a face need not be a depth, or the piece may even be outside the body,
  /// because faces overlap there.
  [[nodiscard]] bool is_depth(int face, const CollarPiece<double>& piece) const;
  /// To be called when the outlines have moved.
  void forget();
  /// The depth of a piece of an edge in a face, m; `floor` if it is not larger than that.
  [[nodiscard]] double of_piece(int edge, int face, const CollarPiece<double>& piece, double floor);
  /// The same of all parts of an edge that are inside a body.
  [[nodiscard]] double of_edge(int edge, BodyIndex in, double floor);

 private:
  BoundaryDistance& boundary(BodyIndex body);

  const Outlines& outlines_;
  std::vector<BoundaryDistance> boundaries_;  // of the bodies that were asked for
};

}  // namespace apothem
