// The energy of two convex polygons: their potentials integrated over the overlap.
//
// Only the lines that are the lowest ones somewhere over the overlap have a face there, and in most
// contacts these are one to three of any number. They are found by comparison with the line that is
// lowest in the middle of the overlap; lower_envelope::volume_under does the rest.
#pragma once

#include <vector>

#include "geometry/integrals/edge_integral.hpp"
#include "geometry/integrals/placed_potential.hpp"
#include "geometry/potential/lower_envelope.hpp"

namespace apothem {

/// Energies of pairs of convex polygons. The object is memory that is kept between calls; keep one
/// per thread.
class OverlapEnergy {
 public:
  /// INT_{a AND b} (phi_a + phi_b) dA, m^2. Both polygons are convex and have no distance field;
  /// the arguments are those of pair_integral.
  double of_convex(const PlacedPotential& a, const PlacedPotential& b, const Vec2& offset);
  /// Memory of the pair's force, from which the energy of many-sided polygons takes the windows.
  EdgeWorkspace& edges() { return edges_; }

  /// INT phi_p dA over a ring inside p, m^2. p is convex and moved by `shift`.
  double volume_under(const PlacedPotential& p, const Vec2& shift, const std::vector<Vec2>& ring);

 private:
  using Line = lower_envelope::Line<double>;
  // Makes overlap_ from the ring of b and the edges of a.
  void intersect(const PlacedPotential& a, const PlacedPotential& b, const Vec2& offset);
  void clip_overlap(const Line& side);

  std::vector<Vec2> overlap_, part_, ring_;
  std::vector<Line> lines_, lowest_;
  lower_envelope::Memory<double> faces_;
  EdgeWorkspace edges_;
};

}  // namespace apothem
