// The search for all pairs of axis-parallel boxes that overlap. It is the broad phase of contact
// detection.
#pragma once

#include <cstdint>
#include <vector>

#include "apothem/geometry/polygon/point.hpp"

namespace apothem {

/// True if `inner` lies inside `outer` or touches its border from inside. A box with a NaN is never
/// contained.
inline bool contains(const Box& outer, const Box& inner) {
  return inner.x0 >= outer.x0 && inner.y0 >= outer.y0 && inner.x1 <= outer.x1 &&
         inner.y1 <= outer.y1;
}

/// Indices of two boxes, where first < second.
struct BoxPair {
  std::int32_t first;
  std::int32_t second;
  auto operator<=>(const BoxPair&) const = default;
};

/// A hierarchical hash grid. It takes time linear in the number of boxes and of pairs, also if the
/// sizes of the boxes differ by orders of magnitude. Each box is stored once: in the grid level
/// whose cells are just larger than the box, in the cell that contains its centre. It looks for
/// partners in its own level and in all coarser ones.
class BoxGrid {
 public:
  /// Replaces the content of `pairs` by all pairs of boxes that overlap or touch, in ascending
  /// order. Memory is kept between calls. Empty boxes overlap nothing. No box may have a NaN; this
  /// is not checked.
  void find_pairs(const std::vector<Box>& boxes, std::vector<BoxPair>& pairs);

 private:
  struct Entry {
    std::int64_t column, row;  // cell of the box's centre
    std::int32_t next;         // next box in the same slot of the hash table, or -1
    std::int32_t level;        // the cells of this level have the size 2^level
  };
  std::vector<Entry> entries_;       // one per box
  std::vector<std::int32_t> heads_;  // first box of each slot of the hash table, or -1
};

}  // namespace apothem
