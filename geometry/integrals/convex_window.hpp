// Pairs of convex polygons of which one has many sides.
//
// In most contacts a few edges of each polygon are near the other one. A window is the part of a
// convex polygon p between some of its consecutive edges and a point inside: a convex polygon with
// two more sides, the closing sides. Let D be the largest depth in p of a point of the overlap of
// two windows. If each vertex of this overlap is farther than D from the closing sides, then
//
// - the overlap of the windows is that of the polygons: it is convex, as that of the polygons is,
//   and leads nowhere out of a window;
// - the line of p that is lowest at a point of the overlap belongs to an edge of the window: the
//   nearest point of the boundary of p is at most D away, and so is on the same side of the closing
//   sides, and all lines of the distance potential have the same slope.
//
// So the integrals are those of the polygons, to the last bit. If the condition does not hold, the
// windows are enlarged, and in the end they are the whole polygons. This file may be deleted with
// the one call of it: all results remain the same. A step of a regular polygon with 64 corners that
// rests takes twice the time without it, and one with 2 048 corners twenty times.
#pragma once

#include <optional>
#include <vector>

#include "geometry/integrals/near_edges.hpp"
#include "geometry/integrals/pair_integral.hpp"
#include "geometry/integrals/placed_potential.hpp"

namespace apothem {

struct EdgeWorkspace;

/// A window of a convex polygon, or the whole polygon.
class ConvexWindow {
 public:
  /// True for polygons that windowed_integral can treat.
  static bool serves(const PlacedPotential& p) {
    return p.convex() && p.radius > 0 && p.steepest > 0;
  }
  /// Takes `edges` edges around edge `middle` of p, or all of p if it has few more. Returns false,
  /// without a usable result, if these are half of the polygon, as seen from the point inside.
  bool cut(const PlacedPotential& p, int middle, int edges);
  [[nodiscard]] const PlacedPotential& view() const { return view_; }
  /// The number in the polygon of edge e, or of the vertex where it begins; -1 for closing sides.
  [[nodiscard]] int number(int e) const { return whole_ ? e : numbers_[static_cast<size_t>(e)]; }
  /// The distance of a point of the window from the closing sides, m; infinite in whole polygons.
  [[nodiscard]] double margin(const Vec2& point) const;
  /// True if a vertex is between two edges of the polygon.
  [[nodiscard]] bool is_inner(int vertex) const;

 private:
  void add(const PlacedPotential& p, int first, int end);
  void close(int side, double slope);

  PlacedPotential view_{};
  bool whole_ = true;
  std::vector<double> coordinates_;  // x, y, gx and gy
  std::vector<int> numbers_;
  Vec2 inside_, first_, last_;  // the point inside, and unit vectors from there to both ends
};

/// Memory of windowed_integral.
struct ConvexWindows {
  ConvexWindow a, b;
};

/// The integrals of two convex polygons with the distance potential, found from windows; nothing if
/// these would be as large as the polygons. Arguments and results are those of pair_integral. If
/// the polygons touch, `workspace.windows` remain those of the result.
std::optional<PairIntegral> windowed_integral(const PlacedPotential& a, const PlacedPotential& b,
                                              const Vec2& offset, NearEdges& near,
                                              EdgeWorkspace& workspace);

}  // namespace apothem
