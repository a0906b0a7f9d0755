// Voronoi meshes against the definition of a Voronoi cell and of a tiling, by brute force.
#include "geometry/meshing/voronoi.hpp"

#include <array>
#include <boost/multiprecision/cpp_int.hpp>
#include <catch2/catch.hpp>
#include <cstdlib>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include "tests/geometry/skeleton/holed_polygons.hpp"
#include "tests/public_rings.hpp"
#include "tests/support.hpp"

using namespace apothem;
using Ring = std::vector<Vec2>;
using Rational = boost::multiprecision::cpp_rational;

namespace {

Ring square() { return {{0, 0}, {1, 0}, {1, 1}, {0, 1}}; }

Ring pointed_ring(int points, double inner) {
  Ring ring;
  for (int i = 0; i < 2 * points; ++i) {
    const double angle = M_PI * i / points;
    ring.push_back((i % 2 == 0 ? 1 : inner) * Vec2(std::cos(angle), std::sin(angle)));
  }
  return ring;
}

Ring comb(int teeth) {
  Ring ring{{0, 0}, {2. * teeth, 0}};
  for (int i = 2 * teeth - 2; i >= 0; i -= 2) {
    ring.emplace_back(i + 2, i + 2 == 2 * teeth ? 7 : 1);
    ring.emplace_back(i + 1.25, i + 2 == 2 * teeth ? 7 : 1);
    if (i + 2 != 2 * teeth) {
      ring[ring.size() - 2] = {i + 1.75, 7};
      ring.back() = {i + 1.25, 7};
    }
    ring.emplace_back(i + 1., 1);
    if (i > 0) ring.emplace_back(i - .25, 1);
  }
  ring.emplace_back(0, 1);
  return ring;
}

Ring wound_ring(double turns, int steps) {
  Ring ring;
  for (const double width : {0., 3.}) {
    Ring side;
    for (int i = 0; i <= steps; ++i) {
      const double angle = 2 * M_PI * turns * i / steps;
      side.push_back((1 + angle + width) * Vec2(std::cos(angle), std::sin(angle)));
    }
    if (width == 0) std::reverse(side.begin(), side.end());
    ring.insert(ring.end(), side.begin(), side.end());
  }
  std::reverse(ring.begin(), ring.end());
  return ring;
}

struct Shape {
  const char* name;
  Ring ring;
};
std::vector<Shape> shapes() {
  return {{"square", square()},
          {"strip", {{0, 0}, {100, 0}, {100, 1}, {0, 1}}},
          {"slanted strip", {{0, 0}, {80, 60}, {79.4, 60.8}, {-.6, .8}}},
          {"L", {{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 3}, {0, 3}}},
          {"cross",
           {{1, 0},
            {2, 0},
            {2, 1},
            {3, 1},
            {3, 2},
            {2, 2},
            {2, 3},
            {1, 3},
            {1, 2},
            {0, 2},
            {0, 1},
            {1, 1}}},
          {"star", pointed_ring(7, .4)},
          {"star of 1000 vertices", pointed_ring(500, .8)},
          {"comb", comb(6)},
          {"spiral", wound_ring(3, 100)}};
}

// Twice the area between the ring and its origin, without any rounding.
Rational exact_area(const PolygonMesh& mesh, const std::vector<int>& nodes) {
  Rational sum = 0;
  for (size_t i = 0; i < nodes.size(); ++i) {
    const Vec2& p = mesh.points[nodes[i]];
    const Vec2& q = mesh.points[nodes[i + 1 == nodes.size() ? 0 : i + 1]];
    sum += Rational(p.x()) * Rational(q.y()) - Rational(p.y()) * Rational(q.x());
  }
  return sum;
}

// Moving node `from` to node `to` makes a cell invalid.
bool collapse_is_barred(const PolygonMesh& mesh, int from, int to) {
  for (std::vector<int> cell : mesh.cells) {
    if (std::count(cell.begin(), cell.end(), to) > 0) {
      std::erase(cell, from);
    } else {
      std::replace(cell.begin(), cell.end(), from, to);
    }
    try {
      if (Polygon(cell_ring(mesh, cell)).input_index(1) != 1) return true;
    } catch (const InvalidPolygon&) {
      return true;
    }
  }
  return false;
}

struct Found {
  double outline_deviation = 0;  // of a node from its edge of the region, of the region's size
  double area_defect = 0;        // of the region
};

// Every law of a Voronoi mesh, by code of its own.
Found lawful(const Polygon& region, const VoronoiMesh& voronoi, size_t cells, double shortest) {
  const PolygonMesh& mesh = voronoi.mesh;
  const int n = region.size();
  Found found;
  REQUIRE((region.has_holes() ? mesh.cells.size() >= cells : mesh.cells.size() == cells));
  REQUIRE(static_cast<int>(mesh.points.size()) >= n);
  CHECK(std::equal(mesh.points.begin(), mesh.points.begin() + n, region.local_vertices().begin()));

  std::map<std::pair<int, int>, int> cell_of;
  std::set<int> used;
  double area = 0;
  for (const std::vector<int>& cell : mesh.cells) {
    REQUIRE(Polygon(cell_ring(mesh, cell)).input_index(1) == 1);  // simple, counter-clockwise
    area += area_moments(Polygon(cell_ring(mesh, cell))).area;
    for (size_t i = 0; i < cell.size(); ++i) {
      REQUIRE(cell_of.emplace(std::pair(cell[i], cell[(i + 1) % cell.size()]), 0).second);
      used.insert(cell[i]);
    }
  }
  CHECK(used.size() == mesh.points.size());
  std::map<int, int> next;
  for (const auto& [edge, unused] : cell_of) {
    if (!cell_of.count({edge.second, edge.first})) REQUIRE(next.emplace(edge).second);
  }
  // From vertex to vertex of the region, with nodes in between that advance along the edge.
  const Ring local = region.local_vertices();
  const Box box = box_of(local);
  std::vector<int> outline;
  std::vector<std::vector<int>> rings(region.rings());
  for (int k = 0, ring = 0; k < n; ++k) {
    if (k == region.ring_start(ring + 1)) ++ring;
    const size_t done = outline.size();
    const Vec2 along = local[region.next(k)] - local[k];
    double before = 0;
    int node = k;
    outline.push_back(k);
    while ((node = next.at(node)) != region.next(k)) {
      REQUIRE(node >= n);
      const Vec2 d = mesh.points[node] - local[k];
      CHECK(along.dot(d) > before);
      before = along.dot(d);
      found.outline_deviation = std::max(found.outline_deviation,
                                         std::abs(cross(along, d)) / along.norm() / box.extent());
      outline.push_back(node);
    }
    CHECK(before < along.squaredNorm());
    rings[ring].insert(rings[ring].end(), outline.begin() + static_cast<std::ptrdiff_t>(done),
                       outline.end());
  }
  CHECK(outline.size() == next.size());
  CHECK(found.outline_deviation < 4e-16);

  // The cells' areas add up to that of the boundary exactly, to the region's up to its rounding.
  Rational sum = 0;
  for (const std::vector<int>& cell : mesh.cells) sum += exact_area(mesh, cell);
  for (const std::vector<int>& ring : rings) sum -= exact_area(mesh, ring);
  CHECK(sum == 0);
  const double whole = area_moments(region).area;
  found.area_defect = std::abs(area - whole) / whole;

  const double size = std::sqrt(whole / static_cast<double>(cells));
  const std::set<int> on_outline(outline.begin(), outline.end());
  int short_edges = 0;
  for (const auto& [edge, unused] : cell_of) {
    const auto& [u, v] = edge;
    const bool inside = cell_of.count({v, u});
    if ((mesh.points[u] - mesh.points[v]).norm() >= shortest * size) continue;
    if (inside ? u < v : u >= n || v >= n) ++short_edges;
    if (!inside || (on_outline.count(u) && on_outline.count(v))) continue;
    // A vertex of the outline must be in the way, or a triangle would vanish. Without holes none of
    // these regions has such a triangle away from the outline.
    REQUIRE((on_outline.count(u) || on_outline.count(v) || region.has_holes()));
    CHECK(collapse_is_barred(mesh, on_outline.count(u) ? v : u, on_outline.count(u) ? u : v));
  }
  CHECK(short_edges == voronoi.short_edges.left);
  return found;
}

bool contains(const Ring& ring, const Vec2& p) {
  double turn = 0;
  for (size_t i = 0; i < ring.size(); ++i) {
    const Vec2 a = ring[i] - p;
    const Vec2 b = ring[(i + 1) % ring.size()] - p;
    turn += std::atan2(cross(a, b), a.dot(b));
  }
  return std::abs(turn) > M_PI;
}

bool sees(const Ring& ring, const Vec2& p, const Vec2& q) {
  for (size_t i = 0; i < ring.size(); ++i) {
    const Vec2& a = ring[i];
    const Vec2& b = ring[(i + 1) % ring.size()];
    if ((cross(q - p, a - p) > 0) != (cross(q - p, b - p) > 0) &&
        (cross(b - a, p - a) > 0) != (cross(b - a, q - a) > 0)) {
      return false;
    }
  }
  return true;
}

// Sum over the cells of the integral of the squared distance to their site.
double energy(const VoronoiMesh& voronoi) {
  double sum = 0;
  for (size_t i = 0; i < voronoi.sites.size(); ++i) {
    const Polygon cell(cell_ring(voronoi.mesh, voronoi.mesh.cells[i]));
    const AreaMoments m = area_moments(cell);
    sum += m.polar + m.area * (cell.origin() + m.centroid - voronoi.sites[i]).squaredNorm();
  }
  return sum;
}

}  // namespace

