#include "geometry/packing/arrange.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "geometry/packing/block_shapes.hpp"

namespace apothem {
namespace {

constexpr int kTries = 20000;

std::vector<Vec2> ring_of(const Block& block, const Vec2& place) {
  return placed(block.shape, place, block.angle, block.scale);
}

// The largest first, those of equal size in their order.
std::vector<size_t> by_size(const std::vector<Block>& blocks) {
  std::vector<size_t> order(blocks.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order,
                           [&](size_t i, size_t j) { return blocks[i].scale > blocks[j].scale; });
  return order;
}

Vec2 random_place(const Box& box, RandomNumbers& random) {
  const double x = random.uniform(box.x0, box.x1);
  return {x, random.uniform(box.y0, box.y1)};
}

}  // namespace

Rings holes_of(const Block& block, const BlockPose& pose) {
  Rings holes;
  for (const std::vector<Vec2>& hole : block.holes) {
    holes.push_back(placed(hole, pose.place, pose.angle, pose.scale));
  }
  return holes;
}

Arrangement insert_at_random(PackingSpace& space, RandomNumbers& random,
                             const std::vector<Block>& blocks) {
  Arrangement result;
  result.rings.resize(blocks.size());
  result.poses.resize(blocks.size());
  for (const size_t i : by_size(blocks)) {
    int tries = 0;
    do {
      const Vec2 place = random_place(space.box(), random);
      result.poses[i] = {place, blocks[i].angle, blocks[i].scale};
      result.rings[i] = ring_of(blocks[i], place);
      ++tries;
    } while (!space.is_free(result.rings[i]) && tries < kTries);
    if (tries == kTries) {
      result.rings[i].clear();
      return result;
    }
    space.add(result.rings[i], holes_of(blocks[i], result.poses[i]));
    ++result.placed;
  }
  return result;
}

Arrangement put_on_lattice(PackingSpace& space, const std::vector<Block>& blocks) {
  Arrangement result;
  result.rings.resize(blocks.size());
  result.poses.resize(blocks.size());
  std::vector<Box> boxes;
  double width = 0, height = 0;
  for (const Block& block : blocks) {
    const Box box = box_of(ring_of(block, Vec2::Zero()));
    boxes.push_back(box);
    width = std::max(width, box.x1 - box.x0);
    height = std::max(height, box.y1 - box.y0);
  }
  // Rounding must make no neighbours too near, nor the first row and column too near to the border.
  // So neighbours have nearly twice the clearance between them, and those at the border a bit more
  // than the clearance. Blocks that fit with equal distances still do.
  const double more = std::min(space.clearance() / 8, 1e-10 * std::max(width, height));
  width += 2 * (space.clearance() - more);
  height += 2 * (space.clearance() - more);
  const Box& region = space.box();
  const double x0 = region.x0 + width / 2 + 2 * more, y0 = region.y0 + height / 2 + 2 * more;
  for (double y = y0; y + height / 2 <= region.y1 + height; y += height) {
    for (double x = x0; x + width / 2 <= region.x1 + width; x += width) {
      const auto next = static_cast<size_t>(result.placed);
      if (next == blocks.size()) return result;
      const Box& box = boxes[next];
      const Vec2 centre((box.x0 + box.x1) / 2, (box.y0 + box.y1) / 2);
      const Vec2 place = Vec2(x, y) - centre;
      std::vector<Vec2> ring = ring_of(blocks[next], place);
      if (!space.is_free(ring)) continue;
      space.add(ring);
      result.poses[next] = {place, blocks[next].angle, blocks[next].scale};
      result.rings[next] = std::move(ring);
      ++result.placed;
    }
  }
  return result;
}

namespace {

constexpr double kLooseFraction = .3;  // solid fraction at which blocks are inserted
constexpr int kAttempts = 10;          // at inserting them, each with smaller blocks
constexpr double kSmaller = .8;        // size of blocks in the next attempt
constexpr double kFirstMove = .2;      // of a block's size
constexpr double kAccepted = .4;       // share of moves that should succeed
constexpr double kGrowth = .05;        // largest growth of a block in a sweep
constexpr int kSweepsOfALook = 500;    // between looks at the growth, at least
constexpr int kMovesOfALook = 60000;   // the same, moves
constexpr double kSlowest = 1e-3;      // growth of the missing area between two looks, at the end
constexpr int kSweepsOfAChoice = 10;   // sweeps between choices of the blocks that move
constexpr double kFew = .02;           // share of blocks still to grow from which on not all move
constexpr double kAround = 10;         // of a block's size: how near to one of them a block moves
constexpr double kRow = 8;             // of a block's size: height of the rows of the numbering

// Blocks that grow and move at random, each as much as there is room.
class Growth {
 public:
  Growth(PackingSpace& space, RandomNumbers& random, std::vector<Block> blocks, bool turns)
      : space_(space),
        random_(random),
        blocks_(std::move(blocks)),
        turns_(turns),
        count_(static_cast<int>(blocks_.size())) {
    for (const Block& b : blocks_) {
      solid_ += b.scale * b.scale;
      size_ = std::max(size_, b.scale);
    }
    const double start = std::min(1., std::sqrt(kLooseFraction * space.area() / solid_));
    parts_.assign(blocks_.size(), start);
    rates_.assign(blocks_.size(), kGrowth);
  }

