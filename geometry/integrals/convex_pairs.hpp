// The integrals of pairs of convex polygons with few sides, several pairs at a time. In scenes with
// many rigid bodies the step loop spends most of its time here. The stages are
//
//   heights of all vertices over the edges of the other polygon, four edges in a pack
//   -> the edges that are not wholly beyond one of these: most contacts have three or four
//   -> these edges, of whatever pairs, as the lanes of packs: clip, phi along them, products
//   -> sums over the edges of each pair
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/integrals/edge_sums.hpp"
#include "geometry/integrals/near_edges.hpp"
#include "geometry/integrals/pair_integral.hpp"
#include "geometry/integrals/placed_potential.hpp"

namespace apothem {

/// Pairs of convex polygons, collected until a batch is full. Each pair gets the same bits as it
/// would alone. The object keeps its memory: use one for each thread, for many pairs.
class ConvexPairs {
 public:
  static constexpr int kAtOnce = 16;     ///< largest number of pairs
  static constexpr int kMostSides = 16;  ///< largest number of sides of a polygon

  /// True for polygons that this class can treat.
  static bool serves(const PlacedPotential& p) {
    return p.convex() && !p.capped && p.size <= kMostSides && p.radius > 0;
  }
  /// Adds a pair; must not be called if `full`. The arguments are those of pair_integral; the data
  /// that they point to must remain until the pair is evaluated.
  void add(const PlacedPotential& a, const PlacedPotential& b, const Vec2& offset,
           NearEdges& near) {
    pairs_[static_cast<size_t>(count_++)] = {side(a), side(b), offset.x(), offset.y(), &near};
    uneven_ = uneven_ || (a.size | b.size) % kLanes != 0;
    most_sides_ = std::max({most_sides_, a.size, b.size});
  }
  [[nodiscard]] int count() const { return count_; }
  [[nodiscard]] bool full() const { return count_ == kAtOnce; }
  /// Returns the integrals of all pairs that have been added, in their order, and removes the
  /// pairs.
  std::span<const PairIntegral> evaluate();

 private:
  static constexpr int kLanes = 4;
  static constexpr int kGroups = kMostSides / kLanes;

  // One number for each edge of a group, or four numbers of one edge.
  struct alignas(32) Numbers {
    std::array<double, kLanes> v;
  };
  struct Side {
    const double *x, *y;  // coordinates of the vertices, with the first one repeated
    // Starts and gradients of the edges in groups of four. The last group is padded with copies of
    // the first edge, which change nothing.
    const double *start_x, *start_y, *gx, *gy;
    int size, groups;
    double radius, steepest;
    double reference_x, reference_y;
  };
  struct ConvexPair {
    Side a, b;
    double dx, dy;  // offset from the frame of a to that of b
    NearEdges* near;
    int first = 0, of_a = 0, of_b = 0;  // range of its parts, and their numbers on a and b
  };
  // An edge that may enter the other polygon.
  struct ConvexEdge {
    const Numbers *from, *until;  // heights of its ends over the edges of the other polygon
    edge_detail::EdgeFrame<double> frame;
    int part, number;
    bool whole;  // true if it has not been shortened at its start
  };
  // The part of an edge inside the other polygon.
  struct alignas(32) EdgePart {
    edge_detail::EdgeSums<double> sums;
    Numbers ends;  // x of its start and its end, then y; NaN if no part lies inside
    int number;    // number of the edge
    bool enters;   // true if it begins at the start of the edge
  };

  static Side side(const PlacedPotential& p) {
    return {p.x,
            p.y,
            p.x,
            p.y,
            p.gx,
            p.gy,
            p.size,
            (p.size + kLanes - 1) / kLanes,
            p.radius,
            p.steepest,
            p.reference.x(),
            p.reference.y()};
  }
  void make_room();
  static void fill_up(Side& side, Numbers*& memory);
  void find(ConvexPair& pair, Numbers*& rows);
  template <bool quads>
  static double find_heights(const Side& x, const Side& y, double dx, double dy, double margin,
                             Numbers* rows, unsigned& edges);
  void list_edges(const Side& x, const Side& y, double dx, double dy, unsigned edges,
                  const Numbers* heights, bool is_long, Numbers*& rows);
  template <bool one_group>
  void integrate(const ConvexEdge* edges, int groups);
  template <class F>
  static void each_part(const EdgePart* from, const EdgePart* until, const F& f);
  void add_up(size_t first, size_t count);

  std::array<ConvexPair, kAtOnce> pairs_;
  int count_ = 0;
  bool uneven_ = false;  // true if a last group has to be padded
  int most_sides_ = 0, room_ = 0;
  std::vector<Numbers> rows_, copies_;
  // Edges, by the number of groups of the other polygon.
  std::array<std::vector<ConvexEdge>, kGroups> edges_;
  std::array<int, kGroups> listed_{};
  std::vector<EdgePart> parts_;
  int found_ = 0;  // number of parts
  std::array<PairIntegral, kAtOnce> results_;
};

}  // namespace apothem
