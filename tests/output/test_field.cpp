// Fields: read back from frames, compared with tables, drawn.
#include "lib/output/field.hpp"

#include <boost/property_tree/ptree.hpp>
#include <boost/property_tree/xml_parser.hpp>
#include <catch2/catch.hpp>
#include <chrono>
#include <sstream>

#include "lib/fem/finite_elements.hpp"
#include "lib/mesh/measure.hpp"
#include "lib/output/field_picture.hpp"
#include "lib/output/frames.hpp"
#include "tests/fem/meshes.hpp"
#include "tests/folder.hpp"
#include "tests/pixels.hpp"

using namespace apothem;
using namespace apothem::test;

namespace {

const FieldQuantity& quantity(const std::string& name) {
  for (const FieldQuantity& q : field_quantities()) {
    if (q.name == name) return q;
  }
  throw std::logic_error(name);
}

// A rigid square beside a rectangle of elements.
Model square_and_block(const Mesh& mesh) {
  Model model;
  model.origin = {64, 0};
  model.materials = {{"rock", 2000, {ElasticLaw::st_venant_kirchhoff, Plane::strain, 1e9, .25}}};
  RigidBody square;
  square.name = "square";
  set_shape(square, Polygon({{62, 0}, {63, 0}, {63, 1}, {62, 1}}), model);
  model.bodies = {square};
  DeformableBody block;
  block.name = "block";
  block.mesh = mesh;
  model.deformables = {block};
  return model;
}

// A frame of [0, 2] x [0, 1] in 2n x n squares that are where they were.
Frame at_rest(int n) {
  Frame frame;
  frame.mesh = quad_grid(2 * n, n, 2, 1);
  for (Vec2& p : frame.mesh.nodes) p.y() += .5;
  frame.displacement.assign(frame.mesh.nodes.size(), Vec2::Zero());
  frame.velocity = frame.displacement;
  frame.stress.resize(frame.mesh.element_count());
  frame.body.assign(frame.mesh.element_count(), 0);
  frame.material = frame.body;
  frame.position = frame.mesh.nodes;
  frame.bodies.resize(1);
  frame.bodies[0].meshed = true;
  return frame;
}

Vec2 middle(const Mesh& mesh, int element) {
  Vec2 sum = Vec2::Zero();
  for (const int node : mesh.element(element)) sum += mesh.nodes[node];
  return sum / static_cast<double>(mesh.element(element).size());
}

FieldPanel panel_of(Field field, const std::string& name) {
  FieldPanel panel;
  panel.quantity = &quantity(name);
  panel.unit = panel.quantity->unit;
  panel.fields = {{"one", std::move(field)}};
  return panel;
}

// Between the numbers of the axis and the scale, which has all colours.
constexpr int kFirst = 2 * 62 + 2, kScale = 2 * 96;

// How many pixels of a colour there are, and the box around them.
struct Patch {
  int count = 0;
  int left = INT_MAX, right = -1, top = INT_MAX, bottom = -1;
};
template <class Is>
Patch patch_where(const Pixels& pixels, int top, int bottom, const Is& is) {
  Patch patch;
  for (int y = top; y <= bottom; ++y) {
    for (int x = kFirst; x < pixels.width - kScale; ++x) {
      if (!is(pixels.at(x, y))) continue;
      ++patch.count;
      patch.left = std::min(patch.left, x);
      patch.right = std::max(patch.right, x);
      patch.top = std::min(patch.top, y);
      patch.bottom = std::max(patch.bottom, y);
    }
  }
  return patch;
}
Patch patch_of(const Pixels& pixels, const Colour& colour) {
  return patch_where(pixels, 0, pixels.height - 1,
                     [&](std::uint32_t pixel) { return has_colour(pixel, colour); });
}
const Colour kGrey{.78, .78, .78};  // of rigid bodies, and of edges of letters

bool is_coloured(std::uint32_t pixel) {
  const std::uint32_t r = pixel >> 16, g = pixel >> 8 & 0xff, b = pixel & 0xff;
  return std::max({r, g, b}) - std::min({r, g, b}) > 40;
}

}  // namespace

