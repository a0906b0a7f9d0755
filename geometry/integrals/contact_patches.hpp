// Contact patches: two polygons that are not convex may touch in several places at once. Every
// connected component of the overlap is one patch, with its own force, moments and loading point.
//
// The boundary of the overlap consists of runs, the parts of each polygon's edges inside the other
// polygon. A run goes on in the next one at a vertex of its owner, or in a run of the other polygon
// where the two boundaries cross; the cycles of runs are the patches.
#pragma once

#include <span>
#include <vector>

#include "apothem/geometry/integrals/edge_trace.hpp"

namespace apothem {

/// A maximal part of one edge inside the other polygon, with the integrals of the other's phi along
/// it, for unit stiffness. Conventions of PairIntegral: points are relative to a's reference point,
/// moments about the two reference points.
struct BoundaryRun {
  bool of_a;                   ///< whose edge it is; phi is the other's
  int edge;                    ///< of the owner
  int patch;                   ///< index of the patch it belongs to
  double from, to;             ///< along the edge, as a share of its length
  Vec2 start = Vec2::Zero();   ///< the point at `from`, m
  Vec2 end = Vec2::Zero();     ///< the point at `to`, m
  Vec2 force = Vec2::Zero();   ///< on a, m; normal to the edge
  double moment_a = 0;         ///< m^2
  double moment_b = 0;         ///< m^2
  double weight = 0;           ///< INT phi ds, m
  Vec2 centre = Vec2::Zero();  ///< INT phi x ds / weight, m
  double length = 0;           ///< m
  double largest_phi = 0;
};

/// Memory; keep one per thread.
struct PatchWorkspace {
  struct Crossing {
    int edge_a, edge_b;
    int end;  ///< 2 run for a run's start, 2 run + 1 for its end
  };
  struct Bridge {
    double cost2;
    int end, other;  ///< as above
  };
  EdgeWorkspace edge;
  std::vector<edge_detail::Half> halves;      ///< of the runs
  std::vector<edge_detail::Half> of_a, of_b;  ///< of the patches
  std::vector<int> crossed;                   ///< edge of the other polygon per end, -1 at a vertex
  std::vector<int> parent;                    ///< of a run in its patch
  std::vector<char> joined;                   ///< per end
  std::vector<Crossing> crossings;
  std::vector<Bridge> bridges;
  std::vector<edge_detail::Extent> extents;  ///< of the patches
};

/// Splits a pair into its patches; same pair and frames as pair_integral. Runs come in the order of
/// the edges, a's first, and patches in the order of their first run; a pair that does not touch
/// has neither. The sum over the patches is pair_integral's to round-off, and a patch of two convex
/// polygons is pair_integral's to the last bit. With coordinates that are not finite there is one
/// patch that is not finite, and no run. No allocation after the first calls.
///
/// Where round-off makes the two boundaries disagree about a crossing (vertices on edges, edges on
/// each other) a run's loose end is joined to the loose end that is nearest along both boundaries.
void contact_patches(const PlacedPotential& a, const PlacedPotential& b, const Vec2& offset,
                     PatchWorkspace& workspace, std::vector<BoundaryRun>& runs,
                     std::vector<PairIntegral>& patches);

/// Runs and patches of two polygons where they stand; moments and positions as edge_method's.
struct PatchResult {
  std::vector<BoundaryRun> runs;
  std::vector<PairIntegral> patches;
};
PatchResult edge_patches(const Polygon& a, const Potential& potential_a, const Polygon& b,
                         const Potential& potential_b);

/// How much boundary the patches of a pair share with those of an earlier step: entry
/// i * patches_now + j of the table is the length (m, both polygons' edges) that lies in the
/// earlier patch i and in the present patch j. A run without length that lies in another one counts
/// as the smallest positive number.
void shared_length(std::span<const BoundaryRun> before, int patches_before,
                   std::span<const BoundaryRun> now, int patches_now, std::vector<double>& table);

}  // namespace apothem
