// Normal contact of two polygons by integrals along their edges: the hot kernel.
//
// With E = INT_{a AND b} (phi_a + phi_b) dA and stiffness 1, the divergence theorem turns the force
// F_a = -dE/dx_a into (theory: Eqs. 7-8 without the overlap polygon, phi_b = 0 on b's own edges)
//
//   F_a = - SUM_{edges of a} n INT phi_b ds + SUM_{edges of b} n INT phi_a ds.
//
// Each half-sum is evaluated in the frame of the polygon that owns phi. Swapping a and b swaps the
// halves, hence F_b = -F_a to the last bit; and only differences of positions enter, hence no digit
// is lost far from the origin.
#pragma once

#include <vector>

#include "apothem/geometry/potential/distance_field.hpp"
#include "apothem/geometry/potential/potential.hpp"
#include "apothem/geometry/skeleton/roof.hpp"

namespace apothem {

/// A potential placed in the plane: SoA views relative to some frame. x and y have size + 1 entries
/// (the first vertex is repeated), gx and gy have `size`.
struct PlacedPotential {
  const double* x;
  const double* y;
  const double* gx;
  const double* gy;
  int size;
  bool capped;
  const Roof* roof = nullptr;      ///< of a polygon that is not convex, or
  const double* node_x = nullptr;  ///< (its nodes, placed)
  const double* node_y = nullptr;
  const DistanceField* distance = nullptr;  ///< this
  Vec2 reference = Vec2::Zero();            ///< in the frame; what the pair's moments are about
  double radius = 0;                        ///< largest distance of a vertex from it; 0: not known

  /// True where phi is the lower envelope of the lines.
  [[nodiscard]] bool convex() const { return !roof && !distance; }
};

/// Integrals of a pair for unit stiffness. Multiply force, moments, weight and energy by k_n.
/// Moments are about the two reference points; positions are relative to a's reference point.
struct PairIntegral {
  Vec2 force = Vec2::Zero();   ///< on a, m
  double moment_a = 0;         ///< m^2
  double moment_b = 0;         ///< m^2
  double weight = 0;           ///< W = SUM INT phi ds, m: the scale of round-off
  Vec2 centre = Vec2::Zero();  ///< weighted centre p0 = SUM INT phi x ds / W, m
  double own_length_a = 0;     ///< boundary of a inside b, m
  double own_length_b = 0;     ///< m
  double largest_phi = 0;      ///< largest phi met along the edges
  double penetration = 0;      ///< extent of the overlap along the force, m
  double breadth = 0;          ///< extent of the overlap across the force, m

  [[nodiscard]] bool touching() const { return !(weight <= 0); }  // NaN counts as touching
};

/// Memory the kernel works in; keep one per thread.
struct EdgeWorkspace {
  std::vector<double> values;  ///< heights of the vertices of both polygons over the other's edges
  std::vector<double> pieces;  ///< end points of the clipped edges
  RoofTrace<double> roof;      ///< for polygons that are not convex
  DistanceTrace<double> distance;
};

/// The pair kernel. `offset` is the origin of a's frame minus that of b's. No allocation after the
/// first calls with polygons of that size.
PairIntegral pair_integral(const PlacedPotential& a, const PlacedPotential& b, const Vec2& offset,
                           EdgeWorkspace& workspace);

/// Energy INT_{a AND b} (phi_a + phi_b) dA (m^2 for unit stiffness) and overlap area (m^2).
struct PairVolume {
  double energy = 0;
  double overlap_area = 0;
};

/// The volume under the potentials, by clipping: not for the step loop, but for ledgers and
/// pictures.
PairVolume pair_volume(const PlacedPotential& a, const PlacedPotential& b, const Vec2& offset);

/// Loading point of the resultant: the weighted centre moved along the tangent onto the line of
/// action of (force, moment_a), relative to a's reference point (theory: Sec. 3). Without a
/// resultant it is the centre itself.
Vec2 loading_point(const PairIntegral& pair);

/// The pair kernel for two polygons where they stand, with the potentials of make_potential;
/// moments about the polygons' centroids, positions relative to a's. For single evaluations:
/// vertices enter exactly as given, so the round-off is as small as the kernel allows.
struct PairResult {
  PairIntegral integral;
  PairVolume volume;
};
PairResult edge_method(const Polygon& a, const Potential& potential_a, const Polygon& b,
                       const Potential& potential_b);

}  // namespace apothem
