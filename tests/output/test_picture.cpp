// Pictures and VTK files of a polygon's potential.
#include "lib/output/picture.hpp"

#include <vtkCell.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkUnstructuredGrid.h>

#include <boost/property_tree/ptree.hpp>
#include <boost/property_tree/xml_parser.hpp>
#include <catch2/catch.hpp>
#include <numeric>
#include <sstream>

#include "geometry/potential/inscribed_circle.hpp"
#include "lib/output/axes.hpp"
#include "lib/output/files.hpp"
#include "lib/output/polygon_vtk.hpp"
#include "tests/folder.hpp"
#include "tests/pixels.hpp"
#include "tests/shapes.hpp"
#include "tests/support.hpp"
#include "tests/vtk_reader.hpp"

using namespace apothem;
using namespace apothem::test;

namespace {

// `share` of the roof height is the reference length.
std::string draw(const Polygon& polygon, double share, PictureFormat format) {
  const Skeleton skeleton = straight_skeleton(polygon);
  const double r = share * skeleton.roof_height;
  const SingularArea singular = singular_area(skeleton, r);
  const InscribedCircle circle = largest_inscribed_circle(polygon);
  return draw_potential({polygon, skeleton, circle, singular, r, "given"}, format);
}

}  // namespace

TEST_CASE("round steps", "[picture]") {
  CHECK(round_step(1, 10) == Approx(.1));
  CHECK(round_step(.7, 10) == Approx(.1));
  CHECK(round_step(1.1, 10) == Approx(.2));
  CHECK(round_step(4e-9, 10) == Approx(5e-10));
  CHECK(round_step(6e12, 10) == Approx(1e12));
}

TEST_CASE("the format follows from the file's name", "[picture]") {
  CHECK(picture_format("a.png") == PictureFormat::png);
  CHECK(picture_format("dir.svg/a.svg") == PictureFormat::svg);
  for (const char* name : {"a", "a.jpg", "a.png.bak", "svg", ""}) CHECK(!picture_format(name));
}

TEST_CASE("pictures of any polygon, in both formats, twice the same", "[picture][slow]") {
  Ring far = l_ring(), tiny = l_ring(), huge = star_ring(5, .5), sliver{{0, 0}, {1, 0}, {.3, 1e-6}};
  for (Vec2& v : far) v += Vec2(1e9, -2e9);
  for (Vec2& v : tiny) v *= 1e-9;
  for (Vec2& v : huge) v *= 1e9;
  for (const Ring& ring : {far, tiny, huge, sliver, turned(sliver, .6), cross_ring(), comb_ring(5),
                           spiral_ring(2), regular_ring(100), Ring{{0, 0}, {1e-6, .3}, {0, 1}}}) {
    const Polygon polygon(ring);
    for (const double share : {.4, 1., 3.}) {
      const std::string png = draw(polygon, share, PictureFormat::png);
      CHECK(png.starts_with("\x89PNG\r\n\x1a\n"));
      CHECK(png == draw(polygon, share, PictureFormat::png));
      const Pixels pixels = decode(png);
      CHECK(pixels.width >= 640);
      CHECK(pixels.width <= 1400);
      CHECK(pixels.height >= 400);
      CHECK(pixels.height <= 1400);
      const std::string svg = draw(polygon, share, PictureFormat::svg);
      CHECK(svg.find("nan") == std::string::npos);
      CHECK(svg.find("inf") == std::string::npos);
      std::istringstream stream(svg);
      boost::property_tree::ptree tree;
      REQUIRE_NOTHROW(boost::property_tree::read_xml(stream, tree));
      CHECK(tree.get<double>("svg.<xmlattr>.viewBox", 0) == 0);
      CHECK(tree.get_child("svg.g").size() > 30);
    }
  }
}

TEST_CASE("every band of a picture has the area of its level set", "[picture]") {
  // L with arms of width 1: {t >= d} has the area 3 - 8 d + 4 d^2. r = .4 leaves a plateau.
  const double r = .4;
  const Pixels pixels = decode(draw(Polygon(l_ring()), r / .5, PictureFormat::png));
  const auto area = [&](double phi) { return 3 - 8 * phi * r + 4 * phi * r * phi * r; };
  constexpr int kBands = 20;
  constexpr int kBar = 2 * 92;  // colour bar and its numbers, on the right
  std::vector<double> counts(kBands + 1, 0);
  for (int y = 0; y < pixels.height; ++y) {
    for (int x = 0; x < pixels.width - kBar; ++x) {
      for (int i = 0; i <= kBands; ++i) {
        counts[i] += has_colour(pixels.colours[y * pixels.width + x], viridis(1. * i / kBands));
      }
    }
  }
  const double inside = std::accumulate(counts.begin(), counts.end(), 0.);
  for (int i = 0; i <= kBands; ++i) {
    const double exact = i < kBands ? area(1. * i / kBands) - area((i + 1.) / kBands) : area(1);
    const double drawn = area(0) * counts[i] / inside;
    INFO("band " << i << ": " << drawn << " of " << exact);
    CHECK(std::abs(drawn - exact) < .025 * area(0));  // lines cover some of it
    CHECK(drawn > .4 * exact);
  }
}

