#include "lib/mesh/half_disc_mesh.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "lib/execution/elementary.hpp"
#include "lib/mesh/groups.hpp"
#include "lib/mesh/split.hpp"

namespace apothem {
namespace {

// The point of the unit circle about (0, 1) at `angle` from the pole (0, 0), in rad.
Vec2 on_arc(double angle) {
  const double half = sine_cosine(angle / 2).sine;
  return {sine_cosine(angle).sine, 2 * half * half};
}

// 2 i/n - 1, from -1 to 1: the same on both sides of 0 to the last bit.
double share(int i, int n) { return static_cast<double>(2 * i - n) / n; }

}  // namespace

Mesh half_disc_mesh(const Vec2& pole, double radius, const HalfDiscCells& cells,
                    ElementShape shape) {
  if (!(radius > 0) || !std::isfinite(radius) || !is_finite(pole)) {
    throw std::invalid_argument("the radius of a disc must be positive and finite");
  }
  const auto [fine, n, growth] = cells;
  if (!(fine >= .001 && fine <= .5)) {
    throw std::invalid_argument("the fine block must reach over 0.001 to 0.5 of the radius");
  }
  if (n < 1 || n > 1000) throw std::invalid_argument("there must be 1 to 1000 cells");
  if (!(growth >= 1.01 && growth <= 2)) {
    throw std::invalid_argument("the growth must be between 1.01 and 2");
  }
  const double side = arc_sine(fine);
  const int around = 4 * n;
  Mesh mesh;
  const auto block = [n = n](int i, int j) { return j * (2 * n + 1) + i; };
  for (int j = 0; j <= n; ++j) {
    for (int i = 0; i <= 2 * n; ++i) {
      const Vec2 foot = on_arc(side * share(i, 2 * n));
      const double top = fine + on_arc(side).y();
      mesh.nodes.emplace_back(foot.x(), foot.y() + static_cast<double>(j) / n * (top - foot.y()));
    }
  }
  const auto add = [&](int a, int b, int c, int d, bool turned) {
    add_quadrilateral(mesh, {a, b, c, d}, shape, turned);
  };
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < 2 * n; ++i) {
      add(block(i, j), block(i + 1, j), block(i + 1, j + 1), block(i, j + 1), (i + j) % 2 != 0);
    }
  }
  // The outline of the block from its lower left corner over its top to its lower right corner.
  std::vector<int> last;
  last.reserve(4 * static_cast<size_t>(n) + 1);
  for (int k = 0; k < n; ++k) last.push_back(block(0, k));
  for (int k = 0; k < 2 * n; ++k) last.push_back(block(k, n));
  for (int k = n; k >= 0; --k) last.push_back(block(2 * n, k));
  const std::vector<Vec2> rim = mesh.places(last);

  // The first layer is at most as thick as a cell of the block; the number of layers is rounded up.
  const double length = std::numbers::pi / 2 - side;
  const double first = fine / n / length;
  const int layers = static_cast<int>(
      std::ceil(natural_logarithm(1 + (growth - 1) / first) / natural_logarithm(growth)));
  const double whole = power(growth, layers) - 1;
  std::vector<std::array<int, 2>> arc, straight;
  std::vector<int> left{last.front()}, right{last.back()};
  for (int l = 1; l <= layers; ++l) {
    const double s = l < layers ? (power(growth, l) - 1) / whole : 1;
    const Vec2 end = l < layers ? on_arc(side + s * length) : Vec2(1, 1);
    std::vector<int> next;
    for (int k = 0; k <= around; ++k) {
      // Linear between the outline of the block and the straight side, plus a correction that puts
      // the ends of the layer on the arc.
      const Vec2 even = rim[k] + s * (Vec2(share(k, around), 1) - rim[k]);
      const Vec2 bulge = end - (rim[around] + s * (Vec2(1, 1) - rim[around]));
      next.push_back(static_cast<int>(mesh.nodes.size()));
      mesh.nodes.emplace_back(even + Vec2(share(k, around) * bulge.x(), bulge.y()));
    }
    for (int k = 0; k < around; ++k) {
      add(last[k], last[k + 1], next[k + 1], next[k], (l + k) % 2 != 0);
    }
    last = std::move(next);
    left.push_back(last.front());
    right.push_back(last.back());
  }
  for (size_t l = left.size() - 1; l > 0; --l) arc.push_back({left[l], left[l - 1]});
  for (int i = 0; i < 2 * n; ++i) arc.push_back({block(i, 0), block(i + 1, 0)});
  for (size_t l = 1; l < right.size(); ++l) arc.push_back({right[l - 1], right[l]});
  for (int k = around; k > 0; --k) straight.push_back({last[k], last[k - 1]});
  mesh.groups = {line_group("arc", std::move(arc)), line_group("straight", std::move(straight))};
  for (Vec2& p : mesh.nodes) p = pole + radius * p;
  return mesh;
}

}  // namespace apothem
