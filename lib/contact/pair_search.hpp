// Candidate pairs for the contact kernel, found on boxes grown by a skin and kept until some body
// has moved through half of it.
#pragma once

#include <vector>

#include "apothem/contact/placed_shapes.hpp"
#include "apothem/geometry/spatial/boxes.hpp"

namespace apothem {

class PairSearch {
 public:
  /// `movable[i]`: pairs of two bodies that cannot move are never reported. `skin` in m.
  PairSearch(std::vector<bool> movable, double skin) : movable_(std::move(movable)), skin_(skin) {}

  /// True when a body has moved (x, y, angle: three entries per body) farther than half the skin
  /// since the last search. A NaN counts as moved.
  [[nodiscard]] bool stale(const PlacedShapes& shapes, const std::vector<double>& position) const;

  /// Searches anew.
  void search(const PlacedShapes& shapes, const std::vector<double>& position);

  /// Ascending, first < second.
  [[nodiscard]] const std::vector<BoxPair>& pairs() const { return pairs_; }
  [[nodiscard]] double skin() const { return skin_; }

 private:
  std::vector<bool> movable_;
  double skin_;
  std::vector<double> last_;  // positions at the last search
  std::vector<Box> grown_;
  std::vector<BoxPair> pairs_;
  BoxGrid grid_;
};

}  // namespace apothem
