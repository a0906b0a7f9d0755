// Meshes that fill any polygon: triangles, quadrilaterals and Voronoi cells.
#include <numbers>

#include "geometry/meshing/delaunay_mesh.hpp"
#include "geometry/meshing/voronoi.hpp"
#include "lib/mesh/fill_mesh.hpp"
#include "lib/mesh/rectangle_mesh.hpp"
#include "lib/mesh/select.hpp"
#include "lib/mesh/smooth.hpp"
#include "tests/mesh/mesh_laws.hpp"
#include "tests/shapes.hpp"

using namespace apothem;
using namespace apothem::test;

namespace {

constexpr double kDegree = std::numbers::pi / 180;

double area_of(const Polygon& outline, const std::vector<Polygon>& holes = {}) {
  double area = area_moments(outline).area;
  for (const Polygon& hole : holes) area -= area_moments(hole).area;
  return area;
}

// Smallest angle of the triangles that have no corner at a vertex of the polygon.
double smallest_angle_inside(const Mesh& mesh, int vertices) {
  Mesh inner;
  inner.nodes = mesh.nodes;
  for (int e = 0; e < mesh.element_count(); ++e) {
    const auto corners = mesh.element(e);
    if (std::all_of(corners.begin(), corners.end(), [&](int c) { return c >= vertices; })) {
      inner.add_element(corners);
    }
  }
  return mesh_quality(inner).smallest_angle;
}

std::vector<std::string> edge_names(int n) {
  std::vector<std::string> names;
  for (int i = 0; i < n; ++i) names.push_back("edge-" + std::to_string(i));
  return names;
}

// The group's nodes lie on the segment between the points.
void check_on_segment(const Mesh& mesh, const std::string& name, const Vec2& a, const Vec2& b) {
  const MeshGroup& part = group(mesh, name);
  const auto at = [&](int node) { return mesh.nodes[node]; };
  CHECK(std::count_if(part.nodes.begin(), part.nodes.end(),
                      [&](int n) { return at(n) == a || at(n) == b; }) == 2);
  double length = 0;
  for (const auto& [p, q] : part.edges) {
    CHECK((at(q) - at(p)).dot(b - a) > 0);
    length += (at(q) - at(p)).norm();
  }
  CHECK(length == Approx((b - a).norm()).epsilon(1e-12));
}

}  // namespace

TEST_CASE("polygons filled with triangles and quadrilaterals", "[mesh]") {
  const Polygon outlines[]{samples::block(0, 0, 1, 1),
                           samples::block(0, 0, 20, .3),
                           samples::l_shape(),
                           samples::cross_of_squares(),
                           samples::star(5, .4),
                           samples::regular(64),
                           samples::comb(4),
                           samples::needle(10, .1),
                           Polygon({{0, 0}, {0, 2}, {1, 0}})};  // clockwise
  for (const Polygon& outline : outlines) {
    for (const double size : {2., .13}) {
      const Mesh triangles = fill_mesh(outline, {}, size, ElementShape::triangle);
      const Mesh quads = fill_mesh(outline, {}, size, ElementShape::quadrilateral);
      for (const Mesh* mesh : {&triangles, &quads}) {
        check_laws(*mesh, area_of(outline), 0, 1e-12);
        check_share_boundary(*mesh, {"boundary"});
        check_share_boundary(*mesh, edge_names(outline.size()));
        for (int i = 0; i < outline.size(); ++i) {
          CHECK(mesh->nodes[i] == outline[i]);
          check_on_segment(*mesh, "edge-" + std::to_string(outline.input_edge(i)), outline[i],
                           outline.after(i));
        }
      }
      CHECK(mesh_quality(triangles).quadrilaterals == 0);
      CHECK(mesh_quality(quads).triangles == 0);
      CHECK(smallest_angle_inside(triangles, outline.size()) > 20 * kDegree);
      CHECK(mesh_quality(triangles).longest_edge < 1.6 * size);
    }
  }
}

