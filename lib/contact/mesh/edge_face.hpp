// An edge of an outline and a face of another outline's collar (geometry/integrals/collar.hpp).
#pragma once

#include <compare>
#include <cstdint>

#include "geometry/integrals/collar.hpp"
#include "geometry/polygon/point.hpp"
#include "lib/contact/law/law.hpp"

namespace apothem {

/// An edge of one outline that may meet a face of another.
struct EdgeFace {
  std::int32_t edge, face;
  std::int32_t pair = 0;  ///< index of the EdgeFaceLaw
  auto operator<=>(const EdgeFace&) const = default;
};

/// Between the edges of one body and the faces of another.
struct EdgeFaceLaw {
  double slope;        ///< k_n thickness / r of the faces, N/m^2
  const PairLaw* law;  ///< between the two
  bool self;           ///< both are one body
  std::int32_t pair;   ///< index of the pair of bodies, which takes no order of the two
};

/// An edge that meets a face.
struct EdgeFaceContact {
  std::int32_t edge, face;
  double slope;  ///< k_n thickness / r of the face, N/m^2
  CollarPiece<double> piece;
  Vec2 drag = Vec2::Zero();  ///< friction on the edge with the dashpot beside it, N
  Vec2 push = Vec2::Zero();  ///< of the dashpot across the contact on the edge, N
};

/// The normal forces of a contact, N, each along the inward normal of its edge or face, on its
/// start and on its end. The edge gets the pressure against its outward normal, and the face gives
/// way. Of numbers or packs.
template <class Real>
struct EdgeFaceForces {
  Real edge_start, edge_end, face_start, face_end;
};

/// `piece` has the members of CollarPiece. `slope` of the face, as above; length of the edge, m,
/// and 1 over that of the face's base, 1/m.
template <class Real, class Piece>
APOTHEM_INLINE EdgeFaceForces<Real> edge_face_forces(const Piece& p, const Real& slope,
                                                     const Real& edge_length,
                                                     const Real& per_face_length) {
  const Real on_edge = slope * edge_length;
  const Real on_face_end = slope * p.along * per_face_length;
  return {on_edge * (p.sum - p.first), on_edge * p.first, slope * p.area - on_face_end,
          on_face_end};
}

/// The height up to which an edge's height in a face is surely its depth, unless the body is
/// squeezed to less than the collar. `plain` of the face and `depth` of the collar, m.
template <class Real>
APOTHEM_INLINE Real sure_depth(const Real& plain, const Real& depth) {
  const Real half = Real(.5) * depth;
  return select(half < plain, half, plain);
}

}  // namespace apothem
