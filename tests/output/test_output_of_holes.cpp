// Bodies with holes in what is written and drawn: frames, outlines, pictures, the player, shapes.
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkIdList.h>
#include <vtkUnstructuredGrid.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "geometry/polygon/predicates.hpp"
#include "geometry/polygon/ring_moments.hpp"
#include "lib/output/convex_cells.hpp"
#include "lib/output/field_picture.hpp"
#include "lib/output/field_raster.hpp"
#include "lib/output/frames.hpp"
#include "lib/output/run_folder.hpp"
#include "lib/output/run_picture.hpp"
#include "lib/player/shapes.hpp"
#include "tests/folder.hpp"
#include "tests/pixels.hpp"
#include "tests/shapes.hpp"
#include "tests/vtk_reader.hpp"

using namespace apothem;
using namespace apothem::test;

namespace holed_output {
namespace {

// A plate with a window of more corners than the plate, and a slot.
Polygon plate() {
  return {{{0, 0}, {6, 0}, {6, 4}, {0, 4}},
          {{{1, 1}, {2, 1}, {3, 2}, {3, 3}, {1, 3}}, {{4, 1}, {5, 1}, {5, 3}, {4.5, 3}, {4, 2}}}};
}

// A body whose contact potential is not needed.
RigidBody body_of(const Polygon& polygon, const Model& model) {
  Potential potential;
  potential.vertices = polygon.local_vertices();
  if (polygon.links()) potential.links = *polygon.links();
  RigidBody body;
  set_shape(body, polygon, std::move(potential), model);
  return body;
}

// The plate, turned and moved, beside a square.
struct Written {
  Written() {
    model.origin = {16, -8};
    model.materials = {{"rock", 2000}};
    model.bodies = {body_of(plate(), model),
                    body_of(Polygon({{8, 0}, {9, 0}, {9, 1}, {8, 1}}), model)};
    model.bodies[0].name = "plate";
    model.bodies[1].name = "square";
    state.pose(0) << model.bodies[0].position + Vec2(.5, .25), .3;
    state.pose(1) << model.bodies[1].position, 0;
    FrameWriter frames(folder.path(), model);
    frames.write({.state = state, .stresses = {}, .forces = std::vector<BodyForce>(2)});
  }
  // The plate where it is in the frame.
  [[nodiscard]] Polygon there() const {
    Rings rings = model.bodies[0].rings();
    const auto pose = state.pose(0);
    for (auto& ring : rings) {
      for (Vec2& v : ring) {
        v = model.origin + Vec2(pose.head<2>()) + samples::turned(v, pose[2]);
      }
    }
    return Polygon(polygon_of_rings(rings));
  }
  Folder folder;
  Model model;
  State state{Layout{2, 0}};
};

// The corners of the cells of a body.
std::vector<Ring> cells_of(vtkUnstructuredGrid* grid, int body) {
  std::vector<Ring> cells;
  vtkNew<vtkIdList> nodes;
  for (vtkIdType c = 0; c < grid->GetNumberOfCells(); ++c) {
    if (grid->GetCellData()->GetArray("body")->GetTuple1(c) != body) continue;
    grid->GetCellPoints(c, nodes);
    Ring& ring = cells.emplace_back();
    for (vtkIdType i = 0; i < nodes->GetNumberOfIds(); ++i) {
      const double* p = grid->GetPoint(nodes->GetId(i));
      ring.emplace_back(p[0], p[1]);
    }
  }
  return cells;
}

}  // namespace

TEST_CASE("a body with holes is convex cells in frames, and its outlines are complete",
          "[output][holes]") {
  const Written written;
  const Polygon there = written.there();
  const auto bodies = read_grid(written.folder / "frames/bodies_000000.vtu");
  const std::vector<Ring> cells = cells_of(bodies->GetOutput(), 0);
  CHECK(cells.size() > 3);
  double area = 0;
  for (const Ring& cell : cells) {
    CHECK(convex_cells(cell).size() == 1);
    area += ring_area(cell);
    CHECK(side_of(there, Vec2((cell[0] + cell[1] + cell[2]) / 3)) > 0);
  }
  CHECK(area == Approx(area_moments(plate()).area).epsilon(1e-14));
  CHECK(cells_of(bodies->GetOutput(), 1).size() == 1);

  const auto outlines = read_grid(written.folder / "frames/outlines_000000.vtu");
  const std::vector<Ring> lines = cells_of(outlines->GetOutput(), 0);
  REQUIRE(lines.size() == 14);
  for (int i = 0; i < there.size(); ++i) {
    CHECK((lines[i][0] - there[i]).norm() < 1e-14);
    CHECK((lines[i][1] - there.after(i)).norm() < 1e-14);
  }
  CHECK(outlines->GetOutput()->GetNumberOfCells() == 18);
}

TEST_CASE("frames are read back with the holes", "[results][holes]") {
  const Written written;
  const Frame frame = RunFolder(written.folder.path()).frame(0);
  REQUIRE(frame.mesh.element_count() == 2);
  CHECK(frame.mesh.element(0).size() == 4);  // the outer ring, although the holes are longer
  REQUIRE(frame.holes.size() == 1);
  REQUIRE(frame.holes.at(0).size() == 2);
  const Rings rings = rings_of(frame.position, frame.mesh.element(0), frame.holes, 0);
  const Polygon read(polygon_of_rings(rings));
  const Polygon there = written.there();
  CHECK(read.size() == there.size());
  CHECK(area_moments(read).area == Approx(area_moments(there).area).epsilon(1e-14));
  for (const Vec2& v : there.vertices()) {
    CHECK(std::ranges::any_of(read.vertices(),
                              [&](const Vec2& p) { return (p - v).norm() < 1e-14; }));
  }
  for (const std::vector<Vec2>& ring : rings) CHECK((ring_area(ring) > 0) == (&ring == &rings[0]));
  CHECK(rings_of(frame.position, frame.mesh.element(1), frame.holes, 1).size() == 1);
}

TEST_CASE("pictures of bodies leave their holes open", "[picture][holes]") {
  const Written written;
  const Polygon there = written.there();
  const RunFolder run(written.folder.path());
  for (const char* quantity : {"speed", "material"}) {
    INFO(quantity);
    const Field field = field_of(run.frame(0), *field_quantity(quantity));
    const Box window = box_of(field.mesh.nodes).grown(.5);
    constexpr int kWide = 300, kHigh = 200;
    const Colour colour{.2, .4, .6};
    const std::vector<Colour> pixels = paint(
        field, window, [&](double) { return colour; }, kWide, kHigh);
    int wrong = 0, filled = 0;
    for (int row = 0; row < kHigh; ++row) {
      for (int column = 0; column < kWide; ++column) {
        const Vec2 p(window.x0 + (column + .5) / kWide * (window.x1 - window.x0),
                     window.y1 - (row + .5) / kHigh * (window.y1 - window.y0));
        const bool inside = side_of(there, p) > 0 || (p - Vec2(8.5, .5)).cwiseAbs().maxCoeff() < .5;
        const bool painted = pixels[static_cast<size_t>(row) * kWide + column].alpha > 0;
        wrong += painted != inside;
        filled += painted;
      }
    }
    CHECK(wrong == 0);
    CHECK(filled > 10000);
  }
  // The whole picture, where displacements are magnified: the holes go with their body.
  RunPicture choice;
  choice.frames = {0};
  choice.deformation = 3;
  const FieldFigure figure = picture_of(run, choice);
  const Field& far = figure.panels[0].fields[0].field;
  const Rings rings = rings_of(far.mesh.nodes, far.mesh.element(0), far.holes, 0);
  const Polygon moved(polygon_of_rings(rings));
  CHECK(area_moments(moved).area == Approx(area_moments(plate()).area).epsilon(1e-13));
  CHECK(decode(draw_fields(figure, PictureFormat::png)).width > 100);
}

TEST_CASE("the player has the rings of bodies with holes", "[player][holes]") {
  const Written written;
  const Shapes shapes = read_shapes(RunFolder(written.folder.path()));
  const Shapes::Body& body = shapes.bodies[0];
  CHECK(body.ring.size() == 14);
  CHECK(body.holes == std::vector<int>{4, 9});
  const AreaMoments moments = area_moments(plate());
  CHECK(body.area == Approx(moments.area).epsilon(1e-14));
  double area = 0;
  Vec2 first = Vec2::Zero();
  for (const auto& [i, j, k] : body.triangles) {
    const Ring triangle{body.ring[i], body.ring[j], body.ring[k]};
    area += ring_area(triangle);
    first += ring_area(triangle) * (triangle[0] + triangle[1] + triangle[2]) / 3;
  }
  CHECK(area == Approx(moments.area).epsilon(1e-14));
  CHECK(first.norm() < 1e-12);  // about the centroid of what is left of the plate
  CHECK(shapes.bodies[1].holes.empty());
}

TEST_CASE("cells of rings that touch cover them as well", "[output][holes]") {
  // The hole has a corner on a side of the outline, as offsets have them.
  const Rings touching{{{0, 0}, {2, 0}, {4, 0}, {4, 4}, {0, 4}}, {{2, 0}, {1, 2}, {3, 2}}};
  double area = 0;
  std::vector<Vec2> corners = touching[0];
  corners.insert(corners.end(), touching[1].begin(), touching[1].end());
  for (const std::vector<int>& cell : convex_cells(touching)) {
    Ring ring;
    for (const int i : cell) ring.push_back(corners[i]);
    area += ring_area(ring);
  }
  CHECK(area == 14);
  // The rings around the cells of a polygon are its rings.
  const std::vector<std::vector<int>> rings = rings_around(convex_cells(rings_of(plate())));
  CHECK(rings.size() == 3);
}

TEST_CASE("filled rings leave open what is in an even number of them", "[picture][holes]") {
  Canvas canvas(PictureFormat::png, 40, 40);
  canvas.fill_even_odd(
      {{{5, 5}, {35, 5}, {35, 35}, {5, 35}}, {{15, 15}, {25, 15}, {25, 25}, {15, 25}}}, {1, 0, 0});
  const Pixels pixels = decode(canvas.finish());
  const int per_point = pixels.width / 40;
  CHECK((pixels.at(10 * per_point, 20 * per_point) & 0xffffff) == 0xff0000);
  CHECK((pixels.at(20 * per_point, 20 * per_point) & 0xffffff) == 0xffffff);
  CHECK((pixels.at(2 * per_point, 2 * per_point) & 0xffffff) == 0xffffff);
}

}  // namespace holed_output
