// Structured meshes: rectangle, disc, half a disc; mirror images.
#include <numbers>

#include "lib/mesh/disc_mesh.hpp"
#include "lib/mesh/half_disc_mesh.hpp"
#include "lib/mesh/mirror.hpp"
#include "lib/mesh/rectangle_mesh.hpp"
#include "tests/mesh/mesh_laws.hpp"

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

TEST_CASE("half discs", "[mesh]") {
  struct Case {
    HalfDiscCells cells;
    double jacobian, angle;  // smallest ones; angle in degrees
  };
  for (const auto& [cells, jacobian, angle] : {Case{{.03, 18}, .02, .6},
                                               {{.05, 1}, .08, 2.2},
                                               {{.25, 6, 1.3}, .2, 4.4},
                                               {{.5, 16}, .18, 1.7}}) {
    INFO(cells.fine << " " << cells.cells);
    const Vec2 pole(.5, -2);
    const Mesh mesh = half_disc_mesh(pole, 2, cells, ElementShape::quadrilateral);
    double area = 0;  // of the polygon
    const std::vector<std::array<int, 2>>& arc = group(mesh, "arc").edges;
    for (const auto& [a, b] : arc) {
      const Vec2 centre = pole + Vec2(0, 2);
      area += cross(mesh.nodes[a] - centre, mesh.nodes[b] - centre) / 2;
      CHECK((mesh.nodes[a] - centre).norm() == Approx(2).epsilon(1e-14));
    }
    check_laws(mesh, area);
    check_share_boundary(mesh, {"arc", "straight"});
    for (const int node : group(mesh, "straight").nodes) CHECK(mesh.nodes[node].y() == 0);
    CHECK(mesh_quality(mesh).smallest_scaled_jacobian > jacobian);
    const Mesh triangles = half_disc_mesh(pole, 2, cells, ElementShape::triangle);
    check_laws(triangles, area);
    CHECK(mesh_quality(triangles).smallest_angle > angle * std::numbers::pi / 180);

    // Its own mirror image, to the last bit about the origin; edges of the fine part are equal.
    const Mesh here = half_disc_mesh({0, 0}, 2, cells, ElementShape::quadrilateral);
    std::set<std::pair<double, double>> places;
    for (const Vec2& p : here.nodes) places.emplace(p.x(), p.y());
    for (const Vec2& p : here.nodes) CHECK(places.count({-p.x() + 0., p.y()}));
    int fine = 0;
    for (const auto& [a, b] : arc) {
      const Vec2 middle = (mesh.nodes[a] + mesh.nodes[b]) / 2 - pole;
      if (std::abs(middle.x()) > 2 * cells.fine) continue;
      CHECK((mesh.nodes[a] - mesh.nodes[b]).norm() ==
            Approx(4 * std::sin(std::asin(cells.fine) / cells.cells / 2)).epsilon(1e-12));
      ++fine;
    }
    CHECK(fine == 2 * cells.cells);
  }
  for (const HalfDiscCells& wrong :
       {HalfDiscCells{.6, 4}, {0, 4}, {std::nan(""), 4}, {.1, 0}, {.1, 4, 1}, {.1, 2000}}) {
    CHECK_THROWS_AS(half_disc_mesh({0, 0}, 1, wrong, ElementShape::triangle),
                    std::invalid_argument);
  }
  CHECK_THROWS_AS(half_disc_mesh({0, 0}, -1, {.1, 4}, ElementShape::triangle),
                  std::invalid_argument);
}

TEST_CASE("mirror images", "[mesh]") {
  const Mesh mesh = rectangle_mesh({2, 1}, {4, 3}, {1, 0}, ElementShape::triangle);
  for (const int axis : {0, 1}) {
    Mesh image = mesh;
    mirror(image, axis, .5);
    check_laws(image, 2);
    check_share_boundary(image, {"left", "right", "bottom", "top"});
    for (size_t i = 0; i < mesh.nodes.size(); ++i) {
      CHECK(image.nodes[i][axis] == 1 - mesh.nodes[i][axis]);
      CHECK(image.nodes[i][1 - axis] == mesh.nodes[i][1 - axis]);
    }
    CHECK(group(image, "left").nodes == group(mesh, "left").nodes);
    for (int e = 0; e < mesh.element_count(); ++e) {
      CHECK(image.element(e).front() == mesh.element(e).front());
    }
    mirror(image, axis, .5);
    CHECK(image.corners == mesh.corners);
  }
}
