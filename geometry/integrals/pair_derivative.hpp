// The derivatives of a pair's integrals by the positions of the two polygons: the second
// derivatives of the energy of the normal contact. The formulas of the integrals (edge_sums.hpp,
// the roofs and the distance fields) are those of the forces, with numbers that carry derivatives,
// so that the tangent is exact and belongs to the force.
//
// It is the plain method: all edges near the other polygon, and whole potentials.
#pragma once

#include <span>
#include <vector>

#include "geometry/integrals/contact_patches.hpp"
#include "lib/execution/dual.hpp"

namespace apothem {

/// A number with its derivatives by four motions: the shift of a relative to b along x and y, the
/// turn of a about its reference point, and that of b about its own.
using Moving = Dual<4>;

/// The integrals of a patch, as in PairIntegral.
struct MovingIntegral {
  Moving force_x, force_y, moment_a, moment_b, weight, centre_x, centre_y;
  Moving own_length_a, own_length_b, breadth;
};

/// Finds them, with memory that grows to what pairs need. Keep one per thread.
class PairDerivative {
 public:
  /// The integrals of each patch of a pair. `patch_of` tells the patches of the segments, in the
  /// order of contact_patches; it may be empty: then the whole pair is one patch. Returns nothing
  /// if there are other segments here than `patch_of` tells of. The arguments a, b, offset are
  /// those of pair_integral; the reference points of a and b must be the origins of their frames.
  std::span<const MovingIntegral> find(const PlacedPotential& a, const PlacedPotential& b,
                                       const Vec2& offset, std::span<const SegmentPlace> patch_of);

 private:
  struct Shape {
    std::vector<Moving> x, y, gx, gy;
    Box box;
  };
  struct Segment {
    bool of_a;
    int edge;
    edge_detail::EdgeSums<Moving> sums;
    Moving x0, y0, x1, y1;  // ends, relative to a's reference point
  };
  void place(const PlacedPotential& p, const Moving& dx, const Moving& dy, int turn, Shape& shape);
  void walk(bool of_a, const PlacedPotential& x, const PlacedPotential& y);

  Shape edges_, field_;  // the polygon whose edges are walked along, and the owner of phi
  std::vector<Moving> from_, until_, node_x_, node_y_, node_value_;
  RoofTrace<Moving> roof_;
  DistanceTrace<Moving> distance_;
  std::vector<Segment> segments_;
  std::vector<MovingIntegral> patches_;
};

}  // namespace apothem
