// The contact patches of two polygons. Polygons that are not convex may touch in several places at
// once. Every connected component of the overlap is one contact patch, with its own force, moments
// and loading point.
//
// The boundary of the overlap consists of segments: the maximal parts of each polygon's edges that
// lie inside the other polygon. At a vertex of its polygon a segment is followed by the segment on
// the next edge; where the two boundaries cross it is followed by a segment of the other polygon.
// The cycles of segments are the boundaries of the patches.
#pragma once

#include <span>
#include <vector>

#include "geometry/integrals/edge_trace.hpp"
#include "geometry/polygon/disjoint_sets.hpp"

namespace apothem {

/// The place of a boundary segment, a maximal part of one edge inside the other polygon.
struct SegmentPlace {
  bool of_a;        ///< true for an edge of a and phi of b, false for the opposite
  int edge;         ///< index of the edge in its polygon
  int patch;        ///< index of the contact patch that the segment belongs to
  double from, to;  ///< start and end along the edge, as fractions of the edge's length
  double length;    ///< length of the segment, m
};

/// A boundary segment with the integrals of the other polygon's potential phi along it, for unit
/// stiffness. As in PairIntegral, points are relative to the reference point of a, and moments are
/// about the reference points of a and b.
struct BoundarySegment : SegmentPlace {
  Vec2 start = Vec2::Zero();   ///< the point at `from`, m
  Vec2 end = Vec2::Zero();     ///< the point at `to`, m
  Vec2 force = Vec2::Zero();   ///< force on a, normal to the edge, m
  double moment_a = 0;         ///< moment on a about its reference point, m^2
  double moment_b = 0;         ///< moment on b about its reference point, m^2
  double weight = 0;           ///< integral of phi ds, m
  Vec2 centre = Vec2::Zero();  ///< integral of phi x ds, divided by `weight`, m
  double largest_phi = 0;      ///< largest phi on the segment
};

/// Memory of contact_patches. Keep one per thread. The start of the segment i has the number 2 i,
/// and its end 2 i + 1.
struct PatchWorkspace {
  /// Two loose ends that might be joined.
  struct Bridge {
    double cost2;    ///< square of the cost of joining them, m^2
    int end, other;  ///< numbers of the two ends
  };
  EdgeWorkspace edge;                                 ///< memory of the integrals along edges
  std::vector<edge_detail::EdgeSums<double>> halves;  ///< integrals per segment
  std::vector<edge_detail::Half> of_a, of_b;  ///< integrals per patch, on edges of a and of b
  std::vector<int> crossed;                   ///< per end: crossed edge of the other polygon or -1
  DisjointSets sets;                          ///< the patches as sets of segments
  std::vector<char> joined;                   ///< per end: whether it has been joined to another
  std::vector<Bridge> bridges;                ///< candidates for joining loose ends
  std::vector<edge_detail::Extent> extents;   ///< extents per patch
  std::vector<double> twice_area;             ///< per root: twice the area within its boundary
  std::vector<int> roots;                     ///< per segment: the root of its boundary
};

/// Splits a pair of polygons into its contact patches. The arguments a, b, offset and near are
/// those of pair_integral, and so is the result. The segments are ordered by their edges, those of
/// a first, and the patches by their first segment. A pair that does not touch has neither. The sum
/// over the patches equals the result of pair_integral to round-off; a patch that is the only one
/// equals it to the last bit. If a coordinate is not finite, there is one patch that is not finite,
/// and no segment. Nothing is allocated after the first calls.
///
/// Round-off may make the two boundaries disagree about a crossing, if a vertex lies on an edge or
/// edges lie on each other. A loose end of a segment is then joined to the loose end that is
/// nearest along both boundaries.
PairIntegral contact_patches(const PlacedPotential& a, const PlacedPotential& b, const Vec2& offset,
                             PatchWorkspace& workspace, std::vector<BoundarySegment>& segments,
                             std::vector<PairIntegral>& patches, NearEdges& near);
PairIntegral contact_patches(const PlacedPotential& a, const PlacedPotential& b, const Vec2& offset,
                             PatchWorkspace& workspace, std::vector<BoundarySegment>& segments,
                             std::vector<PairIntegral>& patches);

/// Computes the length of boundary that the patches of a pair share with those of an earlier step.
/// Entry i * patches_now + j of the table is the length of boundary of both polygons, in m, that
/// lies in the earlier patch i and in the present patch j. A segment of length zero that lies in
/// another segment counts as the smallest positive number.
void shared_length(std::span<const SegmentPlace> before, int patches_before,
                   std::span<const SegmentPlace> now, int patches_now, std::vector<double>& table);

}  // namespace apothem
