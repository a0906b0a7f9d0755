// The roof of a polygon that is not convex: the potential over its straight skeleton as a graph.
// phi is linear in every face, continuous across the arcs and zero on the boundary, so along any
// line it is linear between the points where the line crosses arcs.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "geometry/line_crossings.hpp"
#include "geometry/point.hpp"
#include "geometry/skeleton.hpp"

namespace apothem {

struct Roof {
  std::vector<Vec2> points;              ///< nodes; the first n are the polygon's vertices
  std::vector<double> values;            ///< phi there, without the cap
  std::vector<std::array<int, 2>> arcs;  ///< nodes; the first n are the polygon's edges
  std::vector<std::vector<int>> faces;   ///< of edge e: nodes, counter-clockwise
};

/// Heights divided by `reference` (m).
Roof make_roof(const Skeleton& skeleton, double reference);

/// A roof where it is now: its graph and the coordinates of its nodes.
template <class Real>
struct PlacedRoof {
  const std::vector<std::array<int, 2>>* arcs;
  int boundary;  ///< so many of the arcs are the polygon's edges
  int nodes;
  const Real* x;
  const Real* y;
  const Real* values;
};

/// phi along a segment: every crossing of an arc is computed once and belongs to both of its faces.
template <class Real>
class RoofTrace {
 public:
  /// Finds the crossings of the line p + s e.
  void cross(const PlacedRoof<Real>& roof, const Real& px, const Real& py, const Real& ex,
             const Real& ey) {
    lines_.set(roof.nodes, roof.x, roof.y, px, py, ex, ey);
    crossings_.clear();
    const auto cross_arc = [&](int k) {
      const auto [a, b] = (*roof.arcs)[k];
      const Real& start = roof.values[a];
      const Real& end = roof.values[b];
      lines_.cross(a, b, [&](const Real& s, const Real& w) {
        crossings_.push_back({s, start + w * (end - start), k < roof.boundary ? k : -1});
      });
    };
    lines_.place(0, roof.boundary);
    for (int k = 0; k < roof.boundary; ++k) cross_arc(k);
    if (crossings_.empty()) return;  // the line misses the polygon
    lines_.place(roof.boundary, roof.nodes);
    for (int k = roof.boundary; k < static_cast<int>(roof.arcs->size()); ++k) cross_arc(k);
    std::sort(crossings_.begin(), crossings_.end(),
              [](const Crossing& a, const Crossing& b) { return a.s < b.s; });
  }

  /// Calls piece(s, phi, s_next, phi_next) for every linear piece inside the polygon, s in [0, 1].
  template <class Piece>
  void pieces(const Piece& piece) const {
    runs(piece, [](const Real&, int, const Real&, int) {});
  }

  /// The same, and run(s, edge, s_next, edge_next) after the last piece of every part inside the
  /// polygon, with the polygon's edges that the line crosses there, -1 at the ends of the segment.
  template <class Piece, class Run>
  void runs(const Piece& piece, const Run& run) const {
    bool inside = false;
    bool open = false;
    const Crossing* first = nullptr;
    const auto close = [&](const Crossing& last) {
      run(std::max(first->s, Real(0)), first->s < 0 ? -1 : first->edge, std::min(last.s, Real(1)),
          last.s > 1 ? -1 : last.edge);
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
    int edge;  // of the polygon, or -1
  };
  LineCrossings<Real> lines_;
  std::vector<Crossing> crossings_;
};

}  // namespace apothem