TEST_CASE("every shape is tiled exactly", "[voronoi][slow]") {
  for (const Shape& shape : shapes()) {
    const Polygon region(shape.ring);
    for (const int cells : {1, 2, 3, 20, 150}) {
      for (const int lloyd : {0, 20}) {
        if (test::kSanitized && cells > 20) continue;
        INFO(shape.name << ", " << cells << " cells, " << lloyd << " Lloyd steps");
        const VoronoiOptions options{.cells = cells, .seed = 7, .lloyd = lloyd};
        const Found found = lawful(region, voronoi_mesh(region, options), cells, .1);
        CHECK(found.area_defect < 1e-14);
      }
    }
  }
}

TEST_CASE("ten thousand cells", "[voronoi]") {
  const int cells = test::scaled(10'000);
  const Polygon region(square());
  const VoronoiMesh voronoi = voronoi_mesh(region, {.cells = cells, .lloyd = 3});
  const Found found = lawful(region, voronoi, cells, .1);
  CHECK(found.area_defect < 1e-14);
  CHECK(found.outline_deviation == 0);  // edges along the axes: nodes lie on them exactly
}

TEST_CASE("every point of the region lies in exactly one cell", "[voronoi]") {
  for (const Shape& shape : shapes()) {
    const Polygon region(shape.ring);
    const VoronoiMesh voronoi = voronoi_mesh(region, {.cells = 30, .seed = 3, .lloyd = 5});
    std::vector<Ring> rings;
    for (const auto& cell : voronoi.mesh.cells) rings.push_back(cell_ring(voronoi.mesh, cell));
    const Ring local = region.local_vertices();
    const Box box = bounding_box(Polygon(local));
    test::SeededRandom random(5);
    int inside = 0;
    for (int i = 0; i < test::scaled(500); ++i) {
      const Vec2 p(random.uniform(box.x0, box.x1), random.uniform(box.y0, box.y1));
      const auto holding =
          std::count_if(rings.begin(), rings.end(), [&](const Ring& r) { return contains(r, p); });
      INFO(shape.name << ", " << p.transpose());
      CHECK(holding == (contains(local, p) ? 1 : 0));
      inside += holding > 0;
    }
    CHECK((inside > 0 || test::kSanitized || std::string(shape.name) == "slanted strip"));
  }
}

TEST_CASE("a cell is what its site is nearest to and sees", "[voronoi]") {
  for (const Shape& shape : shapes()) {
    const Polygon region(shape.ring);
    const Ring local = region.local_vertices();
    const std::vector<Vec2> sites = random_sites(region, 40, 11);
    const VoronoiMesh voronoi = voronoi_mesh(region, sites, 0);
    CHECK(voronoi.short_edges.collapsed == 0);
    std::vector<Ring> rings;
    for (const auto& cell : voronoi.mesh.cells) rings.push_back(cell_ring(voronoi.mesh, cell));
    int tested = 0;
    for (const Vec2& p : random_sites(region, test::scaled(1000), 12)) {
      size_t nearest = 0;
      for (size_t i = 1; i < sites.size(); ++i) {
        if ((sites[i] - p).norm() < (sites[nearest] - p).norm()) nearest = i;
      }
      if (!sees(local, sites[nearest], p)) continue;
      INFO(shape.name << ", " << p.transpose());
      CHECK(contains(rings[nearest], p));
      ++tested;
    }
    CHECK(tested > test::least(test::scaled(300) / 2));
    if (region.is_convex()) CHECK(voronoi.joined_pieces == 0);
  }
}

TEST_CASE("lattices have their known cells", "[voronoi]") {
  // Squares: every Voronoi vertex has four sites around it, and rounds to no round-off at all.
  std::vector<Vec2> sites;
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 8; ++x) sites.emplace_back(x / 8. + 1 / 16., y / 8. + 1 / 16.);
  }
  const VoronoiMesh grid = voronoi_mesh(Polygon(square()), sites, .1);
  lawful(Polygon(square()), grid, 64, .1);
  CHECK(grid.mesh.points.size() == 81);
  CHECK(grid.short_edges.collapsed == 0);
  for (const auto& cell : grid.mesh.cells) {
    CHECK(area_moments(Polygon(cell_ring(grid.mesh, cell))).area == 1 / 64.);
  }

  // Unit squares again, with Voronoi edges through the reflex vertices and along the outline.
  std::vector<Shape> built = shapes();
  for (const Shape& shape : {built[3], built[4]}) {  // L, cross
    const Polygon region(shape.ring);
    const Ring local = region.local_vertices();
    sites.clear();
    for (double x = -2.5; x < 3; ++x) {
      for (double y = -2.5; y < 4; ++y) {
        if (contains(local, {x, y})) sites.emplace_back(x, y);
      }
    }
    REQUIRE(sites.size() == 5);
    const VoronoiMesh units = voronoi_mesh(region, sites, .1);
    lawful(region, units, 5, .1);
    CHECK(units.joined_pieces == 0);
    CHECK(units.short_edges.collapsed == 0);
    CHECK(units.mesh.points.size() == 12);
    for (size_t i = 0; i < 5; ++i) {
      const Polygon cell(cell_ring(units.mesh, units.mesh.cells[i]));
      CHECK(area_moments(cell).area == 1);
      CHECK(cell.origin() + area_moments(cell).centroid == sites[i]);
    }
  }

  // Regular hexagons of area sqrt(3)/2 a^2 and side a/sqrt(3), away from the outline.
  const double a = .1;
  sites.clear();
  for (int row = 0; row < 10; ++row) {
    for (int i = 0; i < 9; ++i) {
      sites.emplace_back(a * (i + (row % 2 ? .75 : .25)) + .05, a * std::sqrt(.75) * row + .1);
    }
  }
  const VoronoiMesh hexagons = voronoi_mesh(Polygon(square()), sites, .1);
  int regular = 0;
  for (const auto& cell : hexagons.mesh.cells) {
    const Polygon polygon(cell_ring(hexagons.mesh, cell));
    const Box box = bounding_box(polygon);
    if (box.x0 < 1e-9 || box.y0 < 1e-9 || box.x1 > 1 - 1e-9 || box.y1 > 1 - 1e-9) continue;
    if (polygon.size() != 6) continue;
    ++regular;
    CHECK(area_moments(polygon).area == Approx(std::sqrt(.75) * a * a).epsilon(1e-13));
    for (int i = 0; i < 6; ++i) {
      CHECK((polygon.after(i) - polygon[i]).norm() == Approx(a / std::sqrt(3)).epsilon(1e-12));
    }
  }
  CHECK(regular >= 7 * 8);
}

