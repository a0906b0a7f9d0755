#include "lib/contact/surface/search.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

namespace apothem {
namespace {

constexpr double kLookTime = 2;    // time for a box, ns
constexpr double kGrowTime = 4;    // time for a surface, ns
constexpr double kChoiceTime = 4;  // time for a pair, ns

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

void Search::search(Surfaces& surfaces, const Threads& threads) {
  if (surfaces.has_outlines() || !search_again(surfaces, threads)) search_all(surfaces, threads);
  choose(surfaces, threads);
}

void Search::choose(const Surfaces& surfaces, const Threads& threads) {
  pairs_of_workers_.begin(threads);
  threads.chunks(static_cast<int>(near_.size()), kChoiceTime, [&](int first, int end, int worker) {
    std::vector<BoxPair>& chosen = pairs_of_workers_.of(worker);
    for (int i = first; i < end; ++i) {
      const BoxPair& pair = near_[static_cast<size_t>(i)];
      if (surfaces.body(pair.first) == surfaces.body(pair.second)) continue;
      const auto responds = [&](SurfaceIndex s) {
        return surfaces.responsive(s) && !surfaces.is_resting(s);
      };
      if (!responds(pair.first) && !responds(pair.second)) continue;
      chosen.push_back(pair);
    }
  });
  pairs_of_workers_.join(pairs_);
}

SearchPlaces Search::places(const Surfaces& surfaces) const {
  SearchPlaces places;
  places.boxes.assign(4 * static_cast<size_t>(surfaces.size()), HUGE_VAL);
  for (size_t i = 0; i < kept_.size(); ++i) {
    const Box& box = kept_[i];
    const std::array sides{box.x0, box.y0, box.x1, box.y1};
    std::ranges::copy(sides, places.boxes.begin() + 4 * static_cast<std::ptrdiff_t>(i));
  }
  places.x = surfaces.outlines().searched_x(), places.y = surfaces.outlines().searched_y();
  return places;
}

void Search::search_at(const SearchPlaces& places, Surfaces& surfaces, const Threads& threads) {
  kept_.assign(static_cast<size_t>(surfaces.size()), Box());
  for (size_t i = 0; i < kept_.size(); ++i) {
    const double* side = &places.boxes[4 * i];
    if (std::isfinite(side[0])) kept_[i] = {side[0], side[1], side[2], side[3]};
  }
  if (surfaces.has_outlines()) surfaces.outlines().prepare_search_at(places.x, places.y);
  grid_.find_pairs(kept_, near_, threads);
  choose(surfaces, threads);
}

void Search::search_all(Surfaces& surfaces, const Threads& threads) {
  const std::vector<Box>& boxes = surfaces.shapes().boxes();
  const bool outlines = surfaces.has_outlines();
  if (outlines) surfaces.outlines().prepare_search();
  kept_.resize(static_cast<size_t>(surfaces.size()));
  threads.chunks(surfaces.size(), kGrowTime, [&](int first, int end, int) {
    for (SurfaceIndex i = first; i < end; ++i) {
      kept_[i] = Box();
      if (!surfaces.is_present(i)) continue;
      if (i < surfaces.shapes().size()) kept_[i] = boxes[i].grown(surfaces.growth(i));
      if (!outlines) continue;
      const Box& box = surfaces.outlines().body_boxes[i];
      kept_[i].include(box.x0, box.y0);
      kept_[i].include(box.x1, box.y1);
    }
  });
  grid_.find_pairs(kept_, near_, threads);
}

// Renews the boxes of those surfaces that have left the inner half of the skin of theirs. The other
// boxes last for as long again, so that searches do not become more frequent.
bool Search::search_again(const Surfaces& surfaces, const Threads& threads) {
  const std::vector<Box>& boxes = surfaces.shapes().boxes();
  if (kept_.size() != boxes.size()) return false;
  changed_of_workers_.begin(threads);
  threads.chunks(surfaces.size(), kGrowTime, [&](int first, int end, int worker) {
    std::vector<SurfaceIndex>& changed = changed_of_workers_.of(worker);
    for (SurfaceIndex i = first; i < end; ++i) {
      if (!surfaces.is_present(i)) continue;
      if (!contains(kept_[i].grown(-surfaces.growth(i) / 2), boxes[i])) changed.push_back(i);
    }
  });
  changed_of_workers_.join(changed_);
  if (kFew * changed_.size() >= boxes.size()) return false;
  for (const SurfaceIndex i : changed_) kept_[i] = boxes[i].grown(surfaces.growth(i));
  grid_.find_pairs_again(kept_, changed_, near_, threads);
  return true;
}

}  // namespace apothem
