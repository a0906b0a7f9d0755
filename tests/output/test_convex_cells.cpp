// Bodies that are not convex in the files for ParaView: filled as a viewer fills cells, and
// compared pixel by pixel with the exact shapes.
#include "lib/output/convex_cells.hpp"

#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkIdList.h>
#include <vtkNew.h>
#include <vtkUnstructuredGrid.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <numeric>

#include "geometry/polygon/convex_parts.hpp"
#include "geometry/polygon/predicates.hpp"
#include "lib/output/frames.hpp"
#include "lib/output/polygon_vtk.hpp"
#include "lib/output/run_folder.hpp"
#include "tests/contact/bodies.hpp"
#include "tests/folder.hpp"
#include "tests/shapes.hpp"
#include "tests/vtk_reader.hpp"

using namespace apothem;
using namespace apothem::test;

namespace {

using Cells = std::vector<std::vector<int>>;

const Ring kU{{-1, -1}, {2, -1}, {2, 2}, {1, 2}, {1, 0}, {0, 0}, {0, 2}, {-1, 2}};

// As OpenGL viewers fill a polygon: the triangles between its first corner and each further edge.
bool in_fan(const Ring& cell, const Vec2& p) {
  for (size_t i = 1; i + 1 < cell.size(); ++i) {
    const double a = cross(cell[i] - cell[0], p - cell[0]);
    const double b = cross(cell[i + 1] - cell[i], p - cell[i]);
    const double c = cross(cell[0] - cell[i + 1], p - cell[i + 1]);
    if ((a >= 0 && b >= 0 && c >= 0) || (a <= 0 && b <= 0 && c <= 0)) return true;
  }
  return false;
}

// Pixels of a picture in which the cells and the shape differ, among those that are not on its
// boundary to round-off.
int wrong_pixels(const std::vector<Ring>& cells, const Ring& shape) {
  constexpr int kPixels = 150;
  Box box;
  for (const Vec2& v : shape) box.include(v.x(), v.y());
  const double size = 1.1 * box.extent();
  int wrong = 0;
  for (int i = 0; i < kPixels; ++i) {
    for (int k = 0; k < kPixels; ++k) {
      const Vec2 p(box.x0 - .05 * size + size * (i + .4931) / kPixels,
                   box.y0 - .05 * size + size * (k + .5077) / kPixels);
      const bool filled = std::any_of(cells.begin(), cells.end(),
                                      [&](const Ring& cell) { return in_fan(cell, p); });
      wrong += filled != strictly_inside(shape, p);
    }
  }
  return wrong;
}

std::vector<Ring> places(const Cells& cells, const Ring& ring) {
  std::vector<Ring> result;
  for (const std::vector<int>& cell : cells) {
    Ring& corners = result.emplace_back();
    for (const int i : cell) corners.push_back(ring[i]);
  }
  return result;
}

// A ring from its smallest number on.
std::vector<int> from_smallest(std::vector<int> ring) {
  std::rotate(ring.begin(), std::min_element(ring.begin(), ring.end()), ring.end());
  return ring;
}

// The places of the cells of a body.
std::vector<Ring> cells_of(vtkUnstructuredGrid* grid, BodyIndex body) {
  std::vector<Ring> result;
  vtkNew<vtkIdList> nodes;
  for (vtkIdType c = 0; c < grid->GetNumberOfCells(); ++c) {
    if (grid->GetCellData()->GetArray("body")->GetTuple1(c) != body) continue;
    grid->GetCellPoints(c, nodes);
    Ring& ring = result.emplace_back();
    for (vtkIdType i = 0; i < nodes->GetNumberOfIds(); ++i) {
      const double* p = grid->GetPoint(nodes->GetId(i));
      ring.emplace_back(p[0], p[1]);
    }
  }
  return result;
}

}  // namespace