TEST_CASE("principal stresses and von Mises of known states", "[field]") {
  const auto [major, minor] = principal_stresses({10, -2, 8, 0, 0});  // radius 10 around 4
  CHECK(major == 14);
  CHECK(minor == -6);
  CHECK(von_mises({3, 3, 0, 3, 0}) == 0);
  CHECK(von_mises({5, 0, 0, 0, 0}) == 5);
  CHECK(von_mises({0, 0, 2, 0, 0}) == Approx(2 * std::sqrt(3)).epsilon(1e-15));
  const FieldSample sample{{10, -2, 8, 1, 0}, {3, -4}, {-6, 8}};
  for (const auto& [name, value] : {std::pair("s1", 14.),
                                    {"s2", -6.},
                                    {"sxx", 10.},
                                    {"syy", -2.},
                                    {"sxy", 8.},
                                    {"szz", 1.},
                                    {"ux", 3.},
                                    {"uy", -4.},
                                    {"u", 5.},
                                    {"vx", -6.},
                                    {"vy", 8.},
                                    {"speed", 10.},
                                    {"pressure", -4.}}) {
    INFO(name);
    CHECK(quantity(name).value(sample) == value);
    const bool nodal = name[0] == 'u' || name[0] == 'v' || std::string(name) == "speed";
    CHECK((quantity(name).kind == FieldKind::node) == nodal);
  }
}

TEST_CASE("a frame is read back as it was written", "[field]") {
  const Folder folder;
  const Model model = square_and_block(quad_grid(4, 2, 2, 1));
  const Mesh& mesh = model.deformables[0].mesh;
  const FiniteElements elements(std::vector<ElementSet>{{ElementKind::quad4, &mesh, 0,
                                                         model.materials[0].elastic, 2000, 1, 0}},
                                1);
  State state(Layout{1, model.node_count()});
  state.pose(0) << model.bodies[0].position + Vec2(.5, 0), 0;
  state.pose_rate(0) << 7, 0, 0;
  samples::Random random(5);
  for (size_t c = state.layout.node(0); c < state.layout.size(); ++c) {
    state.x[c] = random.uniform(-1e-3, 1e-3);
    state.v[c] = random.uniform(-1, 1);
  }
  const std::vector<CauchyStress> stress = elements.stresses(state.layout.of_nodes(state.x));
  FrameWriter frames(folder.path(), model);
  for (const double time : {0., .25, .5}) {
    state.time = time;
    frames.write({.state = state,
                  .stresses = stress,
                  .forces = std::vector<BodyForce>(2),
                  .node_mass = elements.mass()});
  }
  const Frame frame = read_frame(folder.path(), .2, .3);
  CHECK(frame.time == .25);
  CHECK(read_frame(folder.path(), .5, .6).time == .5);
  CHECK_THROWS_WITH(read_frame(folder.path(), .3, .4), Catch::Contains("no frame at 0.3 s"));
  CHECK_THROWS_WITH(read_frame(folder / "none", 0, 1), Catch::Contains("no such folder"));

  REQUIRE(frame.mesh.element_count() == 9);
  REQUIRE(frame.mesh.nodes.size() == 4 + mesh.nodes.size());
  CHECK(frame.body == std::vector<int>{0, 1, 1, 1, 1, 1, 1, 1, 1});
  CHECK(frame.displacement[2] == Vec2(.5, 0));
  CHECK(frame.velocity[2] == Vec2(7, 0));
  CHECK(frame.mesh.nodes[0] == Vec2(62, 0));
  for (int i = 0; i < model.node_count(); ++i) {
    CHECK(frame.displacement[4 + i] == state.node(i));
    CHECK(frame.velocity[4 + i] == state.node_velocity(i));
    CHECK((frame.mesh.nodes[4 + i] - mesh.nodes[i] - model.origin).norm() < 1e-13);
  }
  const Field major = field_of(frame, quantity("s1"));
  const Field sink = field_of(frame, quantity("uy"));
  CHECK(major.blank[0]);
  CHECK_FALSE(sink.blank[0]);
  for (int e = 0; e < 8; ++e) {
    CHECK_FALSE(major.blank[1 + e]);
    CHECK(frame.stress[1 + e].xx == stress[e].xx);
    CHECK(frame.stress[1 + e].zz == stress[e].zz);
    CHECK(major.values[1 + e] == principal_stresses(stress[e])[0]);
    for (size_t k = 0; k < 4; ++k) {
      CHECK(frame.mesh.element(1 + e)[k] == 4 + mesh.element(e)[k]);
    }
  }
  CHECK(sink.values[6] == state.node(2).y());
  CHECK((major.mesh.nodes[6] - (mesh.nodes[2] + model.origin + frame.displacement[6])).norm() <
        1e-13);
}

