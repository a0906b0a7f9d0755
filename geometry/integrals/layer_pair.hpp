// The boundary segments of two polygons that are not convex and touch with few edges, as most do in
// a pile. The cells of the boundary layer of each polygon (boundary_layer.hpp) then give the
// segments of both polygons at once: each lane of a pack is a pair of an edge of one polygon and a
// cell of the other one.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "geometry/integrals/cell_parts.hpp"
#include "geometry/integrals/edge_sums.hpp"
#include "geometry/integrals/near_edges.hpp"
#include "geometry/integrals/placed_potential.hpp"

namespace apothem {

/// Finds the segments of a pair of polygons by their boundary layers. Nothing is allocated.
class LayerPair {
 public:
  /// An edge in the frame of the other polygon.
  using Edge = edge_detail::EdgeFrame<double>;
  /// A segment, as walk_segments finds it (edge_trace.hpp).
  struct PairSegment {
    bool of_a;
    int edge, edge0, edge1;
    double s0, s1;
    const Edge* placed;
    const edge_detail::EdgeSums<double>* integrals;
  };

  /// Finds the segments. Returns false if they do not follow from the boundary layers, or if there
  /// are too many edges. The arguments are those of pair_integral. The segments have the same bits
  /// as those of walk_segments. Where edges coincide up to round-off, SegmentEnds::closed tells
  /// whether a segment is missing.
  bool find(const PlacedPotential& a, const PlacedPotential& b, const Vec2& offset,
            const NearEdges& near);
  /// The segments of a in ascending order, then those of b.
  [[nodiscard]] std::span<const PairSegment> segments() const {
    return {segments_.data(), static_cast<size_t>(count_)};
  }

 private:
  static constexpr int kPack = kComparedLanes;
  static constexpr int kMost = 32;  // largest number of lanes
  using Pack = edge_detail::CellPack;
  using Bits = std::uint32_t;  // one bit for each lane
  using Moments = SegmentMoments<double>;
  // An edge of x and a cell of y, where phi is the potential of y.
  struct Lane {
    bool of_a;
    int edge, cell;
  };
  bool list(const PlacedPotential& a, const PlacedPotential& b, const NearEdges& near);
  void find_parts(const PlacedPotential& a, const PlacedPotential& b, const Vec2& offset);
  bool join_parts();
  bool join_parts_of_edge(Bits parts);
  void add_segment(int first, int last);
  static bool has(Bits bits, int lane) { return (bits >> lane & 1) != 0; }

  int lanes_ = 0;  // a multiple of kPack
  std::array<Lane, kMost> lane_;
  std::array<double, kMost> s0_, s1_;
  std::array<Edge, kMost> edge_;
  std::array<Moments, kMost> moments_;  // moments of phi along the part of each lane
  std::array<edge_detail::EdgeSums<double>, kMost> integrals_;
  // Lanes that are listed, that have a part, whose part begins or ends at the cell's own edge, and
  // whose part begins or ends at a border.
  Bits listed_ = 0, there_ = 0, own0_ = 0, own1_ = 0, border0_ = 0, border1_ = 0;
  bool reaches_depth_ = false;  // true if a part reaches the depth of its cell
  int count_ = 0;               // number of segments
  std::array<PairSegment, kMost> segments_;
};

}  // namespace apothem
