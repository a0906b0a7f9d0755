// Pictures and plots of the results of a run.
#include "lib/output/run_picture.hpp"

#include <boost/property_tree/ptree.hpp>
#include <boost/property_tree/xml_parser.hpp>
#include <catch2/catch.hpp>
#include <filesystem>
#include <sstream>

#include "lib/output/canvas.hpp"
#include "lib/output/field_layout.hpp"
#include "lib/output/run_plot.hpp"
#include "tests/folder.hpp"
#include "tests/output/run_results.hpp"
#include "tests/pixels.hpp"
#include "tests/support.hpp"

using namespace apothem;
using namespace apothem::test;

namespace {

const Colour kOfFixed{.78, .78, .78}, kOfChains{.1, .1, .1};

int pixels_of(const Pixels& pixels, const Colour& colour) {
  return static_cast<int>(
      std::count_if(pixels.colours.begin(), pixels.colours.end(),
                    [&](std::uint32_t pixel) { return has_colour(pixel, colour); }));
}

Pixels drawn(const RunFolder& run, const RunPicture& choice) {
  return decode(draw_fields(picture_of(run, choice), PictureFormat::png));
}

void require_xml(const std::string& svg) {
  boost::property_tree::ptree tree;
  std::istringstream stream(svg);
  REQUIRE_NOTHROW(boost::property_tree::read_xml(stream, tree));
  CHECK(tree.get_child("svg.g").size() > 10);
}

// The extent of some nodes along x and y.
Vec2 extent(const Field& field, size_t from, size_t until) {
  Box box;
  for (size_t i = from; i < until; ++i) {
    box.include(field.mesh.nodes[i].x(), field.mesh.nodes[i].y());
  }
  return {box.x1 - box.x0, box.y1 - box.y0};
}

}  // namespace

TEST_CASE("what is drawn without a choice", "[results]") {
  const Folder folder;
  write_results(folder / "meshed", model_of_results(true), 2);
  write_results(folder / "rigid/", model_of_results(false), 2);
  const RunFolder meshed(folder / "meshed"), rigid(folder / "rigid/");
  const FieldFigure stress = picture_of(meshed, {strip(meshed, 1)});
  CHECK(stress.title == "meshed");
  CHECK(stress.panels[0].quantity->name == std::string("von_mises"));
  REQUIRE(stress.panels[0].fields.size() == 1);
  CHECK(stress.panels[0].fields[0].label == "t = 1 s");
  const FieldFigure speed = picture_of(rigid, {strip(rigid, 1)});
  CHECK(speed.title == "rigid");
  CHECK(speed.panels[0].quantity->name == std::string("speed"));
  CHECK(speed.panels[0].unit == "mm/s");  // at most .25 m/s and a bit
  RunPicture chains{strip(rigid, 1)};
  chains.chains = true;
  CHECK(picture_of(rigid, chains).panels[0].quantity->name == std::string("material"));
}

TEST_CASE("frames of a strip are equally distributed", "[results]") {
  const Folder folder;
  write_results(folder.path(), model_of_results(false), 9);
  const RunFolder run(folder.path());
  CHECK(strip(run, 1) == std::vector<size_t>{8});
  CHECK(strip(run, 2) == std::vector<size_t>{0, 8});
  CHECK(strip(run, 5) == std::vector<size_t>{0, 2, 4, 6, 8});
  CHECK(strip(run, 100).size() == 9);
}

TEST_CASE("materials have the areas of their bodies", "[results]") {
  const Folder folder;
  write_results(folder.path(), model_of_results(true), 1);
  const RunFolder run(folder.path());
  const RunPicture choice{strip(run, 1), field_quantity("material")};
  const Pixels pixels = drawn(run, choice);
  const int rock = pixels_of(pixels, okabe_ito(0)), ice = pixels_of(pixels, okabe_ito(1));
  CHECK(ice > 20000);
  CHECK(rock == Approx(2 * ice).epsilon(.04));  // 3 + 1 and 1 + 1 square metres, less their lines
  require_xml(draw_fields(picture_of(run, choice), PictureFormat::svg));
}

