// The broad phase: which pairs of surfaces are near each other.
//
// Every surface has a box, grown by half of its skin (as in a Verlet list). The pairs of these
// boxes are valid until a surface leaves its grown box, so that most steps need no search, and a
// search treats only the surfaces that have moved.
#pragma once

#include <span>
#include <vector>

#include "geometry/spatial/boxes.hpp"
#include "lib/archive/archive.hpp"
#include "lib/contact/surface/surfaces.hpp"
#include "lib/execution/worker_lists.hpp"

namespace apothem {

/// The positions that the pairs and their candidates follow from. They belong to the state of a
/// run: sums over candidates are rounded in the order of the candidates, and other candidates,
/// which touch nothing, would change that order.
struct SearchPlaces {
  std::vector<double> boxes;  ///< x0, y0, x1, y1 of each surface's box, m; infinite if it is absent
  std::vector<double> x, y;   ///< positions of the vertices of outlines at the last search, m

  void fields(Archive& archive) {
    archive.sized("boxes", boxes).sized("outline_x", x).sized("outline_y", y);
  }
};

class Search {
 public:
  /// True if a surface has left its box since the last search, or is not at a finite position.
  [[nodiscard]] bool stale(const Surfaces& surfaces, const Threads& threads = Threads()) const;
  /// Makes the pairs stale.
  void forget() { kept_.clear(); }
  /// Finds all pairs of near surfaces of two bodies, at least one of which forces can move and does
  /// not rest. All polygons must be at finite positions.
  void search(Surfaces& surfaces, const Threads& threads = Threads());
  /// Chooses the pairs of the last search again, after other bodies have come to rest.
  void choose(const Surfaces& surfaces, const Threads& threads = Threads());
  /// The positions of the last search.
  [[nodiscard]] SearchPlaces places(const Surfaces& surfaces) const;
  /// Repeats a search that had the given positions. The outlines remain at these positions.
  void search_at(const SearchPlaces& places, Surfaces& surfaces,
                 const Threads& threads = Threads());
  /// The pairs, ascending, with first < second.
  [[nodiscard]] std::span<const BoxPair> pairs() const { return pairs_; }
  /// All pairs of near surfaces, ascending, also those of one body and those that nothing moves.
  [[nodiscard]] std::span<const BoxPair> near() const { return near_; }

 private:
  static constexpr size_t kFew = 4;  // moved surfaces are few if they are less than one in kFew

  void search_all(Surfaces& surfaces, const Threads& threads);
  /// Renews the boxes of moved surfaces only. Returns false if too many have moved.
  bool search_again(const Surfaces& surfaces, const Threads& threads);

  std::vector<Box> kept_;
  std::vector<BoxPair> near_;  // pairs of overlapping boxes
  std::vector<BoxPair> pairs_;
  std::vector<SurfaceIndex> changed_;
  WorkerLists<BoxPair> pairs_of_workers_;
  WorkerLists<SurfaceIndex> changed_of_workers_;
  BoxGrid grid_;
};

}  // namespace apothem
