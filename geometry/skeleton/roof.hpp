// The roof of a polygon that is not convex: the distance potential phi over its straight skeleton,
// stored as a planar graph. phi is linear in every face of the skeleton, continuous across its arcs
// and zero on the boundary. Along any line it is therefore linear between the points where the line
// crosses arcs.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "geometry/polygon/line_crossings.hpp"
#include "geometry/polygon/point.hpp"
#include "geometry/skeleton/skeleton.hpp"

namespace apothem {

/// A roof over a polygon with n vertices.
struct Roof {
  /// Coordinates of the nodes relative to the polygon's origin(), m. The first n nodes are the
  /// polygon's vertices.
  std::vector<Vec2> points;
  std::vector<double> values;  ///< phi at the nodes, not limited to 1
  /// The two nodes of each arc. The first n arcs are the polygon's edges.
  std::vector<std::array<int, 2>> arcs;
  std::vector<std::vector<int>> faces;  ///< per edge: nodes of its face, counter-clockwise
};

/// Makes the roof whose values are the heights of the skeleton's nodes divided by `reference` (m).
Roof make_roof(const Skeleton& skeleton, double reference);

/// A roof at the present position of its polygon: pointers to its graph, and to the coordinates of
/// its nodes in some frame.
template <class Real>
struct PlacedRoof {
  const std::vector<std::array<int, 2>>* arcs;  ///< the two nodes of each arc
  int boundary;        ///< number of the polygon's edges, which are the first arcs
  int nodes;           ///< number of nodes
  const Real* x;       ///< x coordinates of the nodes, m
  const Real* y;       ///< y coordinates of the nodes, m
  const Real* values;  ///< phi at the nodes, not limited to 1
};

/// Evaluates phi along a segment. Each crossing with an arc is computed once and serves both of the
/// arc's faces, so phi has no gap there.
template <class Real>
class RoofTrace {
 public:
  /// Finds the crossings of the arcs with the line p + s e. The segment is the part of the line
  /// with s in [0, 1].
  void cross(const PlacedRoof<Real>& roof, const Real& px, const Real& py, const Real& ex,
             const Real& ey) {
    lines_.set(roof.nodes, roof.x, roof.y, px, py, ex, ey);
    crossings_.clear();
    lines_.place(0, roof.boundary);
    add_crossings(roof, 0, roof.boundary);
    if (outside()) {
      crossings_.clear();
      return;
    }
    lines_.place(roof.boundary, roof.nodes);
    add_crossings(roof, roof.boundary, static_cast<int>(roof.arcs->size()));
    std::sort(crossings_.begin(), crossings_.end(),
              [](const Crossing& a, const Crossing& b) { return a.s < b.s; });
  }

  /// Calls piece(s, phi, s_next, phi_next) for every part of the segment inside the polygon on
  /// which phi is linear. Call cross first.
  template <class Piece>
  void pieces(const Piece& piece) const {
    segments(piece, [](const Real&, int, const Real&, int) {});
  }

  /// As pieces. In addition it calls segment(s, edge, s_next, edge_next) for every connected part
  /// of the segment inside the polygon, after the last piece of that part. `edge` and `edge_next`
  /// are the polygon's edges that the segment crosses at the ends of the part, or -1 at an end of
  /// the segment itself.
  template <class Piece, class Segment>
  void segments(const Piece& piece, const Segment& segment) const {
    bool inside = false;
    bool open = false;
    const Crossing* first = nullptr;
    const auto close = [&](const Crossing& last) {
      segment(std::max(first->s, Real(0)), first->s < 0 ? -1 : first->edge,
              std::min(last.s, Real(1)), last.s > 1 ? -1 : last.edge);
      open = false;
    };
    for (size_t i = 0; i + 1 < crossings_.size(); ++i) {
      const Crossing& a = crossings_[i];
      const Crossing& b = crossings_[i + 1];
      if (a.edge >= 0) {
        if (open) close(a);
        inside = !inside;
        first = &a;
      }
      if (!inside || b.s <= 0 || a.s >= 1 || !(b.s > a.s)) continue;
      const auto at = [&](const Real& s) -> Real {
        return a.value + (s - a.s) / (b.s - a.s) * (b.value - a.value);
      };
      piece(std::max(a.s, Real(0)), a.s < 0 ? at(0) : a.value, std::min(b.s, Real(1)),
            b.s > 1 ? at(1) : b.value);
      open = true;
    }
    if (open) close(crossings_.back());
  }

 private:
  struct Crossing {
    Real s, value;
    int edge;  // index of the crossed edge of the polygon, or -1 for another arc
  };

  // Adds the crossings with the arcs first to last - 1. Those that are crossed are listed first,
  // without a branch, because which ones these are cannot be predicted.
  void add_crossings(const PlacedRoof<Real>& roof, int first, int last) {
    crossed_.resize(roof.arcs->size() + 1);
    const std::array<int, 2>* const arcs = roof.arcs->data();
    int* const crossed = crossed_.data();
    int count = 0;
    for (int k = first; k < last; ++k) {
      crossed[count] = k;
      count += lines_.crosses(arcs[k][0], arcs[k][1]);
    }
    for (int i = 0; i < count; ++i) {
      const int k = crossed[i];
      const auto [a, b] = arcs[k];
      const Real& start = roof.values[a];
      const Real& end = roof.values[b];
      lines_.cross(a, b, [&](const Real& s, const Real& w) {
        crossings_.push_back({s, start + w * (end - start), k < roof.boundary ? k : -1});
      });
    }
  }

  // True if the segment lies outside the polygon, by its crossings with the boundary: none of them
  // on the segment, and an even number before it.
  [[nodiscard]] bool outside() const {
    bool even = true;
    for (const Crossing& c : crossings_) {
      if (!(c.s <= 0) && !(c.s >= 1)) return false;
      if (c.s <= 0) even = !even;
    }
    return even;
  }

  LineCrossings<Real> lines_;
  std::vector<Crossing> crossings_;
  std::vector<int> crossed_;  // numbers of arcs that the line crosses
};

}  // namespace apothem