TEST_CASE("all panels of a strip have one scale, and fixed bodies are grey", "[results]") {
  const Folder folder;
  write_results(folder.path(), model_of_results(false), 3);
  const RunFolder run(folder.path());
  // The rotation of the block is 0, .1 and .2 rad; the L, of three times its area, is fixed.
  const Pixels pixels = drawn(run, {strip(run, 3), field_quantity("rotation")});
  const int first = pixels_of(pixels, viridis(0));
  CHECK(first > 2000);
  CHECK(pixels_of(pixels, viridis(.5)) == Approx(first).epsilon(.1));
  CHECK(pixels_of(pixels, viridis(1)) == Approx(first).epsilon(.1));
  CHECK(pixels_of(pixels, kOfFixed) == Approx(9 * first).epsilon(.1));
  // A given scale, in SI units: .1 of 0 to .4, and .2 in the middle of it.
  RunPicture half{strip(run, 3), field_quantity("rotation")};
  half.range = Vec2(0, .4);
  const Pixels ranged = drawn(run, half);
  CHECK(pixels_of(ranged, viridis(.25)) == Approx(first).epsilon(.1));
  CHECK(pixels_of(ranged, viridis(.5)) == Approx(first).epsilon(.1));
  // A window on the block of the last frame alone.
  RunPicture close{{2}, field_quantity("rotation")};
  close.window = Box{1027.7, -511.7, 1028.3, -511.3};
  const Pixels near = drawn(run, close);
  CHECK(pixels_of(near, kOfFixed) < 100);
  CHECK(pixels_of(near, viridis(.5)) > 50000);  // one value alone is in the middle of the scale
}

TEST_CASE("rigid bodies show their mean stress where all bodies are rigid", "[results]") {
  const Folder folder;
  write_results(folder / "rigid", model_of_results(false), 1);
  write_results(folder / "meshed", model_of_results(true), 1);
  const RunFolder rigid(folder / "rigid"), meshed(folder / "meshed");
  const auto field = [](const RunFolder& run, const char* name) {
    return picture_of(run, {{0}, field_quantity(name)}).panels[0].fields[0].field;
  };
  const Field pressure = field(rigid, "pressure");
  CHECK(pressure.values[1] == 4);
  CHECK(pressure.blank == std::vector<bool>{true, false});
  CHECK(field(rigid, "coordination").values[1] == 4);
  const Field beside = field(meshed, "pressure");
  CHECK(beside.blank == std::vector<bool>{true, true, false, false, false, false});
  CHECK(beside.values[5] == -.5);
  CHECK_THROWS_WITH(field(rigid, "von_mises"), Catch::Contains("no body is of finite elements"));
}

TEST_CASE("chains and roses lie over the bodies", "[results]") {
  const Folder folder;
  write_results(folder / "run", model_of_results(false), 2);
  const RunFolder run(folder / "run");
  RunPicture choice{{1}, field_quantity("material")};
  const int without = pixels_of(drawn(run, choice), kOfChains);
  choice.chains = true;
  const Pixels pixels = drawn(run, choice);
  // From (2.5, .25) to the block's centre, with 12 pixels of width.
  CHECK(pixels_of(pixels, kOfChains) > without + 1500);
  require_xml(draw_fields(picture_of(run, choice), PictureFormat::svg));
  choice.chains = false;
  choice.roses = true;
  CHECK(drawn(run, choice).colours != drawn(run, {{1}, field_quantity("material")}).colours);
  // All of a rose is in the picture, also what is longer than the bodies reach.
  const FieldPanel panel = picture_of(run, choice).panels[0];
  REQUIRE_FALSE(panel.fields[0].roses.empty());
  const Box window = lay_out(panel, 1, Canvas(PictureFormat::png, 1, 1)).window;
  for (const Vec2& p : panel.fields[0].roses[0].line)
    CHECK_FALSE(apart(window, {p.x(), p.y(), p.x(), p.y()}));
  Model no_regions = model_of_results(false);
  no_regions.regions.clear();
  write_results(folder / "none", no_regions, 1);
  const RunFolder none(folder / "none");
  choice.frames = {0};
  CHECK_THROWS_WITH(picture_of(none, choice), Catch::Contains("roses.pvd"));
}

TEST_CASE("displacements times a factor", "[results]") {
  const Folder folder;
  const Model model = model_of_results(true);
  write_results(folder.path(), model, 3);
  const RunFolder run(folder.path());
  RunPicture choice{{2}};
  choice.deformation = 10;
  const FieldFigure figure = picture_of(run, choice);
  CHECK(figure.panels[0].title == "displacements times 10");
  const Field& field = figure.panels[0].fields[0].field;
  const size_t beam = field.mesh.nodes.size() - model.deformables[0].mesh.nodes.size();
  CHECK(extent(field, beam, field.mesh.nodes.size()).x() == Approx(2.4).epsilon(1e-12));
  // The block has moved by .5 m and .2 rad; it keeps its shape.
  const std::span<const int> corners = field.mesh.element(1);
  Vec2 middle = Vec2::Zero();
  for (const int i : corners) middle += field.mesh.nodes[i] / 4;
  CHECK((middle - model.origin - model.bodies[2].position - Vec2(5, 0)).norm() < 1e-11);
  const Vec2 edge = field.mesh.nodes[corners[1]] - field.mesh.nodes[corners[0]];
  CHECK(edge.norm() == Approx(1).epsilon(1e-12));
  CHECK(std::remainder(std::atan2(edge.y(), edge.x()) - 2, M_PI / 2) == Approx(0).margin(1e-11));
}