TEST_CASE("VTK's own reader gets a polygon's faces and singular area back", "[output]") {
  const Folder folder;
  Ring ring = l_ring();
  std::reverse(ring.begin(), ring.end());  // clockwise: edges are counted as given
  for (Vec2& v : ring) v += Vec2(1024, -512);
  const Polygon polygon(ring);
  const Skeleton skeleton = straight_skeleton(polygon);
  const double r = .4;
  write_polygon_vtk(folder / "new/out", polygon, skeleton, singular_area(skeleton, r), r);

  const auto faces = test::read_grid(folder / "new/out/faces.vtu");
  vtkUnstructuredGrid* grid = faces->GetOutput();
  vtkDataArray* height = grid->GetPointData()->GetArray("roof_height");
  vtkDataArray* phi = grid->GetPointData()->GetArray("phi");
  REQUIRE(height);
  REQUIRE(phi);
  double below = 0, above = 0;
  for (vtkIdType c = 0; c < grid->GetNumberOfCells(); ++c) {
    vtkCell* cell = grid->GetCell(c);
    const int edge = static_cast<int>(grid->GetCellData()->GetArray("edge")->GetTuple1(c));
    const Vec2 start = ring[edge], along = (ring[(edge + 1) % 6] - start).normalized();
    double twice = 0;
    for (vtkIdType i = 0; i < cell->GetNumberOfPoints(); ++i) {
      double p[3], q[3];
      grid->GetPoint(cell->GetPointId(static_cast<int>(i)), p);
      grid->GetPoint(cell->GetPointId(static_cast<int>((i + 1) % cell->GetNumberOfPoints())), q);
      twice += apothem::cross(Vec2(p[0], p[1]) - start, Vec2(q[0], q[1]) - start);
      const double h = height->GetTuple1(cell->GetPointId(static_cast<int>(i)));
      CHECK(std::abs(std::abs(apothem::cross(along, Vec2(p[0], p[1]) - start)) - h) < 1e-12);
      CHECK(phi->GetTuple1(cell->GetPointId(static_cast<int>(i))) ==
            Approx(std::min(1., h / r)).epsilon(1e-14));
    }
    (grid->GetCellData()->GetArray("plateau")->GetTuple1(c) == 1 ? above : below) += twice / 2;
  }
  CHECK(above == Approx(3 - 8 * r + 4 * r * r).margin(1e-12));
  CHECK(above + below == Approx(3).margin(1e-12));

  const auto area = test::read_grid(folder / "new/out/singular_area.vtu");
  // An L is two convex cells.
  REQUIRE(area->GetOutput()->GetNumberOfCells() == 2);
  CHECK(area->GetOutput()->GetCellType(0) == VTK_POLYGON);
  CHECK(area->GetOutput()->GetCellType(1) == VTK_POLYGON);
  double plateau = 0;
  for (vtkIdType c = 0; c < 2; ++c) {
    vtkPoints* corners = area->GetOutput()->GetCell(c)->GetPoints();
    std::vector<Vec2> cell;
    for (vtkIdType i = 0; i < corners->GetNumberOfPoints(); ++i) {
      cell.emplace_back(corners->GetPoint(i)[0], corners->GetPoint(i)[1]);
    }
    plateau += area_moments(Polygon(cell)).area;
  }
  CHECK(plateau == Approx(3 - 8 * r + 4 * r * r).margin(1e-12));

  // A cross: its ridges as lines. Above the roof: a file without cells.
  const Polygon cross(cross_ring());
  const Skeleton roof = straight_skeleton(cross);
  write_polygon_vtk(folder / "cross", cross, roof, singular_area(roof, .5), .5);
  CHECK(test::read_grid(folder / "cross/faces.vtu")->GetOutput()->GetNumberOfCells() == 12);
  CHECK(test::read_grid(folder / "cross/singular_area.vtu")->GetOutput()->GetNumberOfCells() == 4);
  CHECK(test::read_grid(folder / "cross/singular_area.vtu")->GetOutput()->GetCellType(0) ==
        VTK_LINE);
  write_polygon_vtk(folder / "none", cross, roof, singular_area(roof, 1), 1);
  CHECK(test::read_grid(folder / "none/singular_area.vtu")->GetOutput()->GetNumberOfPoints() == 0);
}
