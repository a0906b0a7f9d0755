#include "geometry/spatial/boxes.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <utility>

namespace apothem {
namespace {

constexpr std::int32_t kEmpty = INT32_MIN;  // level of an empty box
constexpr double kFarthest = 0x1p1000;      // where coordinates of cells end, m
constexpr int kBits = 50;                   // of the numbers of cells
constexpr size_t kFew = 4;                  // boxes are few if they are less than one in so many
// ns, of a box:
constexpr double kLocateTime = 8, kLookTime = 150, kSortTime = 20, kMergeTime = 8;

bool is_empty(const Box& box) { return box.x1 < box.x0; }

// Slot of a cell in the hash table.
size_t slot(std::int64_t column, std::int64_t row, int level, size_t mask) {
  auto h = static_cast<std::uint64_t>(column) * 0x9E3779B97F4A7C15U;
  h ^= static_cast<std::uint64_t>(row) * 0xC2B2AE3D27D4EB4FU;
  h ^= static_cast<std::uint64_t>(level) * 0x165667B19E3779F9U;
  h ^= h >> 32;
  return h & mask;
}

// 2^e for exponents of normal numbers.
double power_of_two(int e) {
  return std::bit_cast<double>(static_cast<std::uint64_t>(e + 1023) << 52);
}

// The integer below x, which is smaller than 2^62.
std::int64_t floor_of(double x) {
  const auto whole = static_cast<std::int64_t>(x);
  return whole - static_cast<std::int64_t>(x < static_cast<double>(whole));
}

double farthest(const Box& box) {
  return std::max({std::abs(box.x0), std::abs(box.x1), std::abs(box.y0), std::abs(box.y1)});
}

// The exponents of the coordinates of all boxes but a few lie below the returned one by so much
// that a bound there leaves them as they are.
int common_exponent(const std::vector<Box>& boxes) {
  std::vector<int> exponents;
  for (const Box& box : boxes) {
    if (is_empty(box)) continue;
    const double far = farthest(box);
    exponents.push_back(far > 0 ? std::ilogb(std::min(far, kFarthest)) : -1000);
  }
  constexpr std::ptrdiff_t kShare = 16;  // one box in so many may lie farther out
  constexpr int kRoom = 4;
  const auto place = exponents.end() - 1 - std::ssize(exponents) / kShare;
  std::nth_element(exponents.begin(), place, exponents.end());
  return *place + kRoom;
}

// The box with no coordinate beyond a bound. Boxes that overlap still do so afterwards.
Box bounded(const Box& box, double bound) {
  Box result = box;
  for (double* x : {&result.x0, &result.y0, &result.x1, &result.y1}) {
    *x = std::clamp(*x, -bound, bound);
  }
  return result;
}

}  // namespace

// The level whose cells are just larger than the box.
int BoxGrid::level_of(const Box& box) const {
  const auto bits = std::bit_cast<std::uint64_t>(box.extent());
  return std::max(static_cast<int>(bits >> 52) - 1022, finest_);
}

void BoxGrid::locate(std::int32_t i, const Box& box) {
  Entry& entry = entries_[i];
  if (is_empty(box)) {
    entry.level = kEmpty;
    return;
  }
  entry.level = level_of(box);
  const double cells = power_of_two(-entry.level);
  entry.column = floor_of((box.x0 + box.x1) / 2 * cells);
  entry.row = floor_of((box.y0 + box.y1) / 2 * cells);
}

void BoxGrid::enter(std::int32_t i) {
  Entry& entry = entries_[i];
  const int level = entry.level;
  if (level == kEmpty) return;
  if (std::ranges::find(levels_, level) == levels_.end()) levels_.push_back(level);
  std::int32_t& head = heads_[slot(entry.column, entry.row, level, mask_)];
  entry.next = head;
  head = i;
}

void BoxGrid::leave(std::int32_t i) {
  const Entry& entry = entries_[i];
  if (entry.level == kEmpty) return;
  std::int32_t* link = &heads_[slot(entry.column, entry.row, entry.level, mask_)];
  while (*link != i) link = &entries_[*link].next;
  *link = entry.next;
}

template <class F>
void BoxGrid::each_near(const Box& box, int level, const Entry* from, F&& f) const {
  // A box of this level reaches at most half a cell beyond the cell that contains its centre.
  const double half = power_of_two(level - 1), cells = power_of_two(-level);
  std::int64_t column = floor_of((box.x0 - half) * cells);
  const std::int64_t column1 = floor_of((box.x1 + half) * cells);
  const std::int64_t row0 = floor_of((box.y0 - half) * cells);
  const std::int64_t row1 = floor_of((box.y1 + half) * cells);
  if (from) column = std::max(column, from->column);
  for (; column <= column1; ++column) {
    const bool first = from && column == from->column;
    for (std::int64_t row = first ? std::max(row0, from->row) : row0; row <= row1; ++row) {
      for (std::int32_t j = heads_[slot(column, row, level, mask_)]; j >= 0; j = entries_[j].next) {
        const Entry& other = entries_[j];
        if (other.level == level && other.column == column && other.row == row) f(j);
      }
    }
  }
}

void BoxGrid::find_pairs(const std::vector<Box>& boxes, std::vector<BoxPair>& pairs,
                         const Threads& threads) {
  levels_.clear();
  found_.begin(threads);
  const auto n = static_cast<std::int32_t>(boxes.size());
  const std::vector<Box>& bounded_boxes = find_reach(boxes);
  // No level is finer than 2^-50 of the largest coordinate, so that cell indices stay below 2^52.
  finest_ = std::max(reach_ > 0 ? std::ilogb(reach_) - kBits : 0, -1000);
  mask_ = std::bit_ceil(2 * boxes.size()) - 1;
  heads_.assign(mask_ + 1, -1);
  entries_.resize(boxes.size());
  is_changed_.assign(boxes.size(), 0);
  threads.chunks(n, kLocateTime, [&](int first, int end, int) {
    for (std::int32_t i = first; i < end; ++i) locate(i, bounded_boxes[i]);
  });
  for (std::int32_t i = 0; i < n; ++i) enter(i);
  threads.chunks(n, kLookTime, [&](int first, int end, int worker) {
    for (std::int32_t i = first; i < end; ++i) {
      find_partners(boxes, bounded_boxes[i], i, found_.of(worker));
    }
  });
  sort(pairs, threads);
}

// The boxes in the bounds of the grid. A few that lie far outside, or that have no end, would leave
// all others in one cell of it: they are cut off there, and come into its outermost cells.
const std::vector<Box>& BoxGrid::find_reach(const std::vector<Box>& boxes) {
  double smallest = HUGE_VAL;
  reach_ = 0;
  for (const Box& box : boxes) {
    if (is_empty(box)) continue;
    reach_ = std::max(reach_, farthest(box));
    smallest = std::min(smallest, box.extent());
  }
  if (reach_ <= kFarthest && reach_ * power_of_two(-kBits) <= smallest) return boxes;
  reach_ = std::min(reach_, std::ldexp(1., common_exponent(boxes)));
  bounded_.clear();
  for (const Box& box : boxes) bounded_.push_back(is_empty(box) ? box : bounded(box, reach_));
  return bounded_;
}

// Of a box with those of its own level that come behind it in the grid, and with larger ones.
// `in_grid`: the box in the bounds of the grid.
void BoxGrid::find_partners(const std::vector<Box>& boxes, const Box& in_grid, std::int32_t i,
                            std::vector<BoxPair>& found) const {
  const Box& box = boxes[i];
  const Entry& own = entries_[i];
  if (own.level == kEmpty) return;
  const auto report = [&](std::int32_t j) {
    if (!apart(box, boxes[j])) found.push_back({std::min(i, j), std::max(i, j)});
  };
  for (const int level : levels_) {
    if (level > own.level) each_near(in_grid, level, nullptr, report);
  }
  each_near(in_grid, own.level, &own, [&](std::int32_t j) {
    const Entry& other = entries_[j];
    // In one cell both find each other.
    if (other.column == own.column && other.row == own.row && j >= i) return;
    report(j);
  });
}

void BoxGrid::find_pairs_again(const std::vector<Box>& boxes, std::span<const std::int32_t> changed,
                               std::vector<BoxPair>& pairs, const Threads& threads) {
  // Large boxes would look into too many cells of the small ones.
  double cells = 0;
  bool few = boxes.size() == entries_.size() && kFew * changed.size() < boxes.size();
  for (size_t c = 0; few && c < changed.size(); ++c) {
    const Box& box = boxes[changed[c]];
    if (is_empty(box)) continue;
    for (const int level : levels_) {
      const double across = box.extent() * power_of_two(-level) + 3;
      cells += across * across;
    }
    few = farthest(box) <= reach_ && cells < 16. * static_cast<double>(boxes.size());
  }
  if (!few) {
    find_pairs(boxes, pairs, threads);
    return;
  }
  for (const std::int32_t i : changed) {
    is_changed_[i] = 1;
    leave(i);
    locate(i, boxes[i]);
    enter(i);
  }
  found_.begin(threads);
  const auto count = static_cast<int>(changed.size());
  threads.chunks(count, kLookTime, [&](int first, int end, int worker) {
    std::vector<BoxPair>& found = found_.of(worker);
    for (const std::int32_t i : changed.subspan(first, end - first)) {
      if (entries_[i].level == kEmpty) continue;
      const Box& box = boxes[i];
      for (const int level : levels_) {
        each_near(box, level, nullptr, [&](std::int32_t j) {
          if (j == i || (is_changed_[j] && j > i)) return;  // box j reports this pair
          if (!apart(box, boxes[j])) found.push_back({std::min(i, j), std::max(i, j)});
        });
      }
    }
  });
  sort(added_, threads);
  merge(pairs, added_, threads);
  for (const std::int32_t i : changed) is_changed_[i] = 0;
}

// Each thread takes the pairs of a range of first boxes from what all have found, and counts those
// of each box: this takes linear time, because few pairs share a box.
void BoxGrid::sort(std::vector<BoxPair>& pairs, const Threads& threads) {
  pairs.resize(found_.size());
  ends_.assign(entries_.size(), 0);
  threads.chunks(static_cast<int>(entries_.size()), kSortTime, [&](int first, int end, int) {
    std::int32_t place = 0;
    for (const std::vector<BoxPair>& some : found_.all()) {
      for (const BoxPair& pair : some) {
        if (pair.first < first) ++place;
        if (pair.first >= first && pair.first < end) ++ends_[pair.first];
      }
    }
    auto begin = pairs.begin() + place;
    for (int i = first; i < end; ++i) place += std::exchange(ends_[i], place);
    for (const std::vector<BoxPair>& some : found_.all()) {
      for (const BoxPair& pair : some) {
        if (pair.first >= first && pair.first < end) pairs[ends_[pair.first]++] = pair;
      }
    }
    for (int i = first; i < end; ++i) {
      const auto behind = pairs.begin() + ends_[i];
      std::sort(begin, behind);
      begin = behind;
    }
  });
}

// Each thread takes the pairs of a range of first boxes, when it is known how many there are
// before.
void BoxGrid::merge(std::vector<BoxPair>& pairs, const std::vector<BoxPair>& added,
                    const Threads& threads) {
  const auto range = [](const std::vector<BoxPair>& of, int first, int end) {
    const auto place = [&](int box) {
      return std::ranges::lower_bound(of, box, {}, &BoxPair::first);
    };
    return std::span(place(first), place(end));
  };
  const auto stays = [&](const BoxPair& pair) {
    return !is_changed_[pair.first] && !is_changed_[pair.second];
  };
  const auto boxes = static_cast<int>(entries_.size());
  sizes_.assign(static_cast<size_t>(threads.count()), 0);
  threads.chunks(boxes, kMergeTime, [&](int first, int end, int worker) {
    const auto kept = std::ranges::count_if(range(pairs, first, end), stays);
    sizes_[static_cast<size_t>(worker)] = kept + std::ssize(range(added, first, end));
  });
  merged_.resize(
      static_cast<size_t>(std::accumulate(sizes_.begin(), sizes_.end(), std::ptrdiff_t{0})));
  threads.chunks(boxes, kMergeTime, [&](int first, int end, int worker) {
    auto to = std::accumulate(sizes_.begin(), sizes_.begin() + worker, merged_.begin());
    const auto from = range(added, first, end);
    auto next = from.begin();
    for (const BoxPair& pair : range(pairs, first, end)) {
      if (!stays(pair)) continue;
      for (; next != from.end() && *next < pair; ++next) *to++ = *next;
      *to++ = pair;
    }
    std::copy(next, from.end(), to);
  });
  pairs.swap(merged_);
}

}  // namespace apothem
