// Points in a mesh, and nodes and edges by place.
#include "geometry/meshing/voronoi.hpp"
#include "geometry/polygon/predicates.hpp"
#include "lib/mesh/disc_mesh.hpp"
#include "lib/mesh/fill_mesh.hpp"
#include "lib/mesh/locate.hpp"
#include "lib/mesh/rectangle_mesh.hpp"
#include "lib/mesh/select.hpp"
#include "tests/mesh/mesh_laws.hpp"
#include "tests/shapes.hpp"

using namespace apothem;
using namespace apothem::test;

namespace {

void check_weights(const Mesh& mesh, const MeshPoint& found, const Vec2& p, double tolerance) {
  const auto corners = mesh.element(found.element);
  REQUIRE(found.weights.size() == corners.size());
  double sum = 0;
  Vec2 place = Vec2::Zero();
  for (size_t i = 0; i < corners.size(); ++i) {
    sum += found.weights[i];
    place += found.weights[i] * (mesh.nodes[corners[i]] - p);
    CHECK(found.weights[i] > -tolerance);
  }
  CHECK(sum == Approx(1).epsilon(1e-14));
  CHECK(place.norm() < tolerance);
}

std::vector<Mesh> meshes_of_unit_square() {
  const Polygon square = samples::block(0, 0, 1, 1);
  const VoronoiMesh voronoi = voronoi_mesh(square, {.cells = 40});
  return {rectangle_mesh({1, 1}, {5, 4}, {0, 0}, ElementShape::quadrilateral),
          rectangle_mesh({1, 1}, {5, 4}, {0, 0}, ElementShape::triangle),
          fill_mesh(square, {}, .2, ElementShape::quadrilateral),
          fill_mesh(square, {}, .2, ElementShape::triangle),
          mesh_of_cells(square, in_world(square, voronoi.mesh))};
}

}  // namespace

TEST_CASE("points are found, with weights that reproduce linear fields", "[mesh]") {
  samples::Random random(7);
  for (const Mesh& mesh : meshes_of_unit_square()) {
    for (int i = 0; i < 500; ++i) {
      const Vec2 p(random.uniform(0, 1), random.uniform(0, 1));
      const std::optional<MeshPoint> found = find_point(mesh, p);
      REQUIRE(found);
      std::vector<Vec2> ring;
      for (const int c : mesh.element(found->element)) ring.push_back(mesh.nodes[c]);
      CHECK(strictly_inside(ring, p));
      check_weights(mesh, *found, p, 1e-13);
    }
    for (int node = 0; node < static_cast<int>(mesh.nodes.size()); ++node) {
      const std::optional<MeshPoint> found = find_point(mesh, mesh.nodes[node]);
      REQUIRE(found);
      check_weights(mesh, *found, mesh.nodes[node], 1e-13);
      const auto corners = mesh.element(found->element);
      const auto corner = std::find(corners.begin(), corners.end(), node);
      REQUIRE(corner != corners.end());
      CHECK(found->weights[corner - corners.begin()] == Approx(1).epsilon(1e-13));
    }
    for (const MeshEdge& edge : mesh_edges(mesh)) {
      for (const double share : {.5, 1e-10, random.uniform(0, 1)}) {
        const Vec2 p = mesh.nodes[edge.nodes[0]] +
                       share * (mesh.nodes[edge.nodes[1]] - mesh.nodes[edge.nodes[0]]);
        const std::optional<MeshPoint> found = find_point(mesh, p);
        REQUIRE(found);
        check_weights(mesh, *found, p, 1e-13);
      }
    }
    for (const double off : {1e-10, 1e-14, 9e-10}) {
      for (const Vec2& p : {Vec2(-off, .37), Vec2(.61, 1 + off), Vec2(-off / 2, -off / 2)}) {
        const std::optional<MeshPoint> found = find_point(mesh, p);
        REQUIRE(found);
        check_weights(mesh, *found, p, 1e-7);
      }
    }
    for (const Vec2& p : {Vec2(-2e-9, .4), Vec2(.3, 1.1), Vec2(7, 7), Vec2(std::nan(""), 0)}) {
      CHECK_FALSE(find_point(mesh, p));
    }
  }
}

