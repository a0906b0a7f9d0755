// The list of all surfaces: their kinds, numbers and bodies, and which kernel serves which pair.
#include <catch2/catch.hpp>
#include <set>
#include <tuple>

#include "lib/mesh/rectangle_mesh.hpp"
#include "tests/contact/bodies.hpp"

using namespace apothem;
using namespace apothem::test;

namespace {

// Two rigid squares, a mesh of nine cells on the first of them, and a mesh of one cell on that.
const std::vector<Polygon> kSquares{samples::block(0, 0, 3, 1), samples::block(2.9, 0, 4, 1)};
Mesh nine_cells() { return rectangle_mesh({3, 3}, {3, 3}, {0, .95}, ElementShape::quadrilateral); }
Mesh one_cell() { return one_element({{0, 3.9}, {1, 3.9}, {1, 4.9}, {0, 4.9}}); }

struct Pile : Bodies {
  explicit Pile(ContactSurface surface)
      : Bodies(surface == ContactSurface::body ? law_of(1)
                                               : element_law(1, ForceDistribution::resultant)) {
    for (const Polygon& square : kSquares) add_polygon(square, {1, 1, 1});
    add_mesh(nine_cells());
    add_mesh(one_cell());
  }
};

// The kernels that have found contacts, with the bodies that touch.
using Served = std::set<std::tuple<KernelKind, BodyIndex, BodyIndex>>;
Served served(Bodies& bodies) {
  bodies.join();
  bodies.evaluate();
  REQUIRE_FALSE(bodies.contacts->fault());
  Served result;
  KernelKind last = polygon_kernel;
  for (const Contact& c : bodies.contacts->contacts()) {
    CHECK(c.kernel >= last);
    last = c.kernel;
    const auto [a, b] = bodies.contacts->bodies(c);
    CHECK(a < b);
    result.emplace(c.kernel, a, b);
  }
  return result;
}

}  // namespace

TEST_CASE("each pair of kinds of surfaces has one kernel, and elements and outlines never meet",
          "[surfaces][contact]") {
  using enum SurfaceKind;
  CHECK(kernel_of(polygon, polygon) == polygon_kernel);
  CHECK(kernel_of(polygon, element) == element_kernel);
  CHECK(kernel_of(element, polygon) == element_kernel);
  CHECK(kernel_of(element, element) == element_kernel);
  CHECK(kernel_of(polygon, outline) == outline_kernel);
  CHECK(kernel_of(outline, polygon) == outline_kernel);
  CHECK(kernel_of(outline, outline) == outline_kernel);
  CHECK(kernel_of(element, outline) == kernel_kinds);
  CHECK(kernel_of(outline, element) == kernel_kinds);
}

TEST_CASE("polygons have the first numbers, then come the outermost elements of each mesh",
          "[surfaces][contact]") {
  Pile pile(ContactSurface::element);
  const Surfaces& s = *pile.surfaces;
  REQUIRE(s.size() == 2 + 8 + 1);
  CHECK(s.rigid_count() == 2);
  CHECK(s.body_count() == 4);
  CHECK_FALSE(s.has_outlines());
  CHECK(s.elements().size() == 9);
  CHECK(s.shapes().size() == 11);
  for (SurfaceIndex i = 0; i < s.size(); ++i) {
    CHECK(s.is_rigid(i) == (i < 2));
    CHECK(s.kind(i) == (i < 2 ? SurfaceKind::polygon : SurfaceKind::element));
    CHECK(s.body(i) == (i < 2 ? i : i < 10 ? 2 : 3));
    if (i >= 2) CHECK(s.elements().body(i - s.rigid_count()) == s.body(i));
    CHECK(s.inradius(i) == Approx(i == 1 ? .5 : .5));
  }
  pile.join();
  pile.place();
  const Surfaces& placed = pile.contacts->surfaces();
  for (int e = 0; e < 9; ++e) {
    const SurfaceIndex i = placed.rigid_count() + e;
    // The first corner of an element is its reference point.
    const Mesh mesh = e < 8 ? nine_cells() : one_cell();
    const NodeIndex first = e < 8 ? 0 : 16;
    const Vec2 corner = mesh.nodes[placed.elements().nodes(e)[0] - first];
    CHECK(placed.reference(i) == corner);
    CHECK(placed.elements().convex(e));
  }
}

TEST_CASE("a mesh has one outline, and polygons beside it have their collars as well",
          "[surfaces][contact]") {
  Pile pile(ContactSurface::body);
  const Surfaces& s = *pile.surfaces;
  REQUIRE(s.size() == 4);
  CHECK(s.rigid_count() == 2);
  CHECK(s.body_count() == 4);
  CHECK(s.has_outlines());
  CHECK(s.elements().size() == 0);
  CHECK(s.shapes().size() == 2);
  REQUIRE(s.outlines().bodies.size() == 4);
  CHECK(s.outlines().size() == 4 + 4 + 12 + 4);
  for (SurfaceIndex i = 0; i < s.size(); ++i) {
    CHECK(s.is_rigid(i) == (i < 2));
    CHECK(s.kind(i) == (i < 2 ? SurfaceKind::polygon : SurfaceKind::outline));
    CHECK(s.body(i) == i);
    CHECK(s.outlines().bodies[i].rigid == (i < 2 ? i : -1));
    CHECK(s.outlines().bodies[i].reference == Approx(.5));
  }

  // Without meshes nothing needs a collar.
  Surfaces polygons(.1, 0, false);
  const Potential potential = about_centre(kSquares[0]);
  polygons.add_polygon(potential, {.inverse_mass = {1, 1, 1}, .inradius = .5, .moves = true});
  CHECK_FALSE(polygons.has_outlines());
}

