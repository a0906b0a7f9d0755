// Structured meshes: rectangle and disc.
#include <numbers>

#include "mesh/disc_mesh.hpp"
#include "mesh/rectangle_mesh.hpp"
#include "mesh_laws.hpp"

using namespace apothem;
using namespace apothem::test;

TEST_CASE("rectangles", "[mesh]") {
  for (const ElementShape shape : {ElementShape::quadrilateral, ElementShape::triangle}) {
    for (const std::array<int, 2> cells : {std::array{1, 1}, {5, 1}, {4, 7}, {100, 10}}) {
      const Vec2 size(10, 1.1), origin(-.3, 7.7);
      const Mesh mesh = rectangle_mesh(size, cells, origin, shape);
      check_laws(mesh, 11);
      const int per_cell = shape == ElementShape::triangle ? 2 : 1;
      CHECK(mesh.element_count() == per_cell * cells[0] * cells[1]);
      CHECK(mesh.nodes.front() == origin);
      CHECK(mesh.nodes.back() == Vec2(origin + size));
      check_share_boundary(mesh, {"left", "right", "bottom", "top"});
      for (const int node : group(mesh, "left").nodes) CHECK(mesh.nodes[node].x() == origin.x());
      for (const int node : group(mesh, "top").nodes) {
        CHECK(mesh.nodes[node].y() == origin.y() + size.y());
      }
      CHECK(static_cast<int>(group(mesh, "right").edges.size()) == cells[1]);
    }
  }
}

TEST_CASE("triangles of a rectangle prefer no direction", "[mesh]") {
  const Mesh mesh = rectangle_mesh({1, 1}, {8, 8}, {0, 0}, ElementShape::triangle);
  int rising = 0, falling = 0;
  for (const MeshEdge& edge : mesh_edges(mesh)) {
    const Vec2 d = mesh.nodes[edge.nodes[1]] - mesh.nodes[edge.nodes[0]];
    rising += d.x() * d.y() > 0;
    falling += d.x() * d.y() < 0;
  }
  CHECK(rising == 32);
  CHECK(falling == 32);
}

TEST_CASE("rectangles that cannot be are refused", "[mesh]") {
  const auto make = [](const Vec2& size, const std::array<int, 2>& cells, double x = 0) {
    return rectangle_mesh(size, cells, {x, 0}, ElementShape::quadrilateral);
  };
  CHECK_THROWS_AS(make({0, 1}, {1, 1}), std::invalid_argument);
  CHECK_THROWS_AS(make({1, -1}, {1, 1}), std::invalid_argument);
  CHECK_THROWS_AS(make({std::nan(""), 1}, {1, 1}), std::invalid_argument);
  CHECK_THROWS_AS(make({1, 1}, {1, 0}), std::invalid_argument);
  CHECK_THROWS_AS(make({1, 1}, {100000, 100000}), std::invalid_argument);
  CHECK_THROWS_AS(make({1, 1}, {10, 1}, 1e15), std::invalid_argument);
  CHECK_NOTHROW(make({1, 1}, {10, 1}, 1e6));
}

TEST_CASE("discs", "[mesh]") {
  for (const int quarter : {1, 2, 3, 4, 8, 17, 32}) {
    const Mesh mesh = disc_mesh({0, 0}, .5, {quarter}, ElementShape::quadrilateral);
    const int n = 4 * quarter;  // a regular polygon
    const double area = n * .125 * std::sin(2 * std::numbers::pi / n);
    check_laws(mesh, area);
    check_share_boundary(mesh, {"boundary"});
    CHECK(mesh_quality(mesh).smallest_scaled_jacobian > (quarter == 1 ? .7 : .8));
    if (quarter >= 4) {
      CHECK(mesh_quality(mesh).largest_area < 2.6 * mesh_quality(mesh).smallest_area);
    }
    const Mesh triangles = disc_mesh({0, 0}, .5, {quarter}, ElementShape::triangle);
    check_laws(triangles, area);
    CHECK(triangles.element_count() == 2 * mesh.element_count());
    CHECK(triangles.nodes == mesh.nodes);
    CHECK(mesh_quality(triangles).smallest_angle >
          (quarter == 1 ? 11 : 24) * std::numbers::pi / 180);

    std::set<std::pair<double, double>> places;
    for (const Vec2& p : mesh.nodes) places.emplace(p.x(), p.y());
    for (const Vec2& p : mesh.nodes) CHECK(places.count({-p.y() + 0., p.x() + 0.}));
    const std::vector<int>& rim = group(mesh, "boundary").nodes;
    CHECK(static_cast<int>(rim.size()) == n);
    for (const int node : rim) CHECK(std::abs(mesh.nodes[node].norm() - .5) < 1e-16);
    if (quarter % 2 == 0) CHECK(places.count({0, -.5}));
  }
}

TEST_CASE("graded and shifted discs", "[mesh]") {
  const Mesh mesh = disc_mesh({1e6, -3}, 2, {16, 5}, ElementShape::quadrilateral);
  check_laws(mesh, 64 * 2 * std::sin(2 * std::numbers::pi / 64), 0, 1e-9);
  for (const int node : group(mesh, "boundary").nodes) {
    CHECK((mesh.nodes[node] - Vec2(1e6, -3)).norm() == Approx(2).epsilon(1e-10));
  }
  CHECK(mesh_quality(mesh).shortest_edge <
        .5 * mesh_quality(disc_mesh({0, 0}, 2, {16}, ElementShape::quadrilateral)).shortest_edge);
  for (const DiscCells& wrong : {DiscCells{0, 1}, {6000, 1}, {4, 0}, {4, std::nan("")}}) {
    CHECK_THROWS_AS(disc_mesh({0, 0}, 1, wrong, ElementShape::triangle), std::invalid_argument);
  }
  CHECK_THROWS_AS(disc_mesh({0, 0}, 0, {4}, ElementShape::triangle), std::invalid_argument);
}
