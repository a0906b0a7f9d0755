// The roof of a polygon that is not convex: the potential over its straight skeleton as a graph.
// phi is linear in every face, continuous across the arcs and zero on the boundary, so along any
// line it is linear between the points where the line crosses arcs.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

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

/// phi along a segment, by one sign per node (half-open rule) and no tolerance: every crossing of
/// an arc is computed once and belongs to both of its faces, whichever way round-off decides the
/// signs.
template <class Real>
class RoofTrace {
 public:
  /// Finds the crossings of the line p + s e.
  void cross(const PlacedRoof<Real>& roof, const Real& px, const Real& py, const Real& ex,
             const Real& ey) {
    side_.resize(roof.nodes);
    along_.resize(roof.nodes);
    const Real inverse = 1 / (ex * ex + ey * ey);
    for (int i = 0; i < roof.nodes; ++i) {
      const Real rx = roof.x[i] - px;
      const Real ry = roof.y[i] - py;
      side_[i] = ex * ry - ey * rx;
      along_[i] = (ex * rx + ey * ry) * inverse;
    }
    crossings_.clear();
    for (int k = 0; k < static_cast<int>(roof.arcs->size()); ++k) {
      const auto [a, b] = (*roof.arcs)[k];
      if ((side_[a] >= 0) == (side_[b] >= 0)) continue;
      const Real w = side_[a] / (side_[a] - side_[b]);
      crossings_.push_back({along_[a] + w * (along_[b] - along_[a]),
                            roof.values[a] + w * (roof.values[b] - roof.values[a]),
                            k < roof.boundary});
    }
    std::sort(crossings_.begin(), crossings_.end(),
              [](const Crossing& a, const Crossing& b) { return a.s < b.s; });
  }

  /// Calls piece(s, phi, s_next, phi_next) for every linear piece inside the polygon, s in [0, 1].
  template <class Piece>
  void pieces(const Piece& piece) const {
    bool inside = false;
    for (size_t i = 0; i + 1 < crossings_.size(); ++i) {
      const Crossing& a = crossings_[i];
      const Crossing& b = crossings_[i + 1];
      inside ^= a.boundary;
      if (!inside || b.s <= 0 || a.s >= 1 || !(b.s > a.s)) continue;
      const auto at = [&](const Real& s) -> Real {
        return a.value + (s - a.s) / (b.s - a.s) * (b.value - a.value);
      };
      piece(std::max(a.s, Real(0)), a.s < 0 ? at(0) : a.value, std::min(b.s, Real(1)),
            b.s > 1 ? at(1) : b.value);
    }
  }

 private:
  struct Crossing {
    Real s, value;
    bool boundary;
  };
  std::vector<Real> side_, along_;
  std::vector<Crossing> crossings_;
};

}  // namespace apothem
