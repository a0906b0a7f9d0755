// An edge of one outline and a face of the collar of another outline
// (geometry/integrals/collar.hpp).
#pragma once

#include <compare>
#include <cstdint>

#include "geometry/integrals/collar.hpp"
#include "geometry/polygon/point.hpp"
#include "lib/contact/law/law.hpp"

namespace apothem {

/// A candidate: an edge of one outline that may meet a face of another one.
struct EdgeFace {
  std::int32_t edge, face;
  std::int32_t pair = 0;  ///< index of the candidate's EdgeFaceLaw
  auto operator<=>(const EdgeFace&) const = default;
};

/// The contact law between the edges of one body and the faces of another one.
struct EdgeFaceLaw {
  double slope;        ///< k_n thickness / r of the faces, N/m^2
  const PairLaw* law;  ///< the law between the two bodies
  bool self;           ///< true if both are the same body
  std::int32_t pair;   ///< index of the unordered pair of bodies
};

/// A contact: an edge that meets a face.
struct EdgeFaceContact {
  std::int32_t edge, face;
  double slope;  ///< k_n thickness / r of the face, N/m^2
  CollarPiece<double> piece;
  /// Force of the friction spring and of the dashpot beside it on the edge, N.
  Vec2 drag = Vec2::Zero();
  Vec2 push = Vec2::Zero();  ///< force of the dashpot along the normal on the edge, N
};

/// The normal forces of a contact on the start and on the end of its edge and of its face, N, each
/// along the inward normal of that edge or face. The edge gets the pressure against its outward
/// normal; the face gets the derivative by its own displacement. `Real` is a number or a pack.
template <class Real>
struct EdgeFaceForces {
  Real edge_start, edge_end, face_start, face_end;
};

/// `p` has the members of CollarPiece. `slope` is that of the face, N/m^2, `edge_length` the length
/// of the edge, m, and `per_face_length` the inverse length of the face's base, 1/m.
template <class Real, class Piece>
APOTHEM_INLINE EdgeFaceForces<Real> edge_face_forces(const Piece& p, const Real& slope,
                                                     const Real& edge_length,
                                                     const Real& per_face_length) {
  const Real on_edge = slope * edge_length;
  const Real on_face_end = slope * p.along * per_face_length;
  return {on_edge * (p.sum - p.first), on_edge * p.first, slope * p.area - on_face_end,
          on_face_end};
}

/// Up to this height the height of an edge in a face is certainly its depth, unless the body is
/// squeezed to less than its collar. `regular_depth` is that of the face, `depth` that of the
/// collar, m.
template <class Real>
APOTHEM_INLINE Real sure_depth(const Real& regular_depth, const Real& depth) {
  const Real half = Real(.5) * depth;
  return select(half < regular_depth, half, regular_depth);
}

}  // namespace apothem
