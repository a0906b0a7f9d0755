#include "geometry/spatial/hilbert.hpp"

#include <cstdint>

namespace apothem {
namespace {

constexpr int kLevels = 31;

// Position along the curve of the square in column x and row y of a grid of 2^kLevels x 2^kLevels
// squares.
std::uint64_t place(std::uint32_t x, std::uint32_t y) {
  std::uint64_t d = 0;
  for (std::uint32_t s = 1U << (kLevels - 1); s > 0; s /= 2) {
    const bool right = (x & s) != 0;
    const bool upper = (y & s) != 0;
    d = 4 * d + (right ? (upper ? 2 : 3) : (upper ? 1 : 0));
    if (upper) continue;
    // In the two lower quarters the curve is mirrored about a diagonal.
    if (right) {
      x = s - 1 - (x & (s - 1));
      y = s - 1 - (y & (s - 1));
    }
    std::swap(x, y);
  }
  return d;
}

}  // namespace

std::vector<int> hilbert_order(const std::vector<Vec2>& points) {
  const Box box = box_of(points);
  const double extent = box.extent();
  const double squares = std::ldexp(1., kLevels);
  const auto square = [&](double distance) {
    return static_cast<std::uint32_t>(std::min(distance / extent * squares, squares - 1));
  };
  std::vector<std::pair<std::uint64_t, int>> keys;
  keys.reserve(points.size());
  for (const Vec2& p : points) {
    const int number = static_cast<int>(keys.size());
    keys.emplace_back(extent > 0 ? place(square(p.x() - box.x0), square(p.y() - box.y0)) : 0,
                      number);
  }
  std::ranges::sort(keys);
  std::vector<int> order;
  order.reserve(keys.size());
  for (const auto& [key, number] : keys) order.push_back(number);
  return order;
}

}  // namespace apothem
