#include "apothem/contact/search.hpp"

namespace apothem {

bool Search::stale(const Surfaces& surfaces) const {
  if (static_cast<int>(kept_.size()) != surfaces.size()) return true;
  const std::vector<Box>& boxes = surfaces.shapes().boxes();
  for (size_t i = 0; i < boxes.size(); ++i) {
    if (!contains(kept_[i], boxes[i]) && surfaces.is_present(static_cast<SurfaceIndex>(i))) {
      return true;
    }
  }
  return surfaces.has_outlines() && surfaces.outlines().stale();
}

void Search::search(Surfaces& surfaces) {
  const std::vector<Box>& boxes = surfaces.shapes().boxes();
  kept_.clear();
  for (SurfaceIndex i = 0; i < surfaces.shapes().size(); ++i) {
    kept_.push_back(boxes[i].grown(surfaces.growth(i)));
  }
  if (surfaces.has_outlines()) {
    surfaces.outlines().prepare_search();
    kept_.resize(surfaces.size());
    for (SurfaceIndex i = 0; i < surfaces.size(); ++i) {
      const Box& box = surfaces.outlines().body_boxes[i];
      kept_[i].include(box.x0, box.y0);
      kept_[i].include(box.x1, box.y1);
    }
  }
  for (SurfaceIndex i = 0; i < surfaces.size(); ++i) {
    if (!surfaces.is_present(i)) kept_[i] = Box();
  }
  grid_.find_pairs(kept_, pairs_);
  std::erase_if(pairs_, [&](const BoxPair& pair) {
    return surfaces.body(pair.first) == surfaces.body(pair.second) ||
           (!surfaces.responsive(pair.first) && !surfaces.responsive(pair.second));
  });
}

}  // namespace apothem