TEST_CASE("a frame against a table of cells", "[field]") {
  // Cells of .5 m, elements of .25 m: shear that cancels within each cell.
  Frame frame = at_rest(4);
  CellTable reference{{.5, .5}, {}, {}};
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 2; ++j) {
      reference.centres.emplace_back(.25 + .5 * i, .25 + .5 * j);
      reference.values.push_back(10. * (1 + i + j));
    }
  }
  for (int e = 0; e < frame.mesh.element_count(); ++e) {
    const Vec2 p = middle(frame.mesh, e);
    const int i = static_cast<int>(p.x() / .5), j = static_cast<int>(p.y() / .5);
    const bool odd = std::fmod(p.x(), .5) > .25;
    frame.stress[e].xx = 10. * (1 + i + j) + (odd ? 4 : -4);
    frame.stress[e].xy = odd ? 30 : -30;
  }
  // The mean stress is xx alone; means of principal stresses would be higher.
  FieldError error = field_error(frame, quantity("s1"), reference);
  CHECK(error.rms < 1e-15);
  CHECK(error.largest < 1e-15);
  reference.values[3] += 10;  // of 50, in one of eight cells
  reference.values[7] = 50;
  error = field_error(frame, quantity("s1"), reference);
  CHECK(error.largest == Approx(10 / 50.).epsilon(1e-14));
  CHECK(error.rms == Approx(10 / 50. / std::sqrt(8)).epsilon(1e-14));

  // Where an element was counts, not where it is; means of nodal values, too.
  for (Vec2& u : frame.displacement) u = {.3, 0};
  CHECK(field_error(frame, quantity("s1"), reference).largest == error.largest);
  const CellTable moved{{1, 1}, {{.5, .5}, {1.5, .5}}, {.3, .4}};
  CHECK(field_error(frame, quantity("ux"), moved).largest == Approx(.25).epsilon(1e-14));

  reference.centres[5].x() += 40;
  CHECK_THROWS_WITH(field_error(frame, quantity("s1"), reference),
                    Catch::Contains("no element") && Catch::Contains("41.25"));
  frame.bodies[0].meshed = false;
  CHECK_THROWS(field_error(frame, quantity("s1"), moved));
}

TEST_CASE("cells of a table share their corners", "[field]") {
  const HistoryTable table{{"x", "y", "a"}, {{.05, .15, .05}, {.05, .05, .15}, {1, 2, 3}}};
  const Field field = field_of(cell_table(table, "a", {.1, .1}));
  CHECK(field.mesh.nodes.size() == 8);
  REQUIRE(field.mesh.element_count() == 3);
  CHECK(field.values == std::vector<double>{1, 2, 3});
  for (int e = 0; e < 3; ++e) {
    CHECK(element_area(field.mesh, e) == Approx(.01).epsilon(1e-12));
    CHECK((middle(field.mesh, e) - Vec2(table.columns[0][e], table.columns[1][e])).norm() < 1e-15);
  }
}

