#include "apothem/geometry/packing/arrange.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "apothem/geometry/packing/block_shapes.hpp"

namespace apothem {
namespace {

constexpr int kTries = 20000;

std::vector<Vec2> ring_of(const Block& block, const Vec2& place, double scale = 1) {
  return placed(block.shape, place, block.angle, scale * block.scale);
}

// The largest first, those of equal size in their order.
std::vector<size_t> by_size(const std::vector<Block>& blocks) {
  std::vector<size_t> order(blocks.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](size_t i, size_t j) { return blocks[i].scale > blocks[j].scale; });
  return order;
}

Vec2 random_place(const Box& box, RandomNumbers& random) {
  const double x = random.uniform(box.x0, box.x1);
  return {x, random.uniform(box.y0, box.y1)};
}

}  // namespace

Arrangement insert_at_random(PackingSpace& space, RandomNumbers& random,
                             const std::vector<Block>& blocks) {
  Arrangement result;
  result.rings.resize(blocks.size());
  for (const size_t i : by_size(blocks)) {
    int tries = 0;
    do {
      result.rings[i] = ring_of(blocks[i], random_place(space.box(), random));
      ++tries;
    } while (!space.is_free(result.rings[i]) && tries < kTries);
    if (tries == kTries) {
      result.rings[i].clear();
      return result;
    }
    space.add(result.rings[i]);
    ++result.placed;
  }
  return result;
}

Arrangement put_on_lattice(PackingSpace& space, const std::vector<Block>& blocks) {
  Arrangement result;
  result.rings.resize(blocks.size());
  std::vector<Box> boxes;
  double width = 0, height = 0;
  for (const Block& block : blocks) {
    Box box;
    for (const Vec2& v : ring_of(block, Vec2::Zero())) box.include(v.x(), v.y());
    boxes.push_back(box);
    width = std::max(width, box.x1 - box.x0);
    height = std::max(height, box.y1 - box.y0);
  }
  // Twice the clearance, so that rounding cannot make neighbours too near.
  width += 2 * space.clearance();
  height += 2 * space.clearance();
  const Box& region = space.box();
  for (double y = region.y0 + height / 2; y + height / 2 <= region.y1 + height; y += height) {
    for (double x = region.x0 + width / 2; x + width / 2 <= region.x1 + width; x += width) {
      const auto next = static_cast<size_t>(result.placed);
      if (next == blocks.size()) return result;
      const Box& box = boxes[next];
      const Vec2 centre((box.x0 + box.x1) / 2, (box.y0 + box.y1) / 2);
      std::vector<Vec2> ring = ring_of(blocks[next], Vec2(x, y) - centre);
      if (!space.is_free(ring)) continue;
      space.add(ring);
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
constexpr int kSweepsOfALook = 500;    // sweeps between looks at the growth
constexpr double kSlowest = 1e-3;      // growth of the missing area between two looks, at the end

// Blocks that grow and move at random, each as much as there is room.
class Growth {
 public:
  Growth(PackingSpace& space, RandomNumbers& random, std::vector<Block> blocks, bool turns)
      : space_(space), random_(random), blocks_(std::move(blocks)), turns_(turns) {
    for (const Block& b : blocks_) solid_ += b.scale * b.scale;
    const double start = std::min(1., std::sqrt(kLooseFraction * space.area() / solid_));
    parts_.assign(blocks_.size(), start);
    rates_.assign(blocks_.size(), kGrowth);
  }

  Arrangement run() {
    Arrangement result;
    for (int attempt = 1; attempt <= kAttempts; ++attempt) {
      space_.clear();
      std::vector<Block> small = blocks_;
      for (size_t i = 0; i < small.size(); ++i) small[i].scale *= parts_[i];
      result = insert_at_random(space_, random_, small);
      number_blocks(small);
      if (result.placed == static_cast<int>(blocks_.size())) break;
      if (attempt == kAttempts) return result;
      // Few large blocks may not fit into a winding region yet.
      for (double& part : parts_) part *= kSmaller;
    }
    for (size_t i = 0; i < blocks_.size(); ++i) places_.push_back(centroid(result.rings[i]));
    double missing = missing_area();
    for (int sweep = 1; missing > 0; ++sweep) {
      move_all();
      grow_all();
      if (sweep % kSweepsOfALook != 0) continue;
      const double now = missing_area();
      if (now > missing * (1 - kSlowest)) break;
      missing = now;
    }
    result.scale = std::sqrt(1 - missing_area() / solid_);
    for (size_t i = 0; i < blocks_.size(); ++i) result.rings[i] = space_.block(numbers_[i]);
    return result;
  }

 private:
  static Vec2 centroid(const std::vector<Vec2>& ring) {
    return ring.front() + area_moments(Polygon(ring)).centroid;
  }

  // The space numbers blocks as they were inserted.
  void number_blocks(const std::vector<Block>& inserted) {
    numbers_.resize(inserted.size());
    int next = 0;
    for (const size_t i : by_size(inserted)) numbers_[i] = next++;
  }

  [[nodiscard]] double missing_area() const {
    double sum = 0;
    for (size_t i = 0; i < blocks_.size(); ++i) {
      sum += blocks_[i].scale * blocks_[i].scale * (1 - parts_[i] * parts_[i]);
    }
    return sum;
  }

  void move_all() {
    int accepted = 0;
    for (size_t i = 0; i < blocks_.size(); ++i) {
      const double reach = move_ * parts_[i] * blocks_[i].scale;
      const double x = random_.uniform(-reach, reach);
      const Vec2 place = places_[i] + Vec2(x, random_.uniform(-reach, reach));
      Block turned = blocks_[i];
      if (turns_) turned.angle += random_.uniform(-move_, move_);
      std::vector<Vec2> ring = ring_of(turned, place, parts_[i]);
      if (!space_.is_free(ring, numbers_[i])) continue;
      space_.move(numbers_[i], std::move(ring));
      places_[i] = place;
      blocks_[i].angle = turned.angle;
      ++accepted;
    }
    const double share = static_cast<double>(accepted) / static_cast<double>(blocks_.size());
    move_ = std::clamp(move_ * (share > kAccepted ? 1.05 : .95), 1e-4, .5);
  }

  void grow_all() {
    for (size_t i = 0; i < blocks_.size(); ++i) {
      if (parts_[i] == 1) continue;
      const double goal = std::min(1., parts_[i] * (1 + rates_[i]));
      std::vector<Vec2> ring = ring_of(blocks_[i], places_[i], goal);
      if (!space_.is_free(ring, numbers_[i])) {
        rates_[i] = std::max(rates_[i] / 2, 1e-6);
        continue;
      }
      space_.move(numbers_[i], std::move(ring));
      parts_[i] = goal;
      rates_[i] = std::min(rates_[i] * 1.5, kGrowth);
    }
  }

  PackingSpace& space_;
  RandomNumbers& random_;
  std::vector<Block> blocks_;
  bool turns_;
  double solid_ = 0;           // area of all blocks at full size, m^2
  std::vector<double> parts_;  // of its full size that each block has
  std::vector<double> rates_;  // at which it tries to grow
  std::vector<int> numbers_;   // in the space
  std::vector<Vec2> places_;   // of the centroids
  double move_ = kFirstMove;
};

}  // namespace

Arrangement grow(PackingSpace& space, RandomNumbers& random, const std::vector<Block>& blocks,
                 bool turns) {
  return Growth(space, random, blocks, turns).run();
}

}  // namespace apothem