TEST_CASE("convex parts tile a polygon, and there are few of them", "[convex]") {
  test::SeededRandom random(1207);
  for (int i = 0; i < scaled(300); ++i) {
    const Polygon polygon = random_polygon(random, random.integer(4, 40));
    const Cells parts = convex_parts(polygon);
    int reflex = 0;
    for (int v = 0; v < polygon.size(); ++v) {
      const Vec2& before = polygon[v == 0 ? polygon.size() - 1 : v - 1];
      reflex += orientation(before, polygon[v], polygon.after(v)) < 0;
    }
    CHECK(static_cast<int>(parts.size()) <= 1 + 2 * reflex);
    double area = 0;
    for (const Ring& part : places(parts, polygon.vertices())) {
      const Polygon convex(part);
      CHECK(convex.is_convex());
      CHECK(convex[1] == part[1]);  // counter-clockwise as given
      area += area_moments(convex).area;
    }
    CHECK(area == Approx(area_moments(polygon).area).epsilon(1e-12));
  }
  CHECK(convex_parts(Polygon(kU)).size() == 3);
  CHECK(convex_parts(quad_q()) == Cells{{0, 1, 2, 3}});
}

TEST_CASE("a viewer fills the cells of a polygon as the polygon is", "[output][convex]") {
  Cells whole{{0, 1, 2, 3, 4, 5, 6, 7}};
  CHECK(wrong_pixels(places(whole, kU), kU) > 1000);  // what a viewer makes of it in one piece
  CHECK(wrong_pixels(places(convex_cells(kU), kU), kU) == 0);
  samples::Random random(1208);
  for (const Ring& ring :
       {cross_ring(), comb_ring(6), star_ring(7, .3), spiral_ring(3), regular_ring(9),
        random_polygon(random, 20).vertices(), random_polygon(random, 60).vertices()}) {
    const Cells cells = convex_cells(ring);
    CHECK(wrong_pixels(places(cells, ring), ring) == 0);
    std::vector<int> all(ring.size());
    std::iota(all.begin(), all.end(), 0);
    CHECK(from_smallest(joined(cells)) == all);
  }
  // Round-off in a straight side is no reason to divide, and nothing simple is left to divide here.
  CHECK(convex_cells(Ring{{0, 0}, {1, 1e-13}, {2, 0}, {1, 1}}).size() == 1);
  CHECK(convex_cells(Ring{{0, 0}, {1, 1}, {1, 0}, {0, 1}}) == Cells{{0, 1, 2, 3}});
}

