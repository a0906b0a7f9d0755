// A half disc whose mesh is fine where it touches.
#pragma once

#include <array>
#include <cmath>

#include "mesh/mesh.hpp"

namespace apothem::test {

struct HalfDisc {
  double fine;    ///< half-width of the block of equal cells at the pole, of the radius
  int cells;      ///< of that half-width
  double growth;  ///< of the cells' sizes from layer to layer around it
};

/// Radius 1, pole at (0, 0), straight side at y = 1. Quadrilaterals: a block of 2 n x n cells, and
/// layers around it up to the straight side.
inline Mesh half_disc(const HalfDisc& h) {
  const int n = h.cells, around = 4 * n;
  const double side = std::asin(h.fine);
  const auto on_arc = [](double angle) { return Vec2(std::sin(angle), 1 - std::cos(angle)); };
  Mesh mesh;
  std::vector<std::vector<int>> block(2 * n + 1, std::vector<int>(n + 1));
  for (int i = 0; i <= 2 * n; ++i) {
    const Vec2 foot = on_arc(side * (i - n) / n);
    const Vec2 top(foot.x(), h.fine + 1 - std::cos(side));
    for (int j = 0; j <= n; ++j) {
      block[i][j] = static_cast<int>(mesh.nodes.size());
      mesh.nodes.emplace_back(foot + static_cast<double>(j) / n * (top - foot));
    }
  }
  const auto add = [&](int a, int b, int c, int d) { mesh.add_element(std::array{a, b, c, d}); };
  for (int i = 0; i < 2 * n; ++i) {
    for (int j = 0; j < n; ++j) {
      add(block[i][j], block[i + 1][j], block[i + 1][j + 1], block[i][j + 1]);
    }
  }
  // Around the block from its left foot to its right one.
  const auto rim = [&](int k) {
    return k <= n ? block[0][k] : k <= 3 * n ? block[k - n][n] : block[2 * n][around - k];
  };
  // Layers start with the size of the block's cells.
  const double length = std::acos(-1.) / 2 - side;
  const double first = h.fine / n / length;
  const int layers =
      static_cast<int>(std::ceil(std::log(1 + (h.growth - 1) / first) / std::log(h.growth)));
  const double whole = std::pow(h.growth, layers) - 1;
  std::vector<int> last(around + 1);
  for (int k = 0; k <= around; ++k) last[k] = rim(k);
  const Vec2 left = mesh.nodes[rim(0)], right = mesh.nodes[rim(around)];
  std::vector<Vec2> inner;
  for (int k = 0; k <= around; ++k) inner.push_back(mesh.nodes[rim(k)]);
  for (int l = 1; l <= layers; ++l) {
    const double s = (std::pow(h.growth, l) - 1) / whole;
    const double angle = side + s * length;
    std::vector<int> next(around + 1);
    for (int k = 0; k <= around; ++k) {
      const double share = static_cast<double>(k) / around;
      const auto outer = [&](double x) { return Vec2(2 * x - 1, 1); };
      const Vec2 straight = inner[k] + s * (outer(share) - inner[k]);
      const Vec2 bulge_left = on_arc(-angle) - (left + s * (outer(0) - left));
      const Vec2 bulge_right = on_arc(angle) - (right + s * (outer(1) - right));
      next[k] = static_cast<int>(mesh.nodes.size());
      mesh.nodes.emplace_back(straight + (1 - share) * bulge_left + share * bulge_right);
    }
    for (int k = 0; k < around; ++k) add(last[k], last[k + 1], next[k + 1], next[k]);
    last = std::move(next);
  }
  return mesh;
}

}  // namespace apothem::test
