#include "apothem/contact/pair_integrals.hpp"

#include <algorithm>
#include <cmath>

namespace apothem {
namespace {

constexpr double kPairTime = 200;  // ns

}  // namespace

void PairIntegrals::evaluate() {
  const PlacedShapes& shapes = surfaces_.shapes();
  const std::vector<Box>& boxes = shapes.boxes();
  integrals_.resize(pairs_.size());
  threads_.chunks(static_cast<int>(pairs_.size()), kPairTime, [&](int first, int end, int worker) {
    EdgeWorkspace& workspace = workspaces_[worker];
    for (int p = first; p < end; ++p) {
      const auto [a, b] = pairs_[p];
      if (apart(boxes[a], boxes[b])) {
        integrals_[p] = {};
      } else {
        integrals_[p] =
            pair_integral(shapes.view(a), shapes.view(b), surfaces_.between(a, b), workspace);
      }
    }
  });
}

double PairIntegrals::energy(const PairTable& table) const {
  const PlacedShapes& shapes = surfaces_.shapes();
  double energy = 0;
  for (size_t p = 0; p < pairs_.size(); ++p) {
    if (!integrals_[p].touching()) continue;
    const auto [a, b] = pairs_[p];
    const double k = table.between(surfaces_.body(a), surfaces_.body(b)).normal_stiffness;
    energy += k * pair_volume(shapes.view(a), shapes.view(b), surfaces_.between(a, b)).energy;
  }
  return energy;
}

Contact PairIntegrals::contact(KernelKind kernel, size_t p, double k) const {
  const auto [a, b] = pairs_[p];
  const PairIntegral& pair = integrals_[p];
  const PlacedShapes& shapes = surfaces_.shapes();
  const double ratio = std::max(shapes.depth_ratio(a), shapes.depth_ratio(b));
  return {kernel,
          a,
          b,
          pair.depth,
          pair.largest_phi < 1 ? ratio * pair.depth : HUGE_VAL,  // phi may be limited to 1
          pair.largest_phi,
          k * (pair.own_length_a * shapes.slope(b) + pair.own_length_b * shapes.slope(a))};
}

bool PairIntegrals::too_deep(size_t p) const {
  const auto [a, b] = pairs_[p];
  const PairIntegral& pair = integrals_[p];
  if (!(pair.largest_phi <= kDeepestPhi)) return true;
  if (pair.own_length_a + pair.own_length_b <
      std::min(surfaces_.inradius(a), surfaces_.inradius(b))) {
    return false;
  }
  const PlacedShapes& shapes = surfaces_.shapes();
  const Vec2 offset = surfaces_.between(a, b);
  return shapes.top_inside(a, surfaces_.pose(a)[2], b, offset) ||
         shapes.top_inside(b, surfaces_.pose(b)[2], a, -offset);
}

}  // namespace apothem