TEST_CASE("Lloyd's iteration lowers the energy and evens out the cells", "[voronoi][slow]") {
  for (const Ring& ring : {square(), Ring{{0, 0}, {9, 0}, {4, 3}}}) {
    const Polygon region(ring);
    std::vector<Vec2> sites = random_sites(region, 60, 2);
    const double start = energy(voronoi_mesh(region, sites, 0));
    double before = start;
    for (int step = 0; step < 40; ++step) {
      relax(region, sites, 1);
      const double now = energy(voronoi_mesh(region, sites, 0));
      CHECK(now < before);
      before = now;
    }
    // Not below hexagons, the best there is (Gruber 1999): 5/(18 sqrt 3) A^2 / N.
    const double area = area_moments(region).area;
    const double hexagons = 5 / (18 * std::sqrt(3)) * area * area / 60;
    CHECK(before > hexagons);
    CHECK(before < 1.1 * hexagons);
    CHECK(start > 1.4 * hexagons);
  }
  // Two cells of a square end as its halves.
  std::vector<Vec2> two = random_sites(Polygon(square()), 2, 3);
  const Relaxation relaxation = relax(Polygon(square()), two, 200);
  CHECK(relaxation.steps < 200);
  const VoronoiMesh halves = voronoi_mesh(Polygon(square()), two, .1);
  CHECK(energy(halves) == Approx(2 * (1 / 2. * (1 / 4. + 1) / 12)).epsilon(1e-4));
}

