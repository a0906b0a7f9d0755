// An edge of an outline and a face of another outline's collar (geometry/integrals/collar.hpp).
#pragma once

#include <compare>
#include <cstdint>

#include "apothem/geometry/integrals/collar.hpp"

namespace apothem {

/// An edge of one outline that may meet a face of another.
struct EdgeFace {
  std::int32_t edge, face;
  std::int32_t pair = 0;  ///< index of the EdgeFaceLaw
  auto operator<=>(const EdgeFace&) const = default;
};

/// Between the edges of one body and the faces of another.
struct EdgeFaceLaw {
  double slope;         ///< k_n thickness / r of the faces, N/m^2
  double spring;        ///< k_s thickness / r of the faces, N/m^2
  double friction;      ///< mu
  std::int32_t bodies;  ///< index of the two bodies in DampingTimes
};

/// An edge that meets a face.
struct EdgeFaceContact {
  std::int32_t edge, face;
  std::int32_t pair;  ///< index of the EdgeFaceLaw
  double slope;       ///< k_n thickness / r of the face, N/m^2
  CollarPiece<double> piece;
};

/// The normal forces of a contact, N, each along the inward normal of its edge or face, on its
/// start and on its end. The edge gets the pressure against its outward normal, and the face gives
/// way.
struct EdgeFaceForces {
  double edge_start, edge_end, face_start, face_end;
};

/// `slope` of the face, as above; lengths of the edge and of the face's base, m.
inline EdgeFaceForces edge_face_forces(const CollarPiece<double>& p, double slope,
                                       double edge_length, double face_length) {
  const double on_edge = slope * edge_length;
  const double on_face_end = slope * p.along / face_length;
  return {on_edge * (p.sum - p.first), on_edge * p.first, slope * p.area - on_face_end,
          on_face_end};
}

}  // namespace apothem
