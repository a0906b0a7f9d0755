#include "lib/mesh/rectangle_mesh.hpp"

#include <stdexcept>

#include "lib/mesh/groups.hpp"
#include "lib/mesh/split.hpp"

namespace apothem {
namespace {

// The coordinates of n + 1 equidistant nodes. Throws std::invalid_argument if the origin is so far
// away that round-off distorts the cells.
std::vector<double> places(double start, double length, int n) {
  std::vector<double> x;
  for (int i = 0; i <= n; ++i) x.push_back(start + length * (static_cast<double>(i) / n));
  const double cell = length / n;
  for (int i = 0; i < n; ++i) {
    if (!(std::abs(x[i + 1] - x[i] - cell) < 1e-6 * cell)) {
      throw std::invalid_argument(
          "the cells are too small for double precision so far from the origin");
    }
  }
  return x;
}

}  // namespace

Mesh rectangle_mesh(const Vec2& size, const std::array<int, 2>& cells, const Vec2& origin,
                    ElementShape shape) {
  constexpr double kMost = 1e8;
  if (!(size.minCoeff() > 0) || !is_finite(size) || !is_finite(origin)) {
    throw std::invalid_argument("the sides of a rectangle must be positive and finite");
  }
  const auto [nx, ny] = cells;
  if (nx < 1 || ny < 1 || static_cast<double>(nx) * ny > kMost) {
    throw std::invalid_argument("there must be 1 to 1e8 cells");
  }
  const std::vector<double> x = places(origin.x(), size.x(), nx);
  const std::vector<double> y = places(origin.y(), size.y(), ny);
  Mesh mesh;
  mesh.nodes.reserve(x.size() * y.size());
  for (const double v : y) {
    for (const double u : x) mesh.nodes.emplace_back(u, v);
  }
  const size_t per_cell = shape == ElementShape::quadrilateral ? 1 : 2;
  mesh.first.reserve(per_cell * nx * ny + 1);
  mesh.corners.reserve((per_cell == 1 ? 4 : 6) * static_cast<size_t>(nx) * ny);
  const auto node = [columns = nx + 1](int i, int j) { return j * columns + i; };
  for (int j = 0; j < ny; ++j) {
    for (int i = 0; i < nx; ++i) {
      add_quadrilateral(mesh, {node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)},
                        shape, (i + j) % 2 != 0);
    }
  }
  std::vector<std::array<int, 2>> left, right, bottom, top;
  for (int j = ny; j > 0; --j) left.push_back({node(0, j), node(0, j - 1)});
  for (int j = 0; j < ny; ++j) right.push_back({node(nx, j), node(nx, j + 1)});
  for (int i = 0; i < nx; ++i) bottom.push_back({node(i, 0), node(i + 1, 0)});
  for (int i = nx; i > 0; --i) top.push_back({node(i, ny), node(i - 1, ny)});
  mesh.groups = {line_group("left", left), line_group("right", right), line_group("bottom", bottom),
                 line_group("top", top)};
  return mesh;
}

}  // namespace apothem
