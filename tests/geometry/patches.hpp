// Contact patches of two polygons at their places, by the edge method and by the exact components
// of their overlap.
#pragma once

#include "geometry/exact/overlap.hpp"
#include "geometry/integrals/contact_patches.hpp"
#include "geometry/integrals/placement.hpp"

namespace apothem::test {

/// The segments and contact patches of two polygons.
struct PatchResult {
  std::vector<BoundarySegment> segments;  ///< segments, ordered by their edges, those of a first
  std::vector<PairIntegral> patches;      ///< patches, ordered by their first segment
};

/// Splits two polygons at their given positions into contact patches. As with edge_method, moments
/// are about the polygons' centroids and positions are relative to the centroid of a.
inline PatchResult edge_patches(const Polygon& a, const Potential& potential_a, const Polygon& b,
                                const Potential& potential_b) {
  const PlacedPair placed(a, potential_a, b, potential_b);
  PatchWorkspace workspace;
  PatchResult result;
  contact_patches(placed.a.view, placed.b.view, Vec2::Zero(), workspace, result.segments,
                  result.patches);
  for (PairIntegral& patch : result.patches) placed.about_centroids(patch);
  for (BoundarySegment& segment : result.segments) {
    placed.about_centroids(segment);
    segment.start -= placed.centroid_a;
    segment.end -= placed.centroid_a;
  }
  return result;
}

/// Eq. 8 on each component of the overlap. The origin is a corner of the component, so that the
/// terms of the sums are as small as it.
inline std::vector<PairIntegral> overlap_patches(const Polygon& a, const Potential& potential_a,
                                                 const Polygon& b, const Potential& potential_b) {
  std::vector<PairIntegral> patches;
  const std::vector<OverlapPolygon> components = overlap_polygons(a, b, Vec2::Zero());
  for (size_t i = 0; i < components.size(); ++i) {
    const Vec2& origin = components[i].vertices[0];
    patches.push_back(overlap_integral({overlap_polygons(a, b, origin).at(i)}, origin, a,
                                       potential_a, b, potential_b));
  }
  return patches;
}

}  // namespace apothem::test
