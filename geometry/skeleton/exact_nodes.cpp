#include "geometry/skeleton/exact_nodes.hpp"

#include <algorithm>
#include <vector>

#include "geometry/skeleton/fine_frame.hpp"

namespace apothem {

bool place_exactly(Skeleton& skeleton, const Polygon& polygon) {
  const size_t n = skeleton.faces.size();
  std::vector<std::vector<int>> faces_at(skeleton.nodes.size());
  for (size_t f = 0; f < n; ++f) {
    for (const int node : skeleton.faces[f]) faces_at[node].push_back(static_cast<int>(f));
  }
  const FineFrame frame(polygon);
  const std::vector<FineLine> lines = frame.lines();
  skeleton.roof_height = 0;
  for (size_t i = n; i < skeleton.nodes.size(); ++i) {
    if (faces_at[i].size() != 3) return false;
    const FineLine &p = lines[faces_at[i][0]], &q = lines[faces_at[i][1]],
                   &r = lines[faces_at[i][2]];
    const auto sine = [](const FineLine& a, const FineLine& b) -> Fine {
      return a.tx * b.ty - a.ty * b.tx;
    };
    // Cramer's rule for normal . x - t = offset.
    const Fine qr = sine(q, r), rp = sine(r, p), pq = sine(p, q);
    const Fine determinant = qr + rp + pq;
    if (abs(determinant) < kFineNoise) return false;
    const auto mean = [&](const Fine& a, const Fine& b, const Fine& c) -> Fine {
      return a * (r.offset - q.offset) + b * (p.offset - r.offset) + c * (q.offset - p.offset);
    };
    skeleton.nodes[i] =
        frame.node(mean(p.tx, q.tx, r.tx) / determinant, mean(p.ty, q.ty, r.ty) / determinant,
                   -(p.offset * qr + q.offset * rp + r.offset * pq) / determinant);
    skeleton.roof_height = std::max(skeleton.roof_height, skeleton.nodes[i].height);
  }
  return true;
}

}  // namespace apothem