TEST_CASE("histories and ledgers as plots", "[results]") {
  const Folder folder;
  folder.write("energy.csv",
               "time [s],kinetic [J],strain [J],friction_loss [J],total_error [J]\n"
               "0,1,0,0,0\n1,2,0,3,1e-9\n2,4,0,5,2e-9\n");
  folder.write("history.csv",
               "time [s],a.x [m],a.vx [m/s],b.x [m],b.vx [m/s],bin.count [1],bin.vx [m/s]\n"
               "0,1,0,2,0,7,1\n1,3,0,4,1,8,2\n");
  const CurveFigure energy = plot_of(folder.path(), "energy");
  REQUIRE(energy.panels.size() == 2);
  CHECK(energy.panels[0].y_label == "energy [J]");
  CHECK(energy.panels[0].x_label == "time [s]");
  REQUIRE(energy.panels[0].curves.size() == 2);  // the strain does not change
  CHECK(energy.panels[0].curves[1].label == "friction loss");
  CHECK(energy.panels[0].curves[1].y == std::vector<double>{0, 3, 5});
  CHECK(energy.panels[1].y_label == "error of energy [J]");

  const CurveFigure history = plot_of(folder.path(), "history");
  REQUIRE(history.panels.size() == 2);
  CHECK(history.panels[0].y_label == "x [m]");
  REQUIRE(history.panels[0].curves.size() == 2);
  CHECK(history.panels[0].curves[1].label == "b");
  CHECK(history.panels[1].curves.size() == 1);  // the velocity of a is 0
  CHECK(plot_of(folder.path(), "history", {"a.vx"}).panels[0].curves[0].y ==
        std::vector<double>{0, 0});
  CHECK(plot_of(folder.path(), "history", {"vx"}).panels[0].curves.size() == 2);

  const CurveFigure regions = plot_of(folder.path(), "regions");
  REQUIRE(regions.panels.size() == 2);
  CHECK(regions.panels[0].y_label == "count");
  CHECK(regions.panels[1].curves[0].label == "bin");

  CHECK_THROWS_WITH(plot_of(folder.path(), "history", {"a.z"}),
                    Catch::Contains("\"a.z\"") && Catch::Contains("a.x, a.vx, b.x, b.vx"));
  CHECK_THROWS_WITH(plot_of(folder.path(), "momentum"), Catch::Contains("momentum.csv"));
  folder.write("history.csv", "time [s],a.x [m]\n0,1\n");
  CHECK_THROWS_WITH(plot_of(folder.path(), "regions"), Catch::Contains("\"regions\""));
  CHECK_THROWS_WITH(plot_of(folder.path(), "history"), Catch::Contains("nothing in it changes"));
  folder.write("history.csv", "time [s]\n0\n");
  CHECK_THROWS_WITH(plot_of(folder.path(), "history"), Catch::Contains("\"track\""));
}

TEST_CASE("a plot does not hold more curves than can be told apart", "[results]") {
  const Folder folder;
  std::string head = "time [s]", first = "0", last = "1";
  for (int i = 0; i < 20; ++i) {
    head += ",b" + std::to_string(i) + ".x [m]";
    first += ",0";
    last += "," + std::to_string(i + 1);
  }
  folder.write("history.csv", head + "\n" + first + "\n" + last + "\n");
  const CurveFigure figure = plot_of(folder.path(), "history");
  REQUIRE(figure.panels.size() == 1);
  CHECK(figure.panels[0].curves.size() == 12);
  CHECK(figure.panels[0].title.find("the first 12") != std::string::npos);
  if (std::system("command -v gnuplot > /dev/null 2>&1") != 0) return;
  const std::string png = draw_curves(figure, PictureFormat::png).value();
  CHECK(decode(png).width == 1000);
  require_xml(draw_curves(figure, PictureFormat::svg).value());
}

TEST_CASE("curves of any name are plotted, and no name is a command", "[picture]") {
  const Folder folder;
  const std::string name =
      "';system('touch " + folder / "gone" + "');# `touch " + folder / "gone" + "` \"x\\";
  CurvePanel panel;
  panel.title = panel.x_label = panel.y_label = name;
  panel.curves.push_back({name, CurveStyle::line, 0, {0, 1}, {0, 1}});
  const std::optional<std::string> picture = draw_curves({name, {panel}}, PictureFormat::svg);
  if (!picture) return;  // there is no gnuplot
  CHECK(picture->find("system(") != std::string::npos);
  CHECK_FALSE(std::filesystem::exists(folder / "gone"));
}
