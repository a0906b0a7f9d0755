// Meshes of polygonal cells: what is refused as a tiling, and what collapsing an edge does.
#include "geometry/meshing/polygon_mesh.hpp"

#include <catch2/catch.hpp>

#include "tests/support.hpp"

using namespace apothem;

namespace {

// Four unit squares about node 4.
PolygonMesh squares() {
  PolygonMesh mesh;
  for (int y = 0; y < 3; ++y) {
    for (int x = 0; x < 3; ++x) mesh.points.emplace_back(x, y);
  }
  for (const int i : {0, 1, 3, 4}) mesh.cells.push_back({i, i + 1, i + 4, i + 3});
  return mesh;
}

// The square [0, 4]^2 in four cells that meet at a short edge 4-5 in the middle.
PolygonMesh short_edge_inside(double length) {
  return {{{0, 0}, {4, 0}, {4, 4}, {0, 4}, {2 - length / 2, 2}, {2 + length / 2, 2}},
          {{0, 1, 5, 4}, {1, 2, 5}, {2, 3, 4, 5}, {3, 0, 4}}};
}
const std::vector<int> kInside{kNowhere, kNowhere, kNowhere, kNowhere, kAnywhere, kAnywhere};

std::string refusal(const PolygonMesh& mesh) {
  try {
    tiling_boundary(mesh);
    return "";
  } catch (const InvalidPolygon& error) {
    return error.what();
  }
}

}  // namespace

TEST_CASE("the boundary of a tiling is one ring", "[polygon_mesh]") {
  CHECK(tiling_boundary(squares()) == std::vector<std::vector<int>>{{0, 1, 2, 5, 8, 7, 6, 3}});
}

TEST_CASE("the boundary of a tiling with a hole is two rings", "[polygon_mesh]") {
  // A square around a square, in four cells. The hole has the lowest numbers.
  PolygonMesh mesh{{{1, 1}, {2, 1}, {2, 2}, {1, 2}, {0, 0}, {3, 0}, {3, 3}, {0, 3}},
                   {{4, 5, 1, 0}, {5, 6, 2, 1}, {6, 7, 3, 2}, {7, 4, 0, 3}}};
  CHECK(tiling_boundary(mesh, 1) == std::vector<std::vector<int>>{{4, 5, 6, 7}, {0, 3, 2, 1}});
  CHECK_THROWS_WITH(tiling_boundary(mesh), Catch::Contains("has 2 rings instead of 1"));
  CHECK_THROWS_WITH(tiling_boundary(squares(), 1), Catch::Contains("has 1 rings instead of 2"));
  // Two squares apart from each other are no square with a hole.
  PolygonMesh apart{{{0, 0}, {1, 0}, {1, 1}, {0, 1}, {2, 0}, {3, 0}, {3, 1}, {2, 1}},
                    {{0, 1, 2, 3}, {4, 5, 6, 7}}};
  CHECK_THROWS_AS(tiling_boundary(apart, 1), InvalidPolygon);
}

TEST_CASE("what is no tiling is refused", "[polygon_mesh]") {
  const auto spoiled = [](const auto& spoil) {
    PolygonMesh mesh = squares();
    spoil(mesh);
    return refusal(mesh);
  };
  using Catch::Contains;
  CHECK(refusal(squares()).empty());
  CHECK_THAT(spoiled([](PolygonMesh& m) {
               m.points[4] = {-1, -1};
             }),
             Contains("cell 0: is clockwise"));
  CHECK_THAT(spoiled([](PolygonMesh& m) { m.points[4].x() = std::nan(""); }),
             Contains("not finite"));
  CHECK_THAT(spoiled([](PolygonMesh& m) { std::reverse(m.cells[2].begin(), m.cells[2].end()); }),
             Contains("cell 2: is clockwise"));
  CHECK_THAT(spoiled([](PolygonMesh& m) { m.cells.push_back(m.cells[0]); }),
             Contains("same side of an edge"));
  // Without two opposite squares the others only touch; a lone square is another ring.
  CHECK_THAT(spoiled([](PolygonMesh& m) {
               m.cells = {m.cells[0], m.cells[3]};
             }),
             Contains("meets itself"));
  CHECK_THAT(spoiled([](PolygonMesh& m) {
               for (const double x : {10, 11}) m.points.emplace_back(x, 0);
               m.points.emplace_back(10, 1);
               m.cells.push_back({9, 10, 11});
             }),
             Contains("gaps"));
  // A node that only one of two neighbours knows leaves a slit of zero width.
  CHECK_FALSE(spoiled([](PolygonMesh& m) {
                m.points.emplace_back(1, .5);
                m.cells[0] = {0, 1, 9, 4, 3};
              }).empty());
  CHECK_FALSE(spoiled([](PolygonMesh& m) { m.cells.clear(); }).empty());
}

