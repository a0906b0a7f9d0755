// The runs of two polygons that are not convex and touch with few edges, as most do in a pile. The
// cells of each polygon's collar (collar_cells.hpp) then give both polygons' runs at once: a pair
// of an edge of one polygon and a cell of the other one is a lane of a pack.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "geometry/integrals/cell_parts.hpp"
#include "geometry/integrals/edge_sums.hpp"
#include "geometry/integrals/near_edges.hpp"
#include "geometry/integrals/placed_potential.hpp"

namespace apothem {

/// Nothing is allocated.
class CollarPair {
 public:
  /// An edge in the frame of the other polygon.
  using Edge = edge_detail::EdgeFrame<double>;
  /// A run, as of walk_runs (edge_trace.hpp).
  struct Run {
    bool of_a;
    int edge, edge0, edge1;
    double s0, s1;
    const Edge* placed;
    const edge_detail::EdgeSums<double>* integrals;
  };

  /// Finds the runs; false if the collars do not tell them, or there are too many edges. The
  /// arguments are those of pair_integral. The runs have the same bits as those of walk_runs.
  /// What runs they are if edges coincide up to round-off is told by RunEnds::closed.
  bool find(const PlacedPotential& a, const PlacedPotential& b, const Vec2& offset,
            const NearEdges& near);
  /// The runs of a in ascending order, and those of b.
  [[nodiscard]] std::span<const Run> runs() const {
    return {runs_.data(), static_cast<size_t>(count_)};
  }

 private:
  static constexpr int kPack = kComparedLanes;
  static constexpr int kMost = 32;  // lanes
  using Pack = edge_detail::CellPack;
  using Bits = std::uint32_t;  // of each lane
  using Moments = SegmentMoments<double>;
  // An edge of x and a cell of y; y is the polygon whose phi it is.
  struct Lane {
    bool of_a;
    int edge, cell;
  };
  bool list(const PlacedPotential& a, const PlacedPotential& b, const NearEdges& near);
  void find_parts(const PlacedPotential& a, const PlacedPotential& b, const Vec2& offset);
  bool join_parts();
  bool join_parts_of_edge(Bits parts);
  void add_run(int first, int last);
  static bool has(Bits bits, int lane) { return (bits >> lane & 1) != 0; }

  int lanes_ = 0;  // a multiple of kPack
  std::array<Lane, kMost> lane_;
  std::array<double, kMost> s0_, s1_;
  std::array<Edge, kMost> edge_;
  std::array<Moments, kMost> moments_;  // of phi along a part
  std::array<edge_detail::EdgeSums<double>, kMost> integrals_;
  // Lanes that are listed, that have a part, and how it begins and ends.
  Bits listed_ = 0, there_ = 0, own0_ = 0, own1_ = 0, border0_ = 0, border1_ = 0;
  bool deep_ = false;  // whether a part reaches the depth of its cell
  int count_ = 0;      // runs
  std::array<Run, kMost> runs_;
};

}  // namespace apothem