TEST_CASE("even sizes and shapes where there is room", "[mesh]") {
  const Polygon outline = samples::block(0, 0, 1, 1);
  const double size = .05;
  const MeshQuality t = mesh_quality(fill_mesh(outline, {}, size, ElementShape::triangle));
  CHECK(t.smallest_angle > 25 * kDegree);
  const double edge = std::sqrt(4 / std::sqrt(3.) * t.area / t.triangles);
  CHECK(edge == Approx(size).epsilon(.1));
  const MeshQuality q = mesh_quality(fill_mesh(outline, {}, size, ElementShape::quadrilateral));
  CHECK(q.smallest_scaled_jacobian > .6);
  CHECK(std::sqrt(q.area / q.quadrilaterals) == Approx(size).epsilon(.1));
}

TEST_CASE("a polygon is meshed as its outline and its holes are", "[mesh][holes]") {
  const std::vector<Vec2> outline{{0, 0}, {0, 4}, {6, 4}, {6, 0}};  // clockwise
  const Rings holes{{{1, 1}, {2, 1}, {2, 2}}, {{4, 1}, {4, 2}, {5, 2}}};
  for (const ElementShape shape : {ElementShape::triangle, ElementShape::quadrilateral}) {
    const Mesh whole = fill_mesh(Polygon(outline, holes), .4, shape);
    const Mesh parts =
        fill_mesh(Polygon(outline), {Polygon(holes[0]), Polygon(holes[1])}, .4, shape);
    CHECK(whole.nodes == parts.nodes);
    CHECK(whole.corners == parts.corners);
    REQUIRE(whole.groups.size() == parts.groups.size());
    for (size_t i = 0; i < whole.groups.size(); ++i) {
      CHECK(whole.groups[i].name == parts.groups[i].name);
      CHECK(whole.groups[i].nodes == parts.groups[i].nodes);
    }
    check_laws(whole, 23, 2, 1e-12);
  }
}

TEST_CASE("polygons with holes", "[mesh]") {
  const Polygon outline = samples::block(0, 0, 4, 3);
  const std::vector<Polygon> holes{samples::shifted(samples::regular(12), {1.2, 1.5}),
                                   Polygon({{3, 1}, {3, 2}, {3.5, 2}})};
  for (const ElementShape shape : {ElementShape::triangle, ElementShape::quadrilateral}) {
    const Mesh mesh = fill_mesh(outline, holes, .2, shape);
    check_laws(mesh, area_of(outline, holes), 2, 1e-12);
    std::vector<std::string> names = edge_names(4);
    names.insert(names.end(), {"hole-0", "hole-1"});
    check_share_boundary(mesh, names);
    check_share_boundary(mesh, {"boundary"});
    for (int i = 0; i < 12; ++i) CHECK(mesh.nodes[4 + i] == holes[0][i]);
    for (const int node : group(mesh, "hole-0").nodes) {
      CHECK((mesh.nodes[node] - Vec2(1.2, 1.5)).norm() < 1 + 1e-12);
    }
  }
}

