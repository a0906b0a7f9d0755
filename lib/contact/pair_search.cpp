#include "apothem/contact/pair_search.hpp"

#include <cmath>

namespace apothem {

bool PairSearch::stale(const PlacedShapes& shapes, const std::vector<double>& position) const {
  if (last_.size() != position.size()) return true;
  for (int i = 0; i < shapes.size(); ++i) {
    const double* now = position.data() + 3 * static_cast<size_t>(i);
    const double* then = last_.data() + 3 * static_cast<size_t>(i);
    const double moved = std::hypot(now[0] - then[0], now[1] - then[1]) +
                         shapes.radius(i) * std::abs(now[2] - then[2]);
    if (!(moved <= skin_ / 2)) return true;
  }
  return false;
}

void PairSearch::search(const PlacedShapes& shapes, const std::vector<double>& position) {
  last_ = position;
  grown_.clear();
  for (const Box& box : shapes.boxes()) grown_.push_back(box.grown(skin_ / 2));
  grid_.find_pairs(grown_, pairs_);
  std::erase_if(
      pairs_, [&](const BoxPair& pair) { return !movable_[pair.first] && !movable_[pair.second]; });
}

}  // namespace apothem
