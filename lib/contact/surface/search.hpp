// The broad phase: which pairs of surfaces are near each other.
//
// Every surface has a box, grown by half of its skin. The pairs of these boxes serve until a
// surface leaves its grown box, so that most steps need no search, and a search looks only for the
// partners of those that have moved.
#pragma once

#include <span>
#include <vector>

#include "geometry/spatial/boxes.hpp"
#include "lib/archive/archive.hpp"
#include "lib/contact/surface/surfaces.hpp"
#include "lib/execution/worker_lists.hpp"

namespace apothem {

/// What the pairs and the candidates in them follow from. It belongs to the state of a run: sums
/// over candidates are rounded in the order in which these stand, and other candidates, which touch
/// nothing, would shift them.
struct SearchPlaces {
  std::vector<double> boxes;  ///< x0, y0, x1, y1 of each surface, m; infinite where it is absent
  std::vector<double> x, y;   ///< of the vertices of outlines at the last search, m

  void fields(Archive& archive) {
    archive.sized("boxes", boxes).sized("outline_x", x).sized("outline_y", y);
  }
};

class Search {
 public:
  /// True if a surface has left its box since the last search, or is not at a finite place.
  [[nodiscard]] bool stale(const Surfaces& surfaces, const Threads& threads = Threads()) const;
  /// Has the next look find the pairs stale.
  void forget() { kept_.clear(); }
  /// Finds all pairs of near surfaces of two bodies, at least one of which forces can move. All
  /// polygons must be at finite places.
  void search(Surfaces& surfaces, const Threads& threads = Threads());
  /// Those of the last search.
  [[nodiscard]] SearchPlaces places(const Surfaces& surfaces) const;
  /// Finds again what a search has found that had these places. Leaves outlines there.
  void search_at(const SearchPlaces& places, Surfaces& surfaces,
                 const Threads& threads = Threads());
  /// Ascending, with first < second.
  [[nodiscard]] std::span<const BoxPair> pairs() const { return pairs_; }

 private:
  static constexpr size_t kFew = 4;  // surfaces are few if they are less than one in so many

  void search_all(Surfaces& surfaces, const Threads& threads);
  void choose(const Surfaces& surfaces, const Threads& threads);
  /// False if too many have moved.
  bool search_again(const Surfaces& surfaces, const Threads& threads);

  std::vector<Box> kept_;
  std::vector<BoxPair> near_;  // pairs of boxes
  std::vector<BoxPair> pairs_;
  std::vector<SurfaceIndex> changed_;
  WorkerLists<BoxPair> pairs_of_workers_;
  WorkerLists<SurfaceIndex> changed_of_workers_;
  BoxGrid grid_;
};

}  // namespace apothem
