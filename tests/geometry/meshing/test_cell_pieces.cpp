// Pieces that join their neighbours, on a grid of unit squares.
#include "geometry/meshing/cell_pieces.hpp"

#include <catch2/catch.hpp>

using namespace apothem;

namespace {

// Nodes of a grid of 4 x 4 points, and the ring around the squares from (x0, y0) to (x1, y1).
int node(int x, int y) { return 4 * y + x; }
std::vector<int> ring(int x0, int y0, int x1, int y1) {
  std::vector<int> nodes;
  for (int x = x0; x < x1; ++x) nodes.push_back(node(x, y0));
  for (int y = y0; y < y1; ++y) nodes.push_back(node(x1, y));
  for (int x = x1; x > x0; --x) nodes.push_back(node(x, y1));
  for (int y = y1; y > y0; --y) nodes.push_back(node(x0, y));
  return nodes;
}

Pieces grid(std::vector<Piece> list) {
  Pieces pieces;
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 4; ++x) pieces.nodes.emplace_back(x, y);
  }
  pieces.freedom.assign(16, -1);
  pieces.list = std::move(list);
  return pieces;
}

double area(const Pieces& pieces, const Piece& piece) {
  const std::vector<Vec2> p = pieces.points(piece.ring);
  double twice = 0;
  for (size_t i = 0; i < p.size(); ++i) twice += cross(p[i], p[(i + 1) % p.size()]);
  return twice / 2;
}

}  // namespace

TEST_CASE("a piece joins the neighbour with the longest common boundary", "[cell_pieces]") {
  Pieces pieces = grid({{0, ring(0, 0, 1, 3), true},     // left
                        {1, ring(1, 0, 3, 1), true},     // below
                        {0, ring(1, 1, 3, 3), false}});  // two edges with each
  pieces.nodes[node(1, 3)].y() = 3.5;                    // one of them longer
  join_pieces(pieces);
  REQUIRE(pieces.list.size() == 2);
  CHECK(area(pieces, pieces.list[0]) == 3 + 4 + .5);
  CHECK(area(pieces, pieces.list[1]) == 2);
}

TEST_CASE("pieces behind others join as well", "[cell_pieces]") {
  Pieces pieces = grid(
      {{0, ring(2, 0, 3, 1), false}, {1, ring(1, 0, 2, 1), false}, {2, ring(0, 0, 1, 1), true}});
  join_pieces(pieces);
  REQUIRE(pieces.list.size() == 1);
  CHECK(pieces.list[0].site == 2);
  CHECK(area(pieces, pieces.list[0]) == 3);
}

TEST_CASE("no cell closes around another", "[cell_pieces]") {
  // A C around the middle square, open to the right, and what closes it.
  const std::vector<int> c{node(0, 0), node(1, 0), node(2, 0), node(3, 0), node(3, 1), node(2, 1),
                           node(1, 1), node(1, 2), node(2, 2), node(3, 2), node(3, 3), node(2, 3),
                           node(1, 3), node(0, 3), node(0, 2), node(0, 1)};
  Pieces pieces = grid({{0, c, true}, {1, ring(1, 1, 2, 2), true}, {2, ring(2, 1, 3, 2), false}});
  join_pieces(pieces);
  REQUIRE(pieces.list.size() == 2);
  CHECK(area(pieces, pieces.list[0]) == 7);  // would be 8, with a hole
  CHECK(area(pieces, pieces.list[1]) == 2);
  // A piece with no neighbour at all.
  Pieces alone = grid({{0, ring(0, 0, 1, 1), true}, {1, ring(2, 2, 3, 3), false}});
  join_pieces(alone);
  CHECK(alone.list.size() == 2);
}

TEST_CASE("parts of a cell that goes round a hole join to two, the smallest first",
          "[cell_pieces]") {
  std::vector<Piece> squares;
  for (int y = 0; y < 3; ++y) {
    for (int x = 0; x < 3; ++x) {
      if (x != 1 || y != 1) squares.push_back({0, ring(x, y, x + 1, y + 1), false, true});
    }
  }
  squares.push_back({1, ring(1, 1, 2, 2), true});  // of another site
  Pieces pieces = grid(squares);
  join_triangles(pieces);
  REQUIRE(pieces.list.size() == 3);
  CHECK(area(pieces, pieces.list[0]) + area(pieces, pieces.list[1]) == 8);
  CHECK(std::min(area(pieces, pieces.list[0]), area(pieces, pieces.list[1])) >= 2);
  CHECK(area(pieces, pieces.list[2]) == 1);
}