TEST_CASE("two free nodes meet half-way", "[polygon_mesh]") {
  PolygonMesh mesh = short_edge_inside(.25);
  const ShortEdges edges = collapse_short_edges(mesh, kInside, .3);
  CHECK(edges.collapsed == 1);
  CHECK(edges.left == 0);
  REQUIRE(mesh.points.size() == 5);
  CHECK(mesh.points[4] == Vec2(2, 2));
  CHECK(mesh.cells == std::vector<std::vector<int>>{{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {0, 4, 3}});
  CHECK(refusal(mesh).empty());

  PolygonMesh long_enough = short_edge_inside(.25);
  CHECK(collapse_short_edges(long_enough, kInside, .25).collapsed == 0);
  CHECK(long_enough.points.size() == 6);
}

TEST_CASE("a free node moves to the outline, and nodes there stay", "[polygon_mesh]") {
  // Node 4 on the lower edge, node 5 just above it.
  PolygonMesh mesh{{{0, 0}, {4, 0}, {4, 4}, {0, 4}, {1.5, 0}, {1.5, .1}},
                   {{0, 4, 5, 3}, {4, 1, 2, 5}, {2, 3, 5}}};
  const std::vector<int> freedom{kNowhere, kNowhere, kNowhere, kNowhere, 0, kAnywhere};
  REQUIRE(refusal(mesh).empty());
  CHECK(collapse_short_edges(mesh, freedom, .2).collapsed == 1);
  CHECK(mesh.points[4] == Vec2(1.5, 0));
  CHECK(mesh.cells == std::vector<std::vector<int>>{{0, 4, 3}, {1, 2, 4}, {2, 3, 4}});
  CHECK(refusal(mesh).empty());
}

TEST_CASE("edges that must stay short are counted", "[polygon_mesh]") {
  // A neck: 4-5 runs from one side of the outline to the other.
  PolygonMesh neck{{{0, 0}, {4, 0}, {4, .1}, {0, .1}, {2, 0}, {2, .1}},
                   {{0, 4, 5, 3}, {4, 1, 2, 5}}};
  REQUIRE(refusal(neck).empty());
  const ShortEdges across =
      collapse_short_edges(neck, {kNowhere, kNowhere, kNowhere, kNowhere, 0, 2}, .2);
  CHECK(across.collapsed == 0);
  CHECK(across.left == 1);
  CHECK(neck.points.size() == 6);

  // The small triangle would vanish.
  PolygonMesh triangle{{{0, 0}, {4, 0}, {2, 4}, {1.9, 1.5}, {2.1, 1.5}, {2, 1.7}},
                       {{0, 1, 4, 3}, {1, 2, 5, 4}, {0, 3, 5, 2}, {3, 4, 5}}};
  REQUIRE(refusal(triangle).empty());
  const ShortEdges kept = collapse_short_edges(
      triangle, {kNowhere, kNowhere, kNowhere, kAnywhere, kAnywhere, kAnywhere}, .3);
  CHECK(kept.collapsed == 0);
  CHECK(kept.left == 3);
  CHECK(triangle.cells.size() == 4);
}
