// The integrals of pairs of convex polygons with few sides, several pairs at a time. In scenes of
// many rigid bodies the step loop spends its time here.
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

/// Pairs of convex polygons, collected until there are enough of them. Each has the same bits as
/// alone. It keeps its memory: use one object for each thread, again and again.
class ConvexPairs {
 public:
  static constexpr int kAtOnce = 16;     ///< pairs
  static constexpr int kMostSides = 16;  ///< of a polygon

  /// True for polygons that it takes.
  static bool serves(const PlacedPotential& p) {
    return p.convex() && !p.capped && p.size <= kMostSides && p.radius > 0;
  }
  /// Adds a pair, unless `full`. The arguments are those of pair_integral; what they point to must
  /// remain until the pair is evaluated.
  void add(const PlacedPotential& a, const PlacedPotential& b, const Vec2& offset,
           NearEdges& near) {
    pairs_[static_cast<size_t>(count_++)] = {side(a), side(b), offset.x(), offset.y(), &near};
    uneven_ = uneven_ || (a.size | b.size) % kLanes != 0;
    most_sides_ = std::max({most_sides_, a.size, b.size});
  }
  [[nodiscard]] int count() const { return count_; }
  [[nodiscard]] bool full() const { return count_ == kAtOnce; }
  /// The integrals of all pairs that have been added, in this order. Then there are none.
  std::span<const PairIntegral> evaluate();

 private:
  static constexpr int kLanes = 4;
  static constexpr int kGroups = kMostSides / kLanes;

  // One number for each edge of a group, or four numbers of one edge.
  struct alignas(32) Numbers {
    std::array<double, kLanes> v;
  };
  struct Side {
    const double *x, *y;  // of the vertices, with the first one again
    // Of the edges in groups of four: their starts and gradients. The last group is filled up with
    // copies of the first edge, which change nothing.
    const double *start_x, *start_y, *gx, *gy;
    int size, groups;
    double radius, steepest;
    double reference_x, reference_y;
  };
  struct Pair {
    Side a, b;
    double dx, dy;  // from the frame of a to that of b
    NearEdges* near;
    int first = 0, of_a = 0, of_b = 0;  // its parts
  };
  // An edge that may enter the other polygon.
  struct Edge {
    const Numbers *from, *until;  // the heights of its ends over the edges of that one
    edge_detail::EdgeFrame<double> frame;
    int part, number;
    bool whole;  // it has not been shortened at its start
  };
  // What lies of an edge inside the other polygon.
  struct alignas(32) Part {
    edge_detail::EdgeSums<double> sums;
    Numbers ends;  // x of its start and its end, and y; no numbers if nothing lies inside
    int number;    // of the edge
    bool enters;   // it begins at the start of the edge
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
  static void fill_up(Side& side, Numbers*& to);
  void find(Pair& pair, Numbers*& rows);
  template <bool quads>
  static double find_heights(const Side& x, const Side& y, double dx, double dy, double margin,
                             Numbers* rows, unsigned& edges);
  void list_edges(const Side& x, const Side& y, double dx, double dy, unsigned edges,
                  const Numbers* heights, bool is_long, Numbers*& rows);
  template <bool one_group>
  void integrate(const Edge* edges, int groups);
  template <class F>
  static void each_part(const Part* from, const Part* until, const F& f);
  void add_up(size_t first, size_t count);

  std::array<Pair, kAtOnce> pairs_;
  int count_ = 0;
  bool uneven_ = false;  // a last group has to be filled up
  int most_sides_ = 0, room_ = 0;
  std::vector<Numbers> rows_, copies_;
  std::array<std::vector<Edge>, kGroups> edges_;  // by the groups of the other polygon
  std::array<int, kGroups> listed_{};
  std::vector<Part> parts_;
  int found_ = 0;  // parts
  std::array<PairIntegral, kAtOnce> results_;
};

}  // namespace apothem
