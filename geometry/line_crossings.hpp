// Where a line crosses the arcs of a planar graph, by one sign per node (half-open rule) and no
// tolerance: whichever way round-off decides the signs, a closed chain is crossed an even number of
// times.
#pragma once

#include <vector>

namespace apothem {

template <class Real>
class LineCrossings {
 public:
  /// The line p + s e and the nodes of the graph.
  void place(int nodes, const Real* x, const Real* y, const Real& px, const Real& py,
             const Real& ex, const Real& ey) {
    side_.resize(nodes);
    along_.resize(nodes);
    const Real inverse = 1 / (ex * ex + ey * ey);
    for (int i = 0; i < nodes; ++i) {
      const Real rx = x[i] - px;
      const Real ry = y[i] - py;
      side_[i] = ex * ry - ey * rx;
      along_[i] = (ex * rx + ey * ry) * inverse;
    }
  }

  /// Calls crossing(s, share) if the line crosses the arc from node a to b, at `share` of the arc.
  template <class Crossing>
  void cross(int a, int b, const Crossing& crossing) const {
    if ((side_[a] >= 0) == (side_[b] >= 0)) return;
    const Real w = side_[a] / (side_[a] - side_[b]);
    crossing(along_[a] + w * (along_[b] - along_[a]), w);
  }

 private:
  std::vector<Real> side_, along_;
};

}  // namespace apothem
