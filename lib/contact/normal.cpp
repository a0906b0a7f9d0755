#include "apothem/contact/normal.hpp"

#include <omp.h>

namespace apothem {
namespace {

// Below this many pairs the threads cost more than they give.
constexpr int kPairsWorthThreads = 2000;

Vec2 between(const std::vector<double>& position, const BoxPair& pair) {
  const double* a = position.data() + 3 * static_cast<size_t>(pair.first);
  const double* b = position.data() + 3 * static_cast<size_t>(pair.second);
  return {a[0] - b[0], a[1] - b[1]};
}

}  // namespace

void NormalContact::evaluate(const PlacedShapes& shapes, const std::vector<double>& position,
                             const std::vector<BoxPair>& pairs) {
  integrals_.resize(pairs.size());
  const std::vector<Box>& boxes = shapes.boxes();
  const auto evaluate_pair = [&](int p, EdgeWorkspace& workspace) {
    const auto [a, b] = pairs[p];
    if (apart(boxes[a], boxes[b])) {
      integrals_[p] = {};
      return;
    }
    integrals_[p] =
        pair_integral(shapes.view(a), shapes.view(b), between(position, pairs[p]), workspace);
  };
  const int count = static_cast<int>(pairs.size());
  if (threads() == 1 || count < kPairsWorthThreads) {
    for (int p = 0; p < count; ++p) evaluate_pair(p, workspaces_[0]);
    return;
  }
#pragma omp parallel for schedule(static) num_threads(threads())
  for (int p = 0; p < count; ++p) evaluate_pair(p, workspaces_[omp_get_thread_num()]);
}

double NormalContact::energy(const PlacedShapes& shapes, const std::vector<double>& position,
                             const std::vector<BoxPair>& pairs) const {
  double energy = 0;
  for (size_t p = 0; p < pairs.size(); ++p) {
    if (!integrals_[p].touching()) continue;
    const auto [a, b] = pairs[p];
    energy += pair_volume(shapes.view(a), shapes.view(b), between(position, pairs[p])).energy;
  }
  return energy;
}

}  // namespace apothem
