// The normal contact of two polygons by integrals along their edges. This is the contact kernel of
// the step loop.
//
// For unit stiffness the energy of a pair is E = INT_{a AND b} (phi_a + phi_b) dA. With the outward
// unit normals n, the divergence theorem turns the force F_a = -dE/dx_a into
//
//   F_a = - SUM_{edges of a} n INT phi_b ds + SUM_{edges of b} n INT phi_a ds,
//
// because phi_b = 0 on the edges of b. These are Eqs. 7 and 8 of the paper without the overlap
// polygon; see docs/theory.md, "Normal contact".
//
// Each of the two sums is evaluated in the frame of the polygon whose potential it integrates. If a
// and b are swapped, the two sums are swapped as well, hence F_b = -F_a to the last bit. Only
// differences of positions are used, so no digits are lost far from the origin.
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/integrals/convex_pairs.hpp"
#include "geometry/integrals/convex_window.hpp"
#include "geometry/integrals/layer_pair.hpp"
#include "geometry/integrals/layer_trace.hpp"
#include "geometry/integrals/near_edges.hpp"
#include "geometry/integrals/pair_integral.hpp"
#include "geometry/integrals/placed_potential.hpp"
#include "geometry/potential/distance_field.hpp"
#include "geometry/potential/potential.hpp"
#include "geometry/skeleton/roof.hpp"

namespace apothem {

/// Memory of the kernel. Keep one per thread.
struct EdgeWorkspace {
  std::vector<double> values;  ///< heights of the vertices of both polygons over the other's edges
  std::vector<double> ends;    ///< ends of the parts of edges inside the other polygon
  RoofTrace<double> roof;      ///< memory for polygons with a roof
  RoofNodes nodes;             ///< the nodes of a roof
  DistanceTrace<double> distance;  ///< memory for polygons with a distance field
  LayerTrace layer_trace;          ///< memory for the boundary layers of both
  LayerPair layer_pair;            ///< memory for pairs with few near edges
  ConvexPairs convex;              ///< memory for pairs of convex polygons with few sides
  ConvexWindows windows;           ///< memory for pairs of convex polygons with many sides
};

/// Computes the integrals of a pair. `near` are the edges that may enter the other polygon, if that
/// is known (near_edges.hpp); the result does not depend on them. If nothing is known and both
/// polygons are convex and apart, `near` gets their distance as its skin. `offset` is the origin of
/// a's frame minus the origin of b's frame, m. If a coordinate is not finite, the result is not
/// finite either. Nothing is allocated after the first calls with polygons of a given size.
PairIntegral pair_integral(const PlacedPotential& a, const PlacedPotential& b, const Vec2& offset,
                           EdgeWorkspace& workspace, NearEdges& near);
PairIntegral pair_integral(const PlacedPotential& a, const PlacedPotential& b, const Vec2& offset,
                           EdgeWorkspace& workspace);

/// The integrals of a pair over the overlap.
struct PairVolume {
  double energy = 0;        ///< INT_{a AND b} (phi_a + phi_b) dA for unit stiffness, m^2
  double overlap_area = 0;  ///< area of the overlap, m^2
};

/// Computes the energy and the overlap area by clipping. It is meant for ledgers and pictures and
/// is too slow for the step loop. The arguments are those of pair_integral.
PairVolume pair_volume(const PlacedPotential& a, const PlacedPotential& b, const Vec2& offset);
class OverlapEnergy;
/// The energy of PairVolume alone, for histories.
double pair_energy(const PlacedPotential& a, const PlacedPotential& b, const Vec2& offset,
                   OverlapEnergy& memory);

/// Below this fraction of the weight the line of action of a force is determined by round-off only.
inline constexpr double kNoLineOfAction = 1e-12;

/// Returns the loading point of the resultant force, relative to a's reference point, m. It is the
/// weighted centre, moved along the tangent onto the line of action of (force, moment_a); see
/// docs/theory.md, "Normal contact". Without a resultant force it is the weighted centre itself.
Vec2 loading_point(const PairIntegral& pair);

/// All integrals of a pair.
struct PairResult {
  PairIntegral integral;  ///< integrals along the edges
  PairVolume volume;      ///< integrals over the overlap
};

/// Computes all integrals of two polygons at their given positions, with potentials made by
/// make_potential. Moments are about the polygons' centroids and positions are relative to the
/// centroid of a. It is meant for single evaluations: vertices are used exactly as given, so the
/// round-off is as small as the kernel allows. The own lengths are decided exactly, and polygons
/// that do not overlap have no contact at all.
PairResult edge_method(const Polygon& a, const Potential& potential_a, const Polygon& b,
                       const Potential& potential_b);

}  // namespace apothem
