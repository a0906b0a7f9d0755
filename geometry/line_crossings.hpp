// Where a line crosses the arcs of a planar graph, by one sign per node (half-open rule) and no
// tolerance: whichever way round-off decides the signs, a closed chain is crossed an even number of
// times.
#pragma once

#include <vector>

namespace apothem {

template <class Real>
class LineCrossings {
 public:
  /// The line p + s e, and the nodes of the graph, which have to stay where they are.
  void set(int nodes, const Real* x, const Real* y, const Real& px, const Real& py, const Real& ex,
           const Real& ey) {
    side_.resize(nodes);
    x_ = x, y_ = y, px_ = px, py_ = py, ex_ = ex, ey_ = ey;
    inverse_ = 1 / (ex * ex + ey * ey);
  }

  /// On which side of the line nodes first ... last - 1 are.
  void place(int first, int last) {
    const Real px = px_, py = py_, ex = ex_, ey = ey_;  // so that the loop needs no reload
    Real* const side = side_.data();
    for (int i = first; i < last; ++i) side[i] = ex * (y_[i] - py) - ey * (x_[i] - px);
  }

  /// Calls crossing(s, share) if the line crosses the arc from node a to b (both placed), at
  /// `share` of the arc.
  template <class Crossing>
  void cross(int a, int b, const Crossing& crossing) const {
    if ((side_[a] >= 0) == (side_[b] >= 0)) return;
    const Real w = side_[a] / (side_[a] - side_[b]);
    const Real start = along(a);
    crossing(start + w * (along(b) - start), w);
  }

 private:
  [[nodiscard]] Real along(int i) const {
    return (ex_ * (x_[i] - px_) + ey_ * (y_[i] - py_)) * inverse_;
  }

  const Real* x_ = nullptr;
  const Real* y_ = nullptr;
  Real px_, py_, ex_, ey_, inverse_;
  std::vector<Real> side_;
};

}  // namespace apothem