TEST_CASE("pieces that the outline cuts off join a neighbour", "[voronoi]") {
  // A U. At x = 2, the near side of the right leg, the left leg's site is the nearest from
  // y = 1.656 to y = 2.344.
  const Polygon u({{0, 0}, {3, 0}, {3, 4}, {2, 4}, {2, 1}, {1, 1}, {1, 3}, {0, 3}});
  const std::vector<Vec2> sites{{.5, 2}, {2.5, 3.8}, {1.5, .2}};
  const VoronoiMesh voronoi = voronoi_mesh(u, sites, .1);
  lawful(u, voronoi, 3, .1);
  CHECK(voronoi.joined_pieces == 1);
  for (size_t i = 0; i < 3; ++i) {
    CHECK(contains(cell_ring(voronoi.mesh, voronoi.mesh.cells[i]), sites[i]));
  }
  const Vec2 piece(2.05, 2);
  CHECK((sites[0] - piece).norm() < (sites[1] - piece).norm());
  CHECK((sites[0] - piece).norm() < (sites[2] - piece).norm());
  CHECK_FALSE(contains(cell_ring(voronoi.mesh, voronoi.mesh.cells[0]), piece));
}

TEST_CASE("regions with holes are tiled exactly", "[voronoi][holes]") {
  test::SeededRandom random(43);
  int parts = 0;
  for (int i = 0; i < test::scaled(120); ++i) {
    const Polygon region = i % 3 == 2 ? test::random_tied_with_holes(random, i / 3)
                                      : test::random_drilled(random, random.integer(1, 12));
    const int cells = std::array{1, 2, 7, 60}[random.integer(0, 3)];
    const VoronoiOptions options{
        .cells = cells, .seed = static_cast<std::uint64_t>(i), .lloyd = random.integer(0, 1) * 10};
    INFO(i << ", " << cells << " cells, " << options.lloyd << " Lloyd steps");
    const VoronoiMesh voronoi = voronoi_mesh(region, options);
    const Found found = lawful(region, voronoi, cells, .1);
    CHECK(found.area_defect < 1e-13);
    parts += static_cast<int>(voronoi.mesh.cells.size()) - cells;
    // The vertices of the region are nodes bit for bit, and the cells tile it in the world, too.
    const PolygonMesh world = in_world(region, voronoi.mesh);
    CHECK(std::equal(region.vertices().begin(), region.vertices().end(), world.points.begin()));
    CHECK(voronoi_mesh(region, options).mesh.points == voronoi.mesh.points);
    // Every point is in one cell, or in none if it lies in a hole or outside.
    const Box box = bounding_box(region);
    for (int k = 0; k < 20; ++k) {
      const Vec2 p(random.uniform(box.x0, box.x1), random.uniform(box.y0, box.y1));
      const auto holding = std::ranges::count_if(
          world.cells, [&](const auto& cell) { return contains(cell_ring(world, cell), p); });
      CHECK(holding == (side_of(region, p) > 0 ? 1 : 0));
    }
  }
  CHECK((parts > 0 || test::kSanitized));
}