  Arrangement run() {
    Arrangement result;
    for (int attempt = 1; attempt <= kAttempts; ++attempt) {
      space_.clear();
      std::vector<Block> small = blocks_;
      for (size_t i = 0; i < small.size(); ++i) {
        small[i].scale *= parts_[i];
        small[i].holes.clear();  // a block in a hole could not move as freely as the others
      }
      result = insert_at_random(space_, random_, small);
      if (result.placed == count_) break;
      if (attempt == kAttempts) return result;
      // Few large blocks may not fit into a winding region yet.
      for (double& part : parts_) part *= kSmaller;
    }
    const std::vector<int> order = put_in_order(result.rings);
    double missing = missing_area();
    double missing_at_look = missing;
    const int look = std::max(kSweepsOfALook, kMovesOfALook / count_);
    for (int sweep = 0; missing > 0; ++sweep) {
      if (sweep > 0 && sweep % look == 0) {
        if (missing > missing_at_look * (1 - kSlowest)) break;
        missing_at_look = missing;
      }
      if (sweep % kSweepsOfAChoice == 0) choose_movable();
      move_all();
      grow_all();
      missing = missing_area();
    }
    result.scale = std::sqrt(1 - missing / solid_);
    for (int i = 0; i < count_; ++i) {
      const std::span<const Vec2> ring = space_.block(i);
      result.rings[order[i]].assign(ring.begin(), ring.end());
      result.poses[order[i]] = {places_[i], blocks_[i].angle, blocks_[i].scale * parts_[i]};
    }
    return result;
  }

 private:
  // Numbers the blocks so that neighbours in space are near each other in memory, and returns the
  // number that each has had before.
  std::vector<int> put_in_order(const std::vector<std::vector<Vec2>>& rings) {
    for (const std::vector<Vec2>& ring : rings) {
      places_.emplace_back(ring.front() + area_moments(Polygon(ring)).centroid);
    }
    std::vector<int> order(blocks_.size());
    std::iota(order.begin(), order.end(), 0);
    std::ranges::sort(order, [&](int i, int j) {
      const auto row = [&](int k) { return std::floor(places_[k].y() / (kRow * size_)); };
      return std::tuple(row(i), places_[i].x(), i) < std::tuple(row(j), places_[j].x(), j);
    });
    const auto reorder = [&](auto& list) {
      auto old = std::move(list);
      list.clear();
      for (const int i : order) list.push_back(std::move(old[i]));
    };
    reorder(blocks_);
    reorder(parts_);
    reorder(places_);
    space_.clear();
    for (const int i : order) space_.add(rings[i]);
    return order;
  }

  [[nodiscard]] double missing_area() const {
    double sum = 0;
    for (size_t i = 0; i < blocks_.size(); ++i) {
      sum += blocks_[i].scale * blocks_[i].scale * (1 - parts_[i] * parts_[i]);
    }
    return sum;
  }

  // Once few blocks are still to grow, only blocks around them need to make room.
  void choose_movable() {
    std::vector<int> small;
    for (int i = 0; i < count_; ++i) {
      if (parts_[i] < 1) small.push_back(i);
    }
    const bool few = static_cast<int>(small.size()) < kFew * count_;
    movable_.clear();
    for (int i = 0; i < count_; ++i) {
      const auto near = [&](int k) { return (places_[i] - places_[k]).norm() < kAround * size_; };
      if (!few || std::ranges::any_of(small, near)) movable_.push_back(i);
    }
  }

  void move_all() {
    int accepted = 0;
    for (const int i : movable_) {
      const double reach = move_ * parts_[i] * blocks_[i].scale;
      const double x = random_.uniform(-reach, reach);
      const Vec2 place = places_[i] + Vec2(x, random_.uniform(-reach, reach));
      const double angle = blocks_[i].angle + (turns_ ? random_.uniform(-move_, move_) : 0);
      place_into(blocks_[i].shape, place, angle, blocks_[i].scale * parts_[i], ring_);
      if (!space_.is_free(ring_, i)) continue;
      space_.move(i, ring_);
      places_[i] = place;
      blocks_[i].angle = angle;
      ++accepted;
    }
    const double share = static_cast<double>(accepted) / static_cast<double>(movable_.size());
    move_ = std::clamp(move_ * (share > kAccepted ? 1.05 : .95), 1e-4, .5);
  }

  void grow_all() {
    for (int i = 0; i < count_; ++i) {
      if (parts_[i] == 1) continue;
      const double goal = std::min(1., parts_[i] * (1 + rates_[i]));
      place_into(blocks_[i].shape, places_[i], blocks_[i].angle, blocks_[i].scale * goal, ring_);
      if (!space_.is_free(ring_, i)) {
        rates_[i] = std::max(rates_[i] / 2, 1e-6);
        continue;
      }
      space_.move(i, ring_);
      parts_[i] = goal;
      rates_[i] = std::min(rates_[i] * 1.5, kGrowth);
    }
  }

  PackingSpace& space_;
  RandomNumbers& random_;
  std::vector<Block> blocks_;
  bool turns_;
  int count_;
  double solid_ = 0;           // area of all blocks at full size, m^2
  double size_ = 0;            // of the largest, m
  std::vector<double> parts_;  // of its full size that each block has
  std::vector<double> rates_;  // at which it tries to grow
  std::vector<Vec2> places_;   // of the centroids
  std::vector<int> movable_;   // blocks that move
  std::vector<Vec2> ring_;     // of the block that is being tried
  double move_ = kFirstMove;
};

}  // namespace

Arrangement grow(PackingSpace& space, RandomNumbers& random, const std::vector<Block>& blocks,
                 bool turns) {
  return Growth(space, random, blocks, turns).run();
}

}  // namespace apothem
