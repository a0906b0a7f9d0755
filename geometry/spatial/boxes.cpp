#include "apothem/geometry/spatial/boxes.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace apothem {
namespace {

constexpr std::int32_t kEmpty = INT32_MIN;  // level of an empty box

bool is_empty(const Box& box) { return box.x1 < box.x0; }

// Slot of a cell in the hash table.
size_t slot(std::int64_t column, std::int64_t row, int level, size_t mask) {
  auto h = static_cast<std::uint64_t>(column) * 0x9E3779B97F4A7C15U;
  h ^= static_cast<std::uint64_t>(row) * 0xC2B2AE3D27D4EB4FU;
  h ^= static_cast<std::uint64_t>(level) * 0x165667B19E3779F9U;
  h ^= h >> 32;
  return h & mask;
}

// Index of the cell that contains the coordinate x along one axis. Cells of level l have the size
// 2^l.
std::int64_t cell(double x, int level) { return std::llround(std::floor(std::ldexp(x, -level))); }

}  // namespace

void BoxGrid::find_pairs(const std::vector<Box>& boxes, std::vector<BoxPair>& pairs) {
  pairs.clear();
  const auto n = static_cast<std::int32_t>(boxes.size());
  if (n == 0) return;
  // No level is finer than 2^-50 of the largest coordinate, so that cell indices stay below 2^52.
  double reach = 0;
  for (const Box& box : boxes) {
    if (is_empty(box)) continue;
    reach =
        std::max({reach, std::abs(box.x0), std::abs(box.x1), std::abs(box.y0), std::abs(box.y1)});
  }
  const int finest = reach > 0 ? std::ilogb(reach) - 50 : 0;

  const size_t mask = std::bit_ceil(static_cast<size_t>(2) * n) - 1;
  heads_.assign(mask + 1, -1);
  entries_.resize(n);
  std::vector<int> levels;
  for (std::int32_t i = 0; i < n; ++i) {
    const Box& box = boxes[i];
    if (is_empty(box)) {
      entries_[i].level = kEmpty;
      continue;
    }
    const double extent = box.extent();
    const int level = extent > 0 ? std::max(std::ilogb(extent) + 1, finest) : finest;
    if (std::find(levels.begin(), levels.end(), level) == levels.end()) levels.push_back(level);
    Entry& entry = entries_[i];
    entry = {cell((box.x0 + box.x1) / 2, level), cell((box.y0 + box.y1) / 2, level), -1, level};
    std::int32_t& head = heads_[slot(entry.column, entry.row, level, mask)];
    entry.next = head;
    head = i;
  }

  for (std::int32_t i = 0; i < n; ++i) {
    const Box& box = boxes[i];
    const int own = entries_[i].level;
    if (own == kEmpty) continue;
    for (const int level : levels) {
      if (level < own) continue;
      // A box of this level reaches at most half a cell beyond the cell that contains its centre.
      const double half = std::ldexp(0.5, level);
      const std::int64_t column1 = cell(box.x1 + half, level);
      const std::int64_t row1 = cell(box.y1 + half, level);
      for (std::int64_t column = cell(box.x0 - half, level); column <= column1; ++column) {
        for (std::int64_t row = cell(box.y0 - half, level); row <= row1; ++row) {
          for (std::int32_t j = heads_[slot(column, row, level, mask)]; j >= 0;
               j = entries_[j].next) {
            const Entry& other = entries_[j];
            if (other.level != level || other.column != column || other.row != row) continue;
            if (level == own && j >= i) continue;  // box j reports this pair
            if (!apart(box, boxes[j])) pairs.push_back({std::min(i, j), std::max(i, j)});
          }
        }
      }
    }
  }
  std::sort(pairs.begin(), pairs.end());
}

}  // namespace apothem