TEST_CASE("a cell that goes round a hole is divided", "[voronoi][holes]") {
  const Ring hole{{.4, .4}, {.6, .4}, {.6, .6}, {.4, .6}};
  const Polygon frame(square(), {hole});
  for (const int cells : {1, 3}) {
    const VoronoiMesh one = voronoi_mesh(frame, {.cells = cells, .lloyd = 0});
    lawful(frame, one, cells, .1);
    CHECK(one.mesh.cells.size() == (cells == 1 ? 2 : one.mesh.cells.size()));
  }
  // The corner of a hole on the boundary of a cell, inside of which the rest of the hole lies.
  const Polygon touched({{0, 0}, {4, 0}, {4, 2}, {0, 2}}, {{{1, .75}, {2, 1}, {1, 1.25}}});
  const VoronoiMesh halves = voronoi_mesh(touched, {Vec2(.5, 1), Vec2(3.5, 1)}, 0);
  lawful(touched, halves, 2, 0);
  CHECK(halves.mesh.cells.size() == 3);
  // No Lloyd step leaves a site in a hole, and cells come to end at the hole: none goes round it.
  const VoronoiMesh relaxed = voronoi_mesh(frame, {.cells = 5, .seed = 2});
  lawful(frame, relaxed, 5, .1);
  CHECK(relaxed.mesh.cells.size() == 5);
  for (const Vec2& site : relaxed.sites) CHECK(side_of(frame, site) > 0);
}

