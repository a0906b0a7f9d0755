// The crossings of a straight line with the arcs of a planar graph, such as the edges of a polygon
// or the arcs of a straight skeleton. One sign per node decides them, by a half-open rule and
// without a tolerance. In whichever way round-off decides the signs, a closed chain of arcs is
// crossed an even number of times.
#pragma once

#include <vector>

namespace apothem {

/// Finds where a line crosses arcs. Call set, then place for the nodes that are needed, then cross
/// for every arc between placed nodes. `Real` is any number type. No member throws, except for lack
/// of memory.
template <class Real>
class LineCrossings {
 public:
  /// Sets the line p + s e and the coordinates x, y of `nodes` nodes. The arrays are not copied and
  /// have to outlive the calls of place and cross.
  void set(int nodes, const Real* x, const Real* y, const Real& px, const Real& py, const Real& ex,
           const Real& ey) {
    side_.resize(nodes);
    left_.resize(nodes);
    x_ = x, y_ = y, px_ = px, py_ = py, ex_ = ex, ey_ = ey;
    inverse_ = 1 / (ex * ex + ey * ey);
  }

  /// Computes on which side of the line the nodes first to last - 1 are.
  void place(int first, int last) {
    const Real px = px_, py = py_, ex = ex_, ey = ey_;  // copies: no reload in the loop
    Real* const side = side_.data();
    for (int i = first; i < last; ++i) side[i] = ex * (y_[i] - py) - ey * (x_[i] - px);
    unsigned char* const left = left_.data();
    for (int i = first; i < last; ++i) left[i] = side[i] >= 0;
  }

  /// True if place() finds all nodes in a box on the same side of the line. Rounding keeps the
  /// order of numbers, so that this has no tolerance.
  [[nodiscard]] bool passes(const Real& x0, const Real& y0, const Real& x1, const Real& y1) const {
    const Real most = ex_ * ((ex_ > 0 ? y1 : y0) - py_) - ey_ * ((ey_ > 0 ? x0 : x1) - px_);
    const Real least = ex_ * ((ex_ > 0 ? y0 : y1) - py_) - ey_ * ((ey_ > 0 ? x1 : x0) - px_);
    return least >= 0 || !(most >= 0);
  }

  /// True if the line crosses the arc from node a to node b, both of which have been placed.
  [[nodiscard]] bool crosses(int a, int b) const { return left_[a] != left_[b]; }

  /// Calls crossing(s, share) if the line crosses the arc from node a to node b, both of which have
  /// been placed. The crossing is the point p + s e of the line; `share` is its position on the
  /// arc, 0 at a and 1 at b.
  template <class Crossing>
  void cross(int a, int b, const Crossing& crossing) const {
    if (!crosses(a, b)) return;
    const Real w = side_[a] / (side_[a] - side_[b]);
    const Real start = along(a);
    crossing(start + w * (along(b) - start), w);
  }

 private:
  // Parameter s of the foot of the perpendicular from node i on the line.
  [[nodiscard]] Real along(int i) const {
    return (ex_ * (x_[i] - px_) + ey_ * (y_[i] - py_)) * inverse_;
  }

  const Real* x_ = nullptr;
  const Real* y_ = nullptr;
  Real px_, py_, ex_, ey_, inverse_;
  std::vector<Real> side_;  // per node: distance from the line times |e|, positive on the left
  std::vector<unsigned char> left_;  // per node: whether it is on the left or on the line
};

}  // namespace apothem