TEST_CASE("regions that cannot be filled are refused", "[mesh]") {
  const Polygon outline = samples::block(0, 0, 4, 4);
  const auto fill = [&](const std::vector<Polygon>& holes, double size = 1) {
    return fill_mesh(outline, holes, size, ElementShape::triangle);
  };
  using Catch::Contains;
  CHECK_THROWS_WITH(fill({samples::block(3, 3, 5, 5)}), Contains("hole 0 meets the outline"));
  CHECK_THROWS_WITH(fill({samples::block(5, 5, 6, 6)}), Contains("hole 0 lies outside"));
  CHECK_THROWS_WITH(fill({samples::block(1, 1, 2, 2), samples::block(2, 2, 3, 3)}),
                    Contains("hole 1 meets hole 0"));
  CHECK_THROWS_WITH(fill({samples::block(1, 1, 3, 3), samples::block(1.5, 1.5, 2, 2)}),
                    Contains("hole 1 lies inside hole 0"));
  // Two vertices that agree as seen from vertex 0, and a slit of hardly any width.
  const Polygon close({{.1, 0}, {40, 10}, {40, std::nextafter(10, 11)}, {30, 30}});
  CHECK_THROWS_WITH(fill_mesh(close, {}, 5, ElementShape::triangle),
                    Contains("nearer than 1e-9 of the size"));
  const Polygon slit({{0, 0}, {4, 0}, {4, 4}, {2, 4}, {2, 1}, {2 - 1e-10, 4}, {0, 4}});
  CHECK_THROWS_WITH(fill_mesh(slit, {}, 1, ElementShape::triangle),
                    Contains("simplify the polygon"));
  for (const double size : {0., -1., std::nan(""), 1e-5}) {
    CHECK_THROWS_AS(fill({}, size), std::invalid_argument);
  }
}

TEST_CASE("a filled polygon far from the origin", "[mesh]") {
  const Vec2 far(1 << 20, 3 << 20);
  const Polygon outline = samples::l_shape();
  const Mesh here = fill_mesh(outline, {}, .25, ElementShape::quadrilateral);
  const Mesh there =
      fill_mesh(samples::shifted(outline, far), {}, .25, ElementShape::quadrilateral);
  CHECK(here.corners == there.corners);
  for (size_t i = 0; i < here.nodes.size(); ++i) {
    CHECK((here.nodes[i] + far - there.nodes[i]).norm() < 1e-9);
  }
}

TEST_CASE("Voronoi cells as elements", "[mesh]") {
  for (const Polygon& region :
       {samples::block(0, 0, 3, 1), samples::star(5, .4), Polygon({{0, 0}, {0, 2}, {1, 0}})}) {
    const VoronoiMesh voronoi = voronoi_mesh(region, {.cells = 40});
    const Mesh mesh = mesh_of_cells(region, in_world(region, voronoi.mesh));
    check_laws(mesh, area_of(region), 0, 1e-12);
    CHECK(mesh.element_count() == 40);
    check_share_boundary(mesh, edge_names(region.size()));
    for (int i = 0; i < region.size(); ++i) {
      check_on_segment(mesh, "edge-" + std::to_string(region.input_edge(i)), region[i],
                       region.after(i));
    }
    const PolygonMesh cells = cells_of_mesh(mesh);
    CHECK(cells.cells == voronoi.mesh.cells);
    CHECK(cells.points == in_world(region, voronoi.mesh).points);
  }
}

TEST_CASE("smoothing makes the worst corner better and leaves the boundary", "[mesh]") {
  samples::Random random(3);
  const Mesh regular = rectangle_mesh({1, 1}, {8, 8}, {0, 0}, ElementShape::quadrilateral);
  Mesh mesh = regular;
  const std::vector<int> inner = nodes_where(mesh, {.box = Box{.1, .1, .9, .9}});
  for (const int node : inner) {
    mesh.nodes[node] += .05 * Vec2(random.uniform(-1, 1), random.uniform(-1, 1));
  }
  const Mesh rough = mesh;
  smooth_nodes(mesh, 50);
  check_laws(mesh, 1);
  CHECK(mesh_quality(mesh).smallest_scaled_jacobian >
        mesh_quality(rough).smallest_scaled_jacobian + .1);
  for (const MeshEdge& edge : boundary_edges(mesh)) {
    for (const int node : edge.nodes) CHECK(mesh.nodes[node] == regular.nodes[node]);
  }
  Mesh still = regular;
  smooth_nodes(still, 5);
  for (size_t i = 0; i < still.nodes.size(); ++i) {
    CHECK((still.nodes[i] - regular.nodes[i]).norm() < 1e-12);
  }
}
