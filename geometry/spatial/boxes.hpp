// The search for all pairs of axis-parallel boxes that overlap. It is the broad phase of contact
// detection.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/polygon/point.hpp"
#include "lib/execution/worker_lists.hpp"

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
/// sizes of the boxes differ by orders of magnitude, and if a few are far away or have no end. Each
/// box is stored once: in the grid level whose cells are just larger than the box, in the cell that
/// contains its centre. It looks for partners in its own level and in all coarser ones. Each thread
/// looks for the partners of a range of boxes; what they have found is put in order afterwards, so
/// that it does not depend on their number.
class BoxGrid {
 public:
  /// Replaces the content of `pairs` by all pairs of boxes that overlap or touch, in ascending
  /// order. Memory is kept between calls. Empty boxes overlap nothing. No box may have a NaN; this
  /// is not checked.
  void find_pairs(const std::vector<Box>& boxes, std::vector<BoxPair>& pairs,
                  const Threads& threads = Threads());
  /// The same where only some boxes, `changed` (ascending), are others than in the last call, and
  /// `pairs` is what that has found. If they are few and not much larger than others, this takes
  /// time linear in their number and in that of the pairs.
  void find_pairs_again(const std::vector<Box>& boxes, std::span<const std::int32_t> changed,
                        std::vector<BoxPair>& pairs, const Threads& threads = Threads());

 private:
  struct Entry {
    std::int64_t column, row;  // cell of the box's centre
    std::int32_t next;         // next box in the same slot of the hash table, or -1
    std::int32_t level;        // the cells of this level have the size 2^level
  };
  [[nodiscard]] int level_of(const Box& box) const;
  /// Finds the cell of a box.
  void locate(std::int32_t i, const Box& box);
  /// Puts a box into the slot of its cell, or takes it out again.
  void enter(std::int32_t i);
  void leave(std::int32_t i);
  void find_partners(const std::vector<Box>& boxes, const Box& in_grid, std::int32_t i,
                     std::vector<BoxPair>& found) const;
  const std::vector<Box>& find_reach(const std::vector<Box>& boxes);
  /// Makes `pairs` all that has been found, in ascending order.
  void sort(std::vector<BoxPair>& pairs, const Threads& threads);
  /// Takes pairs of changed boxes out of `pairs`, and puts those of `added` in; both ascend.
  void merge(std::vector<BoxPair>& pairs, const std::vector<BoxPair>& added,
             const Threads& threads);
  /// Calls f(j) for all boxes j of a level whose centres are in cells that a box and half a cell
  /// around it touch; with `from` only in this entry's cell and in those behind it.
  template <class F>
  void each_near(const Box& box, int level, const Entry* from, F&& f) const;

  std::vector<Entry> entries_;       // one per box
  std::vector<std::int32_t> heads_;  // first box of each slot of the hash table, or -1
  std::vector<int> levels_;          // that have boxes, or have had some
  size_t mask_ = 0;                  // number of slots, a power of two, less one
  double reach_ = 0;                 // largest coordinate in the grid
  std::vector<Box> bounded_;         // memory of `find_reach`
  int finest_ = 0;                   // level
  WorkerLists<BoxPair> found_;
  std::vector<std::int32_t> ends_;  // memory of `sort`: behind the pairs of each first box
  std::vector<char> is_changed_;    // of each box
  std::vector<BoxPair> added_, merged_;
  std::vector<std::ptrdiff_t> sizes_;  // memory of `merge`: pairs that each thread puts there
};

}  // namespace apothem