TEST_CASE("elements are drawn in the colours of their values", "[field]") {
  // Two squares of 1 m with 10 and 40 MPa, a rigid one beside them; the scale goes from 0 to 50.
  Frame frame = at_rest(1);
  frame.stress[0].xx = 10e6;
  frame.stress[1].xx = 40e6;
  for (const Vec2& p : {Vec2(2.5, 0), Vec2(3, 0), Vec2(3, 1), Vec2(2.5, 1)}) {
    frame.mesh.nodes.push_back(p);
    frame.position.push_back(p);
    frame.displacement.emplace_back(0, 0);
    frame.velocity.emplace_back(0, 0);
  }
  frame.mesh.add_element(std::array{6, 7, 8, 9});
  frame.stress.emplace_back();
  frame.material.push_back(0);
  frame.body = {1, 1, 0};
  frame.bodies.insert(frame.bodies.begin(), FrameBody{});  // the rigid one comes first
  FieldPanel panel = panel_of(field_of(frame, quantity("sxx")), "sxx");
  panel.scale = 1e-6;
  panel.range = {0, 50};
  const auto draw = [&] { return decode(draw_fields({"two", {panel}}, PictureFormat::png)); };
  CHECK((draw().colours == draw().colours));
  const Pixels pixels = draw();
  const Patch low = patch_of(pixels, viridis(.2)), high = patch_of(pixels, viridis(.8));
  const Patch rigid = patch_where(pixels, low.top, low.bottom,
                                  [&](std::uint32_t pixel) { return has_colour(pixel, kGrey); });
  CHECK(low.count > 10000);
  // Squares of one size, side by side, up to their outline; half of one for the rigid body.
  CHECK(low.right - low.left == Approx(low.bottom - low.top).margin(3));
  CHECK(low.count ==
        Approx((low.right - low.left + 1.) * (low.bottom - low.top + 1)).epsilon(1e-3));
  CHECK(high.left == low.right + 1);
  CHECK(high.top == low.top);
  CHECK(high.count == Approx(low.count).epsilon(.02));
  CHECK(rigid.count == Approx(low.count / 2.).epsilon(.02));
  CHECK(rigid.left > high.right);
  // Between the bodies and the frame: paper.
  CHECK(pixels.at((high.right + rigid.left) / 2, (low.top + low.bottom) / 2) == 0xffffff);

  // Values beyond the range have the colours of its ends, and the scale points there.
  panel.range = {20, 30};
  const Pixels cut = draw();
  CHECK(patch_of(cut, viridis(0)).count == Approx(low.count).epsilon(.02));
  CHECK(patch_of(cut, viridis(1)).count == Approx(low.count).epsilon(.02));
  // Without a range its ends are the least and the largest value.
  panel.range.reset();
  CHECK(patch_of(draw(), viridis(0)).count == Approx(low.count).epsilon(.02));
  // A window shows a part: the left half of the first square.
  panel.window = Box{0, 0, .5, 1};
  CHECK(patch_of(draw(), viridis(.5)).count > 10000);  // the only value there
  CHECK(patch_of(draw(), kGrey).count < 100);          // edges of letters
}

TEST_CASE("nodal values are interpolated within elements", "[field]") {
  // u_x = x over two skew elements: the colour follows x.
  Frame frame = at_rest(1);
  frame.mesh.nodes[1].x() = frame.position[1].x() = .7;
  for (size_t i = 0; i < frame.mesh.nodes.size(); ++i) {
    frame.velocity[i] = {frame.mesh.nodes[i].x(), 0};
  }
  const FieldPanel panel = panel_of(field_of(frame, quantity("vx")), "vx");
  const Pixels pixels = decode(draw_fields({"skew", {panel}}, PictureFormat::png));
  const Patch left = patch_of(pixels, viridis(0)), right = patch_of(pixels, viridis(1));
  REQUIRE(left.count > 0);
  REQUIRE(right.count > 0);
  const int y = (left.top + left.bottom) / 2;
  int checked = 0;
  for (int x = left.left + 4; x < right.right - 4; ++x, ++checked) {
    const double share = (x - left.left) / static_cast<double>(right.right - left.left);
    const auto part = [&](int shift) { return static_cast<int>(pixels.at(x, y) >> shift & 0xff); };
    const Colour c = viridis(share);
    REQUIRE(std::abs(part(16) - 255 * c.red) < 4);
    REQUIRE(std::abs(part(8) - 255 * c.green) < 4);
    REQUIRE(std::abs(part(0) - 255 * c.blue) < 4);
  }
  CHECK(checked > 800);
}

