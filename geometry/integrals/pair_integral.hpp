// The integrals that the contact kernel computes for a pair of polygons.
#pragma once

#include <cstddef>
#include <cstdint>

#include "geometry/polygon/point.hpp"

namespace apothem {

/// The integrals of a pair for unit stiffness. Multiplied by the stiffness k_n (Pa), force and
/// weight are in N/m, moments in N, and the energy of PairVolume in J/m. Moments are about the
/// reference points of the two polygons; positions are relative to the reference point of a.
///
/// The own length of a polygon is the length of the parts of its boundary that have points of the
/// other polygon immediately on their inner side. It is the length of the polygon's part of the
/// boundary of the overlap. Where edges of both polygons lie on each other, they count for both if
/// the polygons lie on the same side, and for neither if they lie on opposite sides and only touch.
/// edge_method, overlap_method and exact_method agree about it. pair_integral and contact_patches
/// round all heights; for edges that lie on each other they may take either.
struct PairIntegral {
  Vec2 force = Vec2::Zero();   ///< force on a, m
  double moment_a = 0;         ///< moment on a about its reference point, m^2
  double moment_b = 0;         ///< moment on b about its reference point, m^2
  double weight = 0;           ///< W = SUM INT phi ds, the scale of round-off errors, m
  Vec2 centre = Vec2::Zero();  ///< weighted centre p0 = SUM INT phi x ds / W, m
  double own_length_a = 0;     ///< length of the boundary of a inside b, m (see above)
  double own_length_b = 0;     ///< length of the boundary of b inside a, m
  double largest_phi = 0;      ///< largest phi found along the edges
  /// Largest depth of an edge in the other polygon as its potential measures it, which is phi over
  /// the steepest slope, m; 0 if the slopes are not known. It is the distance from the boundary for
  /// the distance potential of convex polygons, and never more (see penetration.hpp).
  double depth = 0;
  /// Extent of the overlap along the tangent (-n_y, n_x), where n is the direction of the force, m.
  double breadth = 0;
  double middle = 0;  ///< the middle of this extent, along the tangent, m
  /// The vertices of a that lie inside b, and those of b inside a: bit i mod 64 is the number of
  /// such vertices i, modulo 2. Not set for needles.
  std::uint64_t inside_a = 0, inside_b = 0;

  /// True if the polygons touch, and also if the weight is NaN.
  [[nodiscard]] bool touching() const { return !(weight <= 0); }
};

/// The numbers of an integral are in groups of four, for packs that read or write several
/// integrals: force and moments; weight, an unused number, and centre; both own lengths, largest
/// phi and depth; breadth, middle and two words that are not floating-point numbers.
inline constexpr int kForceNumbers = 0, kCentreNumbers = 4, kLengthNumbers = 8,
                     kBreadthNumbers = 12;
static_assert(offsetof(PairIntegral, moment_a) == 2 * sizeof(double) &&
              offsetof(PairIntegral, moment_b) == 3 * sizeof(double) &&
              offsetof(PairIntegral, weight) == 4 * sizeof(double) &&
              offsetof(PairIntegral, centre) == 6 * sizeof(double) &&
              offsetof(PairIntegral, own_length_a) == 8 * sizeof(double) &&
              offsetof(PairIntegral, own_length_b) == 9 * sizeof(double) &&
              offsetof(PairIntegral, breadth) == 12 * sizeof(double) &&
              offsetof(PairIntegral, middle) == 13 * sizeof(double) &&
              sizeof(PairIntegral) == 16 * sizeof(double));
inline const double* integral_numbers(const PairIntegral& pair) {
  return reinterpret_cast<const double*>(&pair);  // NOLINT: see above
}
inline double* integral_numbers(PairIntegral& pair) {
  return reinterpret_cast<double*>(&pair);  // NOLINT: see above
}

}  // namespace apothem