TEST_CASE("weights in elements of any shape", "[mesh]") {
  samples::Random random(8);
  for (int i = 0; i < 300; ++i) {
    const Polygon shape = i % 3 == 0   ? samples::random_quad(random)
                          : i % 3 == 1 ? samples::random_star_shaped(random, 6, .2)
                                       : samples::random_star_shaped(random, 4, .1);
    Mesh mesh;
    mesh.nodes = shape.vertices();
    std::vector<int> corners;
    for (int c = 0; c < shape.size(); ++c) corners.push_back(c);
    mesh.add_element(corners);
    for (int k = 0; k < 50; ++k) {
      const Vec2 p(random.uniform(-1, 1), random.uniform(-1, 1));
      if (!strictly_inside(shape.vertices(), p)) continue;
      const std::vector<double> weights = interpolation_weights(mesh, 0, p);
      double sum = 0;
      Vec2 place = Vec2::Zero();
      for (int c = 0; c < shape.size(); ++c) {
        sum += weights[c];
        place += weights[c] * (shape[c] - p);
        if (shape.is_convex()) CHECK(weights[c] >= 0);
      }
      CHECK(sum == Approx(1).epsilon(1e-13));
      CHECK(place.norm() < 1e-13);
    }
  }
}

TEST_CASE("nodes and edges by place", "[mesh]") {
  // Nodes 4 j + i at (i, j).
  const Mesh mesh = rectangle_mesh({3, 2}, {3, 2}, {0, 0}, ElementShape::quadrilateral);
  using Nodes = std::vector<int>;
  CHECK(nodes_where(mesh, {}).size() == 12);
  CHECK(nodes_where(mesh, {.x = 0}) == Nodes{0, 4, 8});
  CHECK(nodes_where(mesh, {.x = 1e-9}) == Nodes{0, 4, 8});
  CHECK(nodes_where(mesh, {.x = 1e-8}).empty());
  CHECK(nodes_where(mesh, {.x = 3, .y = 2}) == Nodes{11});
  CHECK(nodes_where(mesh, {.box = Box{1, 1, 2.5, 9}}) == Nodes{5, 6, 9, 10});
  CHECK(nodes_where(mesh, {.group = "top"}) == Nodes{8, 9, 10, 11});
  CHECK(nodes_where(mesh, {.x = 1, .group = "top"}) == Nodes{9});
  CHECK(nodes_where(mesh, {.nearest = Vec2(1.2, 1.4)}) == Nodes{5});
  CHECK(nodes_where(mesh, {.group = "top", .nearest = Vec2(1.2, -1)}) == Nodes{9});
  CHECK(nodes_where(mesh, {.nearest = Vec2(.5, 0)}) == Nodes{0});
  CHECK_THROWS_WITH(nodes_where(mesh, {.group = "topp"}),
                    Catch::Contains("no group \"topp\" (known: left, right, bottom, top)"));

  const auto edges = [&](const Place& place) {
    std::set<std::array<int, 2>> result;
    for (const MeshEdge& edge : edges_where(mesh, place)) result.insert(edge.nodes);
    return result;
  };
  using Edges = std::set<std::array<int, 2>>;
  CHECK(edges({.x = 0}) == Edges{{8, 4}, {4, 0}});
  CHECK(edges({.x = 1}).empty());  // inside
  CHECK(edges({.box = Box{1, 1, 3, 2}}) == Edges{{7, 11}, {11, 10}, {10, 9}});
  CHECK(edges({}).size() == 10);

  // One cell wide, the ends in one group: the edge between them is not in it.
  Mesh strip = rectangle_mesh({1, 3}, {1, 3}, {0, 0}, ElementShape::quadrilateral);
  MeshGroup sides = group(strip, "left");
  const MeshGroup& right = group(strip, "right");
  sides.name = "sides";
  sides.nodes.insert(sides.nodes.end(), right.nodes.begin(), right.nodes.end());
  sides.edges.insert(sides.edges.end(), right.edges.begin(), right.edges.end());
  std::sort(sides.nodes.begin(), sides.nodes.end());
  strip.groups.push_back(sides);
  CHECK_NOTHROW(check_mesh(strip));
  CHECK(edges_where(strip, {.group = "sides"}).size() == 6);
  CHECK(edges_where(strip, {}).size() == 8);
}
