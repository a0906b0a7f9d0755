// Broad phase: which axis-parallel boxes overlap.
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/point.hpp"

namespace apothem {

/// NaN is never contained.
inline bool contains(const Box& outer, const Box& inner) {
  return inner.x0 >= outer.x0 && inner.y0 >= outer.y0 && inner.x1 <= outer.x1 &&
         inner.y1 <= outer.y1;
}

/// Indices of two boxes, first < second.
struct BoxPair {
  std::int32_t first;
  std::int32_t second;
  auto operator<=>(const BoxPair&) const = default;
};

/// All pairs of overlapping (or touching) boxes, in ascending order: a hierarchical hash grid,
/// linear in the number of boxes and pairs also when sizes differ by orders of magnitude. Each box
/// lives at its centre in the level whose cells are just larger than the box; it looks for partners
/// in its own and in all coarser levels. Empty boxes and boxes with NaN must not be passed.
class BoxGrid {
 public:
  /// `pairs` is cleared and filled. Memory is kept between calls.
  void find_pairs(const std::vector<Box>& boxes, std::vector<BoxPair>& pairs);

 private:
  struct Entry {
    std::int64_t column, row;
    std::int32_t next;
    std::int32_t level;
  };
  std::vector<Entry> entries_;
  std::vector<std::int32_t> heads_;
};

}  // namespace apothem
