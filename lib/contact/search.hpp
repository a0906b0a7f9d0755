// The broad phase: which pairs of surfaces are near each other.
//
// Every surface has a box, grown by half of its skin. The pairs of these boxes serve until a
// surface leaves its grown box, so that most steps need no search.
#pragma once

#include <span>
#include <vector>

#include "apothem/contact/surfaces.hpp"
#include "apothem/geometry/spatial/boxes.hpp"

namespace apothem {

class Search {
 public:
  /// True if a surface has left its box since the last search, or is not at a finite place.
  [[nodiscard]] bool stale(const Surfaces& surfaces) const;
  /// Has the next look find the pairs stale.
  void forget() { kept_.clear(); }
  /// Finds all pairs of near surfaces of two bodies, at least one of which forces can move. All
  /// polygons must be at finite places.
  void search(Surfaces& surfaces);
  /// Ascending, with first < second.
  [[nodiscard]] std::span<const BoxPair> pairs() const { return pairs_; }

 private:
  std::vector<Box> kept_;
  std::vector<BoxPair> pairs_;
  BoxGrid grid_;
};

}  // namespace apothem
