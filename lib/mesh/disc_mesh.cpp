#include "lib/mesh/disc_mesh.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "lib/execution/elementary.hpp"
#include "lib/mesh/groups.hpp"
#include "lib/mesh/split.hpp"

namespace apothem {
namespace {

// Found by a search over meshes of 1 to 64 cells for the best worst corner, then the smallest ratio
// of areas: distance of the block's corners from the centre over the radius, share of the circle in
// the shape of its sides, and layers of the ring per cell of a quarter.
constexpr double kBlock = .65;
constexpr double kBulge = .38;
constexpr double kLayers = .45;

// The point of the unit circle at an angle in rad.
Vec2 on_circle(double angle) {
  const auto [sine, cosine] = sine_cosine(angle);
  return {cosine, sine};
}

// Maps the square [-1, 1]^2 to the block in the unit disc: a blend of a straight square and,
// towards the sides, an arc.
Vec2 block_point(double u, double v) {
  const double m = std::max(std::abs(u), std::abs(v));
  if (m == 0) return Vec2::Zero();
  Vec2 arc = Vec2(u, v) / std::numbers::sqrt2;
  if (std::abs(v) < std::abs(u)) {
    arc = u * on_circle(std::numbers::pi / 4 * (v / u));
  } else if (std::abs(u) < std::abs(v)) {
    const Vec2 turned = on_circle(std::numbers::pi / 4 * (u / v));
    arc = v * Vec2(turned.y(), turned.x());
  }
  const double bulge = kBulge * m * m;
  return kBlock * ((1 - bulge) / std::numbers::sqrt2 * Vec2(u, v) + bulge * arc);
}

// The ends of the ring's layers, from 0 to 1. The layers' sizes form a geometric series.
std::vector<double> layer_ends(int layers, double grading) {
  std::vector<double> end{0};
  double size = 1;
  const double ratio = layers > 1 ? power(grading, -1. / (layers - 1)) : 1;
  for (int k = 0; k < layers; ++k, size *= ratio) end.push_back(end.back() + size);
  for (double& e : end) e /= end.back();
  return end;
}

Vec2 quarter_turn(const Vec2& p, int times) {
  Vec2 q = p;
  for (int i = 0; i < times; ++i) q = {-q.y(), q.x()};
  return q;
}

}  // namespace

Mesh disc_mesh(const Vec2& centre, double radius, const DiscCells& cells, ElementShape shape) {
  const int n = cells.quarter;
  if (!(radius > 0) || !std::isfinite(radius) || !is_finite(centre)) {
    throw std::invalid_argument("the radius of a disc must be positive and finite");
  }
  if (n < 1 || n > 5000) throw std::invalid_argument("there must be 1 to 5000 cells in a quarter");
  if (!(cells.grading >= .01 && cells.grading <= 100)) {
    throw std::invalid_argument("the grading must be between 0.01 and 100");
  }
  const auto share = [n](int i) { return static_cast<double>(2 * i - n) / n; };
  Mesh mesh;
  for (int j = 0; j <= n; ++j) {
    for (int i = 0; i <= n; ++i) mesh.nodes.push_back(block_point(share(i), share(j)));
  }
  const auto block = [n](int i, int j) { return j * (n + 1) + i; };
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      add_quadrilateral(mesh, {block(i, j), block(i + 1, j), block(i + 1, j + 1), block(i, j + 1)},
                        shape, (i + j) % 2 != 0);
    }
  }
  // Nodes on the outline of the block, counter-clockwise from its corner at -45 degrees: side s,
  // step i.
  const auto rim = [&](int s, int i) {
    const int k[4][2]{{n, i}, {n - i, n}, {0, n - i}, {i, 0}};
    return block(k[s][0], k[s][1]);
  };
  const int layers = std::max(1, static_cast<int>(std::lround(kLayers * n)));
  const std::vector<double> end = layer_ends(layers, cells.grading);
  const int ring_start = static_cast<int>(mesh.nodes.size());
  for (int l = 1; l <= layers; ++l) {
    for (int s = 0; s < 4; ++s) {
      for (int i = 0; i < n; ++i) {
        const Vec2 circle = on_circle(std::numbers::pi / 4 * share(i));
        const Vec2 p = block_point(1, share(i));
        mesh.nodes.push_back(quarter_turn(l == layers ? circle : p + end[l] * (circle - p), s));
      }
    }
  }
  const auto ring = [&](int l, int k) {  // k runs around the ring, cyclically
    k %= 4 * n;
    return l == 0 ? rim(k / n, k % n) : ring_start + (l - 1) * 4 * n + k;
  };
  for (int l = 0; l < layers; ++l) {
    for (int k = 0; k < 4 * n; ++k) {
      add_quadrilateral(mesh, {ring(l, k), ring(l + 1, k), ring(l + 1, k + 1), ring(l, k + 1)},
                        shape, (l + k) % 2 != 0);
    }
  }
  for (Vec2& p : mesh.nodes) p = centre + radius * p;
  std::vector<std::array<int, 2>> boundary;
  boundary.reserve(4 * static_cast<size_t>(n));
  for (int k = 0; k < 4 * n; ++k) boundary.push_back({ring(layers, k), ring(layers, k + 1)});
  mesh.groups = {line_group("boundary", std::move(boundary))};
  return mesh;
}

}  // namespace apothem