TEST_CASE("boxes of polygons and of meshes grow by half of their own skins",
          "[surfaces][contact]") {
  for (const bool outlines : {false, true}) {
    Surfaces s(.3, .1, outlines);
    const Potential potential = about_centre(kSquares[0]);
    s.add_polygon(potential, {.inverse_mass = {1, 1, 1}, .inradius = .5, .moves = true});
    if (outlines) {
      s.add_outline(one_cell(), 0, {});
    } else {
      s.add_elements(one_cell(), 0, {});
    }
    CHECK(s.growth(0) == .3 / 2);
    CHECK(s.growth(1) == .1 / 2);
  }
}

TEST_CASE("a body responds to forces if one of its coordinates is free, and meshes always do",
          "[surfaces][contact]") {
  Bodies bodies(law_of(1));
  const Potential potential = about_centre(kSquares[0]);
  bodies.add_rigid(potential, {}, {0, 0, 0});
  bodies.add_rigid(potential, {}, {2, 2, 3});
  bodies.add_rigid(potential, {}, {2, 0, 0});
  bodies.add_rigid(potential, {}, {0, 2, 0});
  bodies.add_rigid(potential, {}, {0, 0, 3});
  bodies.add_mesh(one_cell());
  CHECK_FALSE(bodies.surfaces->responsive(0));
  for (SurfaceIndex i = 1; i < 6; ++i) CHECK(bodies.surfaces->responsive(i));
}

TEST_CASE("a body that cannot move is placed once", "[surfaces][contact]") {
  const Potential potential = about_centre(kSquares[0]);
  Surfaces s(.1, 0, false);
  s.add_polygon(potential, {{0, 0, 0}, .5, false});
  s.add_polygon(potential, {.inverse_mass = {1, 1, 1}, .inradius = .5, .moves = true});
  std::vector<double> pose{1, 2, .5, 3, 4, .25};
  const Kinematics now{pose, {}, {}, {}};
  s.place_all(now);
  CHECK(s.reference(0) == Vec2(1, 2));
  CHECK(s.reference(1) == Vec2(3, 4));
  CHECK(s.pose(1)[2] == .25);
  CHECK(s.between(1, 0) == Vec2(2, 2));
  for (double& x : pose) x += 1;
  s.place(now);
  CHECK(s.reference(0) == Vec2(1, 2));
  CHECK(s.reference(1) == Vec2(4, 5));
  CHECK(s.pose(1)[2] == 1.25);
  s.place_all(now);
  CHECK(s.reference(0) == Vec2(2, 3));
}

TEST_CASE("in a scene without meshes one kernel serves all", "[surfaces][contact]") {
  Bodies bodies(law_of(1));
  for (const Polygon& square : kSquares) bodies.add_polygon(square, {1, 1, 1});
  CHECK(served(bodies) == Served{{polygon_kernel, 0, 1}});
  CHECK(bodies.contacts->candidates() == 1);
}

TEST_CASE("rigid bodies touch each other by their polygons and meshes by collars",
          "[surfaces][contact]") {
  Pile pile(ContactSurface::body);
  CHECK(served(pile) == Served{{polygon_kernel, 0, 1},
                               {outline_kernel, 0, 2},
                               {outline_kernel, 1, 2},
                               {outline_kernel, 2, 3}});
}

TEST_CASE("rigid bodies touch each other by their polygons, and elements by theirs",
          "[surfaces][contact]") {
  Pile pile(ContactSurface::element);
  CHECK(served(pile) == Served{{polygon_kernel, 0, 1},
                               {element_kernel, 0, 2},
                               {element_kernel, 1, 2},
                               {element_kernel, 2, 3}});
}

TEST_CASE("meshes alone touch each other by one kernel", "[surfaces][contact]") {
  for (const ContactSurface surface : {ContactSurface::body, ContactSurface::element}) {
    const bool body = surface == ContactSurface::body;
    Bodies bodies(body ? law_of(1) : element_law(1, ForceDistribution::integrated));
    bodies.add_mesh(nine_cells());
    bodies.add_mesh(one_cell());
    CHECK(served(bodies) == Served{{body ? outline_kernel : element_kernel, 0, 1}});
  }
}

TEST_CASE("springs name the bodies that they are between", "[surfaces][contact]") {
  for (const ContactSurface surface : {ContactSurface::body, ContactSurface::element}) {
    Pile pile(surface);
    pile.law.friction = {.5, 1};
    Served expected = served(pile);
    pile.update_friction(1);
    Served found;
    for (const Spring& spring : pile.contacts->springs()) {
      const auto [a, b] = pile.contacts->bodies(spring.key);
      found.emplace(static_cast<KernelKind>(spring.key.law), std::min(a, b), std::max(a, b));
    }
    CHECK(found == expected);
  }
}