TEST_CASE("elements of any shape leave no pixel out", "[field][slow]") {
  for (const Mesh& mesh :
       {distorted(quad_grid(40, 20, 2, 1), .3), triangles(distorted(quad_grid(31, 17, 2, 1), .3)),
        voronoi_cells(300, 2, 1, 0), merged_cells(voronoi_cells(200, 2, 1, 2))}) {
    for (const bool nodal : {false, true}) {
      Field field{mesh, nodal, {}, std::vector<bool>(mesh.element_count(), false)};
      samples::Random random(3);
      field.values.resize(nodal ? mesh.nodes.size() : mesh.element_count());
      for (double& v : field.values) v = random.uniform(0, 1);
      FieldPanel panel = panel_of(field, nodal ? "u" : "s1");
      panel.window = Box{.01, -.49, 1.99, .49};
      const Pixels pixels = decode(draw_fields({"", {panel}}, PictureFormat::png));
      const Patch frame = patch_where(pixels, 0, pixels.height - 1, is_coloured);
      CHECK(frame.right - frame.left ==
            Approx(1.98 / .98 * (frame.bottom - frame.top)).epsilon(.01));
      int without = 0, all = 0;
      constexpr int kBorder = 3;  // the frame's line
      for (int y = frame.top + kBorder; y <= frame.bottom - kBorder; ++y) {
        for (int x = frame.left + kBorder; x <= frame.right - kBorder; ++x, ++all) {
          without += !is_coloured(pixels.at(x, y));
        }
      }
      CHECK(all > 500000);
      CHECK(without == 0);
    }
  }
}

TEST_CASE("the name above a colour scale is not cut off", "[field]") {
  Frame frame = at_rest(1);
  frame.stress[0].xx = 1e-4;
  frame.stress[1].xx = 3e-4;
  FieldPanel panel = panel_of(field_of(frame, quantity("sxx")), "sxx");
  panel.unit = "a unit that is long";
  panel.window = Box{0, 0, .2, 3};  // narrow
  const Pixels pixels = decode(draw_fields({"", {panel}}, PictureFormat::png));
  int ink = 0;
  for (int y = 0; y < pixels.height; ++y) {
    for (int x = pixels.width - 4; x < pixels.width; ++x) ink += pixels.at(x, y) != 0xffffff;
  }
  CHECK(ink == 0);
}

TEST_CASE("a value that is no number is grey, not a crash", "[field]") {
  Frame frame = at_rest(1);
  frame.stress[0].xx = std::nan("");
  frame.stress[1].xx = 3;
  const Pixels pixels = decode(
      draw_fields({"", {panel_of(field_of(frame, quantity("sxx")), "sxx")}}, PictureFormat::png));
  CHECK(patch_of(pixels, kGrey).count > 10000);
}

TEST_CASE("the size of an SVG does not follow that of the mesh", "[field][slow]") {
  std::vector<size_t> sizes;
  for (const int n : {10, 100}) {
    Frame frame = at_rest(n);
    for (int e = 0; e < frame.mesh.element_count(); ++e) {
      frame.stress[e].xx = middle(frame.mesh, e).x();
    }
    FieldPanel panel = panel_of(field_of(frame, quantity("sxx")), "sxx");
    panel.fields.push_back(panel.fields[0]);
    const std::string svg = draw_fields({"mesh & more", {panel, panel}}, PictureFormat::svg);
    CHECK_FALSE(svg.find(" nan") < svg.size());  // in base64 there are no blanks
    boost::property_tree::ptree tree;
    std::istringstream stream(svg);
    REQUIRE_NOTHROW(boost::property_tree::read_xml(stream, tree));
    sizes.push_back(svg.size());
  }
  CHECK(sizes[1] < 300000);
  CHECK(sizes[1] < 3 * sizes[0]);
}