TEST_CASE("frames show bodies and elements that are not convex as they are", "[output][convex]") {
  const Folder folder;
  Model model;
  model.origin = {16, -8};
  model.materials = {{"rock", 2000, {ElasticLaw::st_venant_kirchhoff, Plane::strain, 1e9, .25}}};
  RigidBody u, quad;
  set_shape(u, samples::shifted(Polygon(kU), model.origin), model);
  set_shape(quad, samples::shifted(quad_q(), model.origin + Vec2(.2, .3)), model);
  model.bodies = {u, quad};
  DeformableBody l;  // one element that is not convex, and one that becomes so
  l.mesh.nodes = {{5, 0}, {7, 0}, {7, 1}, {6, 1}, {6, 2}, {5, 2}, {8, 0}, {8, 1}};
  l.mesh.add_element(std::vector<int>{0, 1, 2, 3, 4, 5});
  l.mesh.add_element(std::vector<int>{1, 6, 7, 2});
  model.deformables = {l};
  State state(Layout{2, model.node_count()});
  for (int i = 0; i < 2; ++i) state.pose(i) << model.bodies[i].position, .7 * i + .4;
  state.node(7) = Vec2(-.7, -.6);
  FrameWriter frames(folder.path(), model);
  frames.write({.state = state,
                .stresses = {{1, 2, 3, 4}, {5, 6, 7, 8}},
                .forces = std::vector<BodyForce>(3),
                .node_mass = std::vector<double>(8, 1)});

  const auto bodies = test::read_grid(folder / "frames/bodies_000000.vtu");
  vtkUnstructuredGrid* grid = bodies->GetOutput();
  const auto shape_of = [&](RigidIndex i) {
    Ring ring;
    const auto pose = state.pose(i);
    for (const Vec2& v : model.bodies[i].potential.vertices) {
      ring.emplace_back(model.origin + Vec2(pose.head<2>()) + samples::turned(v, pose[2]));
    }
    return ring;
  };
  for (const RigidIndex i : {0, 1}) {
    CHECK(wrong_pixels(cells_of(grid, i), shape_of(i)) == 0);
  }
  CHECK(cells_of(grid, 0).size() == 3);
  CHECK(cells_of(grid, 1).size() == 1);
  Ring outline;
  for (const int n : {0, 1, 6, 7, 2, 3, 4, 5}) {
    outline.emplace_back(model.origin + l.mesh.nodes[n] + Vec2(state.node(n)));
  }
  CHECK(wrong_pixels(cells_of(grid, 2), outline) == 0);
  // Values repeat, and `part` numbers the cells of a body or an element.
  const auto column = [&](const char* name) {
    std::vector<int> values;
    for (vtkIdType c = 0; c < grid->GetNumberOfCells(); ++c) {
      values.push_back(static_cast<int>(grid->GetCellData()->GetArray(name)->GetTuple1(c)));
    }
    return values;
  };
  const auto parts_of_l = static_cast<int>(
      convex_cells(Ring{outline[0], outline[1], outline[4], outline[5], outline[6], outline[7]})
          .size());
  std::vector<int> part, body, stress;
  for (const auto& [count, of, zz] :
       {std::tuple(3, 0, 0), {1, 1, 0}, {parts_of_l, 2, 4}, {2, 2, 8}}) {
    for (int i = 0; i < count; ++i) {
      part.push_back(i), body.push_back(of), stress.push_back(zz);
    }
  }
  CHECK(parts_of_l > 1);
  CHECK(column("part") == part);
  CHECK(column("body") == body);
  CHECK(column("stress_zz") == stress);

  // Read back, a body or an element is one cell again.
  const Frame frame = read_frame(folder.path(), 0, 1);
  REQUIRE(frame.mesh.element_count() == 4);
  CHECK(frame.body == std::vector<int>{0, 1, 2, 2});
  CHECK(frame.mesh.element(0).size() == 8);
  const std::span<const int> corners = frame.mesh.element(2);
  CHECK(from_smallest({corners.begin(), corners.end()}) ==
        std::vector<int>{12, 13, 14, 15, 16, 17});
  CHECK(frame.stress[3].zz == 8);

  // The outlines are closed lines around the bodies, edge by edge.
  const auto lines = test::read_grid(folder / "frames/outlines_000000.vtu");
  REQUIRE(lines->GetOutput()->GetNumberOfCells() ==
          static_cast<int>(shape_of(0).size() + shape_of(1).size() + outline.size()));
  CHECK(lines->GetOutput()->GetCellType(0) == VTK_LINE);
  for (const auto& [number, shape] :
       {std::pair<int, Ring>(0, shape_of(0)), {1, shape_of(1)}, {2, outline}}) {
    const std::vector<Ring> edges = cells_of(lines->GetOutput(), number);
    REQUIRE(edges.size() == shape.size());
    for (size_t i = 0; i < shape.size(); ++i) {
      REQUIRE(edges[i].size() == 2);
      CHECK((edges[i][0] - shape[i]).norm() < 1e-14);
      CHECK(edges[i][1] == edges[(i + 1) % shape.size()][0]);
    }
  }
  CHECK(std::filesystem::exists(folder / "outlines.pvd"));
}

TEST_CASE("cells of a tiling that are not convex are divided", "[output][convex]") {
  const Folder folder;
  const PolygonMesh mesh{{{0, 0}, {2, 0}, {2, 2}, {1, 2}, {1, 1}, {0, 1}, {0, 2}},
                         {{0, 1, 2, 3, 4, 5}, {5, 4, 3, 6}}};
  write_mesh(folder / "mesh.vtu", mesh);
  const auto reader = test::read_grid(folder / "mesh.vtu");
  vtkUnstructuredGrid* grid = reader->GetOutput();
  REQUIRE(grid->GetNumberOfCells() == 3);
  const std::vector<std::array<double, 3>> expected{{0, 0, 3}, {0, 1, 3}, {1, 0, 1}};
  for (int c = 0; c < 3; ++c) {
    CHECK(grid->GetCellData()->GetArray("cell")->GetTuple1(c) == expected[c][0]);
    CHECK(grid->GetCellData()->GetArray("part")->GetTuple1(c) == expected[c][1]);
    CHECK(grid->GetCellData()->GetArray("area")->GetTuple1(c) == expected[c][2]);
  }
}
