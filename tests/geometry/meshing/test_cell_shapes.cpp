// Better shapes of cells: no reflex corners, no small angles.
#include "geometry/meshing/cell_shapes.hpp"

#include <catch2/catch.hpp>
#include <numbers>

#include "geometry/meshing/voronoi.hpp"
#include "tests/geometry/skeleton/holed_polygons.hpp"

using namespace apothem;

namespace {

constexpr double kDegree = std::numbers::pi / 180;

// Interior angles of all cells, ascending, rad.
std::vector<double> angles(const PolygonMesh& mesh) {
  std::vector<double> result;
  for (const std::vector<int>& cell : mesh.cells) {
    const std::vector<Vec2> ring = cell_ring(mesh, cell);
    for (size_t i = 0; i < ring.size(); ++i) {
      const Vec2 in = ring[i] - before(ring, i), out = after(ring, i) - ring[i];
      const double turn = std::atan2(cross(in, out), in.dot(out));
      result.push_back(std::numbers::pi - turn);
    }
  }
  std::ranges::sort(result);
  return result;
}

double area(const PolygonMesh& mesh) {
  double sum = 0;
  for (const std::vector<int>& cell : mesh.cells) sum += ring_area(cell_ring(mesh, cell));
  return sum;
}

}  // namespace

TEST_CASE("cells are cut at reflex corners where the angles are largest", "[cell_shapes]") {
  // An L. A cut from its reflex corner to a node in the middle of an outer side leaves right
  // angles; one to the corner between these sides would leave angles of 45 degrees.
  PolygonMesh mesh{{{0, 0}, {1, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}, {0, 1}},
                   {{0, 1, 2, 3, 4, 5, 6, 7}}};
  CHECK(cut_at_reflex_corners(mesh) == 1);
  CHECK(area(mesh) == 3);
  CHECK(angles(mesh).front() == Approx(90 * kDegree));
  CHECK(tiling_boundary(mesh).front().size() == 8);
  CHECK(cut_at_reflex_corners(mesh) == 0);
}

TEST_CASE("corners that rounding makes reflex are straight", "[cell_shapes]") {
  PolygonMesh mesh{{{0, 0}, {1, 1e-12}, {2, 0}, {2, 1}, {0, 1}}, {{0, 1, 2, 3, 4}}};
  CHECK(cut_at_reflex_corners(mesh) == 0);
  mesh.points[1].y() = 1e-6;
  CHECK(cut_at_reflex_corners(mesh) == 1);
}

TEST_CASE("nodes move to open small angles", "[cell_shapes]") {
  // A square in four cells about a node near a corner, and in two about a node on a side.
  PolygonMesh inside{{{0, 0}, {1, 0}, {1, 1}, {0, 1}, {.1, .02}},
                     {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}}};
  const std::vector<int> fixed(4, kNowhere);
  std::vector<int> freedom = fixed;
  freedom.push_back(kAnywhere);
  CHECK(open_small_angles(inside, freedom, 40 * kDegree, 0) > 0);
  CHECK(angles(inside).front() > 40 * kDegree);
  CHECK(area(inside) == Approx(1));
  CHECK(open_small_angles(inside, freedom, 40 * kDegree, 0) == 0);

  PolygonMesh side{{{0, 0}, {1, 0}, {1, 1}, {0, 1}, {.95, 0}}, {{0, 4, 2, 3}, {4, 1, 2}}};
  freedom.back() = 0;
  CHECK(open_small_angles(side, freedom, 30 * kDegree, 0) > 0);
  CHECK(angles(side).front() > 29.9 * kDegree);
  CHECK(side.points[4].y() == 0);
}

TEST_CASE("cells of random regions become convex, and their angles no smaller", "[cell_shapes]") {
  test::SeededRandom random(17);
  int opened = 0;
  for (int i = 0; i < test::scaled(60); ++i) {
    const Polygon region = test::random_drilled(random, random.integer(1, 6));
    VoronoiOptions options{.cells = random.integer(1, 40), .lloyd = random.integer(0, 5)};
    const VoronoiMesh plain = voronoi_mesh(region, options);
    options.smallest_angle = 30 * kDegree;
    const VoronoiMesh opener = voronoi_mesh(region, options);
    CHECK(opener.mesh.cells == plain.mesh.cells);
    CHECK_NOTHROW(in_world(region, opener.mesh));
    const double before = angles(plain.mesh).front();
    const double now = angles(opener.mesh).front();
    CHECK(now > std::min(before, 30 * kDegree) - 1e-6);
    opened += now > before;
    CHECK(area(opener.mesh) == Approx(area_moments(region).area).epsilon(1e-12));

    options.convex = true;
    const VoronoiMesh convex = voronoi_mesh(region, options);
    CHECK(convex.mesh.cells.size() == plain.mesh.cells.size() + convex.cuts);
    CHECK(angles(convex.mesh).back() < std::numbers::pi + 1e-8);
    CHECK(area(convex.mesh) == Approx(area_moments(region).area).epsilon(1e-12));
    CHECK_NOTHROW(in_world(region, convex.mesh));
  }
  CHECK((opened > 0 || test::kSanitized));
}