TEST_CASE("the same seed gives the same bits, also far away", "[voronoi][slow]") {
  for (const Shape& shape : shapes()) {
    Ring ring = shape.ring;  // on a grid of 2^-20, so that shifts are exact
    for (Vec2& v : ring) v = (v * 0x1p20).array().round() / 0x1p20;
    const Polygon here(ring);
    const VoronoiOptions options{.cells = 25, .seed = 4, .lloyd = 10};
    const VoronoiMesh mesh = voronoi_mesh(here, options);
    const VoronoiMesh again = voronoi_mesh(here, options);
    const Polygon there = samples::shifted(here, {1e9, -1e9});
    const VoronoiMesh far = voronoi_mesh(there, options);
    INFO(shape.name);
    for (const VoronoiMesh* other : {&again, &far}) {
      CHECK(other->mesh.points == mesh.mesh.points);
      CHECK(other->mesh.cells == mesh.mesh.cells);
    }
    VoronoiOptions another = options;
    another.seed = 5;
    CHECK_FALSE(voronoi_mesh(here, another).mesh.points == mesh.mesh.points);

    const PolygonMesh world = in_world(there, far.mesh);
    CHECK(world.cells == mesh.mesh.cells);
    for (int i = 0; i < static_cast<int>(world.points.size()); ++i) {
      if (i < there.size()) CHECK(world.points[i] == there[i]);
      CHECK((world.points[i] - there.origin() - far.mesh.points[i]).cwiseAbs().maxCoeff() < 6e-8);
    }
  }
}

TEST_CASE("what cannot be meshed is refused", "[voronoi]") {
  const Polygon region(square());
  CHECK_THROWS_AS(voronoi_mesh(region, {.cells = 0}), std::invalid_argument);
  CHECK_THROWS_AS(voronoi_mesh(region, {.cells = 5, .lloyd = -1}), std::invalid_argument);
  for (const double f : {-.1, .6, std::nan("")}) {
    CHECK_THROWS_AS(voronoi_mesh(region, {.cells = 5, .shortest_edge = f}), std::invalid_argument);
  }
  for (const double f : {-.1, 1.1, std::nan("")}) {
    CHECK_THROWS_AS(voronoi_mesh(region, {.cells = 5, .smallest_angle = f}), std::invalid_argument);
  }
  const Vec2 middle(.5, .5);
  CHECK_THROWS_AS(voronoi_mesh(region, std::vector<Vec2>{}, .1), std::invalid_argument);
  CHECK_THROWS_AS(voronoi_mesh(region, {middle, middle}, .1), std::invalid_argument);
  CHECK_THROWS_AS(voronoi_mesh(region, {middle, Vec2(1, .5)}, .1), std::invalid_argument);
  CHECK_THROWS_AS(voronoi_mesh(region, {Vec2(std::nan(""), .5)}, .1), std::invalid_argument);
  // Coordinates a quarter of a metre apart have no room for a hundred cells in a square metre.
  const Polygon far = samples::shifted(region, {0x1p50, 0});
  CHECK_THROWS_AS(in_world(far, voronoi_mesh(far, {.cells = 100}).mesh), InvalidPolygon);
}

TEST_CASE("vertices that are equal as seen from vertex 0 are one", "[voronoi]") {
  // They differ by 1e-20 next to zero.
  const Polygon close({{1, 0}, {1, 1}, {1e-20, .5}, {0, .5}});
  const PolygonMesh mesh = voronoi_mesh(close, {.cells = 2}).mesh;
  double area = 0;
  for (const std::vector<int>& cell : mesh.cells) {
    area += area_moments(Polygon(cell_ring(mesh, cell))).area;
  }
  CHECK(area == Approx(.5).epsilon(1e-12));
}

TEST_CASE("every public ring can be meshed", "[voronoi]") {
  int meshed = 0;
  for (const auto& [name, line, ring] : test::public_rings(200)) {
    std::optional<Polygon> region;
    try {
      region.emplace(ring);
      Polygon(region->local_vertices());  // simple as seen from its first vertex, too
    } catch (const InvalidPolygon&) {
      continue;
    }
    INFO(name);
    lawful(*region, voronoi_mesh(*region, {.cells = 20, .lloyd = 10}), 20, .1);
    ++meshed;
  }
  WARN(meshed << " rings meshed");
}
