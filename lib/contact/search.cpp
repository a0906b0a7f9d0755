#include "apothem/contact/search.hpp"

#include <atomic>

namespace apothem {
namespace {

constexpr double kLookTime = 2;  // of a box, ns

}  // namespace

bool Search::stale(const Surfaces& surfaces, const Threads& threads) const {
  if (static_cast<int>(kept_.size()) != surfaces.size()) return true;
  if (surfaces.has_outlines() && surfaces.outlines().stale()) return true;
  const std::vector<Box>& boxes = surfaces.shapes().boxes();
  std::atomic<bool> left = false;
  threads.chunks(static_cast<int>(boxes.size()), kLookTime, [&](int first, int end, int) {
    for (SurfaceIndex i = first; i < end; ++i) {
      if (!contains(kept_[i], boxes[i]) && surfaces.is_present(i)) {
        left = true;
        return;
      }
    }
  });
  return left;
}

void Search::search(Surfaces& surfaces) {
  if (surfaces.has_outlines() || !search_again(surfaces)) search_all(surfaces);
  pairs_.clear();
  for (const BoxPair& pair : near_) {
    if (surfaces.body(pair.first) == surfaces.body(pair.second)) continue;
    if (!surfaces.responsive(pair.first) && !surfaces.responsive(pair.second)) continue;
    pairs_.push_back(pair);
  }
}

void Search::search_all(Surfaces& surfaces) {
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
  grid_.find_pairs(kept_, near_);
}

// Gives new boxes to the surfaces that have left the inner half of the margins of theirs. The
// others need none for as long again, so searches do not come more often for it.
bool Search::search_again(const Surfaces& surfaces) {
  const std::vector<Box>& boxes = surfaces.shapes().boxes();
  if (kept_.size() != boxes.size()) return false;
  changed_.clear();
  for (SurfaceIndex i = 0; i < surfaces.size(); ++i) {
    if (!surfaces.is_present(i)) continue;
    if (!contains(kept_[i].grown(-surfaces.growth(i) / 2), boxes[i])) changed_.push_back(i);
  }
  if (kFew * changed_.size() >= boxes.size()) return false;
  for (const SurfaceIndex i : changed_) kept_[i] = boxes[i].grown(surfaces.growth(i));
  grid_.find_pairs_again(kept_, changed_, near_);
  return true;
}

}  // namespace apothem
