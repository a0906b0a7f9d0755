// The contact patches of two polygons. Polygons that are not convex may touch in several places at
// once. Every connected component of the overlap is one contact patch, with its own force, moments
// and loading point.
//
// The boundary of the overlap consists of runs: the parts of each polygon's edges that lie inside
// the other polygon. At a vertex of its polygon a run is followed by the run on the next edge;
// where the two boundaries cross it is followed by a run of the other polygon. The cycles of runs
// are the boundaries of the patches.
#pragma once

#include <span>
#include <vector>

#include "geometry/integrals/edge_trace.hpp"
#include "geometry/polygon/disjoint_sets.hpp"

namespace apothem {

/// Where a run is: a maximal part of one edge inside the other polygon.
struct RunPlace {
  bool of_a;        ///< true for an edge of a and phi of b, false for the opposite
  int edge;         ///< index of the edge in its polygon
  int patch;        ///< index of the contact patch that the run belongs to
  double from, to;  ///< start and end along the edge, as shares of the edge's length
  double length;    ///< length of the run, m
};

/// A run with the integrals of the other polygon's potential phi along it, for unit stiffness. As
/// in PairIntegral, points are relative to the reference point of a, and moments are about the
/// reference points of a and b.
struct BoundaryRun : RunPlace {
  Vec2 start = Vec2::Zero();   ///< the point at `from`, m
  Vec2 end = Vec2::Zero();     ///< the point at `to`, m
  Vec2 force = Vec2::Zero();   ///< force on a, normal to the edge, m
  double moment_a = 0;         ///< moment on a about its reference point, m^2
  double moment_b = 0;         ///< moment on b about its reference point, m^2
  double weight = 0;           ///< integral of phi ds, m
  Vec2 centre = Vec2::Zero();  ///< integral of phi x ds, divided by `weight`, m
  double largest_phi = 0;      ///< largest phi on the run
};

/// Memory that contact_patches works in. Keep one per thread. An end of a run is numbered 2 run for
/// its start and 2 run + 1 for its end.
struct PatchWorkspace {
  /// Two loose ends that might be joined.
  struct Bridge {
    double cost2;    ///< square of the cost of joining them, m^2
    int end, other;  ///< numbers of the two ends
  };
  EdgeWorkspace edge;                                 ///< memory of the integrals along edges
  std::vector<edge_detail::EdgeSums<double>> halves;  ///< integrals per run
  std::vector<edge_detail::Half> of_a, of_b;  ///< integrals per patch, on edges of a and of b
  std::vector<int> crossed;                   ///< per end: crossed edge of the other polygon or -1
  DisjointSets sets;                          ///< of runs: the patches
  std::vector<char> joined;                   ///< per end: whether it has been joined to another
  std::vector<Bridge> bridges;                ///< candidates for joining loose ends
  std::vector<edge_detail::Extent> extents;   ///< extents per patch
};

/// Splits a pair of polygons into its contact patches. The arguments a, b, offset and near are
/// those of pair_integral, and so is the result. The runs are ordered by their edges, those of a
/// first, and the patches by their first run. A pair that does not touch has neither. The sum over
/// the patches equals the result of pair_integral to round-off; a patch that is the only one equals
/// it to the last bit. If a coordinate is not finite, there is one patch that is not finite,
/// and no run. Nothing is allocated after the first calls.
///
/// Round-off may make the two boundaries disagree about a crossing, if a vertex lies on an edge or
/// edges lie on each other. A loose end of a run is then joined to the loose end that is nearest
/// along both boundaries.
PairIntegral contact_patches(const PlacedPotential& a, const PlacedPotential& b, const Vec2& offset,
                             PatchWorkspace& workspace, std::vector<BoundaryRun>& runs,
                             std::vector<PairIntegral>& patches, NearEdges& near);
PairIntegral contact_patches(const PlacedPotential& a, const PlacedPotential& b, const Vec2& offset,
                             PatchWorkspace& workspace, std::vector<BoundaryRun>& runs,
                             std::vector<PairIntegral>& patches);

/// Computes how much boundary the patches of a pair share with those of an earlier step. Entry
/// i * patches_now + j of the table is the length of boundary of both polygons, in m, that lies in
/// the earlier patch i and in the present patch j. A run of length zero that lies in another run
/// counts as the smallest positive number.
void shared_length(std::span<const RunPlace> before, int patches_before,
                   std::span<const RunPlace> now, int patches_now, std::vector<double>& table);

}  // namespace apothem
