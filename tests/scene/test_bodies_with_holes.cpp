// Rigid bodies with holes in scenes: their moments, their errors, and the fills around and in them.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>

#include "geometry/polygon/predicates.hpp"
#include "lib/mesh/boundary.hpp"
#include "lib/mesh/measure.hpp"
#include "lib/model/rotation.hpp"
#include "lib/model/statistics.hpp"
#include "lib/run/hash.hpp"
#include "lib/scene/scene.hpp"
#include "tests/folder.hpp"
#include "tests/support.hpp"

using namespace apothem;
using namespace apothem::test;
using Catch::Contains;

namespace holed_bodies {
namespace {

constexpr const char* kDrum = R"({ "name": "drum", "material": "rock", "motion": "fixed",
  "polygon": [[-3, -3], [3, -3], [3, 3], [-3, 3]],
  "holes": [ [[-2, -2], [2, -2], [2, 2], [0.2, 2], [0.2, 1], [-0.2, 1], [-0.2, 2], [-2, 2]] ] })";

std::string scene_with(const std::string& bodies, const std::string& more = "") {
  return R"({ "materials": { "rock": { "density": 2000, "young": 1e9, "poisson": 0.2 } },
  "contact": { "normal_stiffness": 1e8, "field": "distance", "reference": 0.1 },
  "bodies": [)" +
         bodies + "], " + more + R"("time": { "end": 1 } })";
}

Scene scene_of(const std::string& bodies, const std::string& more = "") {
  const Folder folder;
  return read_scene(folder.write("scene.json", scene_with(bodies, more)));
}

std::string error_of(const std::string& bodies, const std::string& more = "") {
  try {
    scene_of(bodies, more);
  } catch (const SceneError& error) {
    return error.what();
  }
  return "";
}

std::string square(const std::string& holes) {
  return R"({ "name": "b", "material": "rock", "polygon": [[0,0],[4,0],[4,4],[0,4]], "holes": )" +
         holes + " }";
}

Polygon placed(const RigidBody& body) {
  Rings rings = body.rings();
  for (std::vector<Vec2>& ring : rings) {
    for (Vec2& v : ring) v = body.position + turned(v, body.angle);
  }
  return Polygon(polygon_of_rings(rings));
}

bool apart_from(const Polygon& a, const Polygon& b) {
  for (int i = 0; i < a.size(); ++i) {
    for (int j = 0; j < b.size(); ++j) {
      if (segments_meet(a[i], a.after(i), b[j], b.after(j))) return false;
    }
  }
  return side_of(a, b[0]) < 0 && side_of(b, a[0]) < 0;
}

}  // namespace

TEST_CASE("mass, centre and inertia of a body are those without its holes", "[scene][holes]") {
  // A plate with a corner hole: composite bodies by the parallel axis theorem.
  const Scene scene = scene_of(square("[ [[1,1],[2,1],[2,2],[1,2]] ]"));
  REQUIRE(scene.model.bodies.size() == 1);
  const RigidBody& body = scene.model.bodies[0];
  CHECK(body.area == 15);
  CHECK(body.mass == Approx(30000).epsilon(1e-15));
  const double centre = (16 * 2 - 1 * 1.5) / 15;
  CHECK((body.position + scene.model.origin - Vec2(centre, centre)).norm() < 1e-15);
  const double whole = 16 * (32. / 12 + 2 * std::pow(2 - centre, 2));
  const double hole = 1. / 6 + 2 * std::pow(1.5 - centre, 2);
  CHECK(body.inertia == Approx(2000 * (whole - hole)).epsilon(1e-14));
  REQUIRE(body.rings().size() == 2);
  CHECK(body.rings()[0].size() == 4);
  CHECK(body.potential.next(3) == 0);
  CHECK(body.potential.next(7) == 4);
  CHECK(body.potential.previous(4) == 7);

  // The sense of a ring says nothing, and a file may have the hole.
  const Scene other = scene_of(square("[ [[1,1],[1,2],[2,2],[2,1]] ]"));
  CHECK(other.model.bodies[0].potential.vertices == body.potential.vertices);
  const Folder folder;
  folder.write("b.wkt", "POLYGON ((0 0, 4 0, 4 4, 0 4), (1 1, 2 1, 2 2, 1 2))");
  folder.write("h.json", "[[3, 3], [3.5, 3], [3.5, 3.5]]");
  const Scene file = read_scene(folder.write(
      "scene.json",
      scene_with(
          R"({ "name": "b", "material": "rock", "polygon": "b.wkt", "holes": ["h.json"] })")));
  CHECK(file.model.bodies[0].rings().size() == 3);
  CHECK(file.model.bodies[0].area == 15 - .125);
  // A body without the hole, or with its vertices in other rings, is another scene.
  CHECK(scene_hash(other) != scene_hash(scene));
}

TEST_CASE("a faulty hole is refused with its place and a remedy", "[scene][holes]") {
  struct Case {
    std::string body, place, says;
  };
  const std::string mesh =
      R"("name": "b", "material": "rock", "mesh": { "rectangle": { "size": [1, 1], "cells": [1, 1] } })";
  const Case cases[]{
      {square("[ [[1,1],[2,1],[2,2]], [[3,1],[3.5,1],[3.2,1],[3.2,1.5]] ]"), "/bodies/0/holes/1/1",
       "hole 1: vertex 1 is a spike"},
      {square("[ [[1,1],[2,2],[2,1],[1,2]] ]"), "/bodies/0/holes/0/2", "hole 0: edge 0 and edge 2"},
      {square("[ [[1,1],[2,1]] ]"), "/bodies/0/holes/0/1", "at least 3"},
      {square("[ [[1,1],[5,1],[2,2]] ]"), "/bodies/0/holes/0/0",
       "crosses or touches the outer ring (a hole lies inside, at a distance; join rings"},
      {square("[ [[0,1],[1,1],[1,2]] ]"), "/bodies/0/holes/0/0", "touches the outer ring"},
      {square("[ [[5,5],[6,5],[6,6]] ]"), "/bodies/0/holes/0/0", "outside of the outer ring"},
      {square("[ [[1,1],[3,1],[3,3]], [[2,1.5],[2.5,1.5],[2.5,2]] ]"), "/bodies/0/holes/1/0",
       "hole 1 lies inside hole 0 (what lies in a hole is a polygon of its own)"},
      {square("[ [[1,1],[2,1],[2]] ]"), "/bodies/0/holes/0/2", "must be [x, y] in m"},
      {square("[[1,1],[2,1],[2,2]]"), "/bodies/0/holes/0/0", "must be [x, y] in m"},
      {square("3"), "/bodies/0/holes", "must be an array"},
      {square("[\"none.wkt\"]"), "/bodies/0/holes/0", "cannot be opened"},
      {"{" + mesh + R"(, "holes": [ [[0.2,0.2],[0.4,0.2],[0.2,0.4]] ] })", "/bodies/0/holes",
       "the holes of a body with a mesh stand beside the polygon of its \"fill\""},
      {R"({ "name": "b", "material": "rock", "holes": [] })", "/bodies/0",
       "missing key \"polygon\""},
      {square("[]").substr(0, square("[]").size() - 1) + R"(, "hole": [] })", "/bodies/0/hole",
       "did you mean \"holes\"?"}};
  for (const auto& [body, place, says] : cases) {
    INFO(body);
    const std::string error = error_of(body);
    CHECK_THAT(error, Contains("scene.json:3: " + place + ": "));
    CHECK_THAT(error, Contains(says));
  }
  // The hole of a file that the scene's own hole meets.
  const Folder folder;
  folder.write("b.wkt", "POLYGON ((0 0, 4 0, 4 4, 0 4), (1 1, 2 1, 2 2, 1 2))");
  const std::string body =
      R"({ "name": "b", "material": "rock", "polygon": "b.wkt", "holes": [ [[1.5,1.5],[3,1],[3,2]] ] })";
  const std::string scene = folder.write("scene.json", scene_with(body));
  CHECK_THROWS_WITH(read_scene(scene), Contains("/bodies/0/holes/0/0: not a usable polygon: hole 1 "
                                                "crosses or touches hole 0"));
}

TEST_CASE("blocks are placed in the holes of bodies", "[fill][holes]") {
  for (const char* arrangement : {"random", "lattice", "dense"}) {
    INFO(arrangement);
    const Scene scene = scene_of(
        kDrum, fmt::format(R"("fill": [ {{ "name": "stone", "material": "rock", "arrangement": "{}",
      "region": [[-4, -4], [4, -4], [4, 4], [-4, 4]], "holes": [ [[-1.5, -1.5], [1.5, -1.5], [0, 0]] ],
      "shapes": [ {{ "quadrilateral": {{}} }}, {{ "cross": {{ "arm": 1 }} }} ], "diameter": 0.4, "count": 60,
      "angle": [0, 3] }} ], )",
                           arrangement));
    REQUIRE(scene.model.bodies.size() == 61);
    const Polygon drum = placed(scene.model.bodies[0]);
    CHECK(drum.rings() == 2);
    int inside = 0;
    for (size_t i = 1; i < scene.model.bodies.size(); ++i) {
      const Polygon stone = placed(scene.model.bodies[i]);
      CHECK(apart_from(drum, stone));
      inside += strictly_inside(drum.outer_ring(), stone[0]);
      for (size_t j = 1; j < i; ++j) {
        CHECK(apart_from(stone, placed(scene.model.bodies[j])));
      }
    }
    CHECK(inside > 0);
    CHECK(inside < 60);
  }
}

TEST_CASE("blocks of a later fill may lie in the holes of those of an earlier one",
          "[fill][holes]") {
  const Scene scene = scene_of("", R"("fill": [
    { "name": "ring", "material": "rock", "region": [[0, 0], [12, 0], [12, 12], [0, 12]], "count": 4,
      "diameter": 1.9, "angle": 0, "shapes": [ { "polygon": [[0,0],[3,0],[3,3],[0,3]],
        "holes": [ [[0.2,0.2],[2.8,0.2],[2.8,2.8],[0.2,2.8]] ] } ], "arrangement": "lattice" },
    { "name": "stone", "material": "rock", "region": [[0, 0], [12, 0], [12, 12], [0, 12]], "count": 40,
      "diameter": 0.5, "shapes": [ { "quadrilateral": {} } ] } ], )");
  REQUIRE(scene.model.bodies.size() == 44);
  int inside = 0;
  for (size_t i = 4; i < 44; ++i) {
    const Polygon stone = placed(scene.model.bodies[i]);
    for (size_t j = 0; j < i; ++j) {
      const Polygon other = placed(scene.model.bodies[j]);
      CHECK(apart_from(other, stone));
      if (j < 4) inside += strictly_inside(other.outer_ring(), stone[0]);
    }
  }
  CHECK(inside > 5);
}

TEST_CASE("shapes of a fill may have holes", "[fill][holes]") {
  const std::string ring =
      R"({ "polygon": [[0,0],[3,0],[3,3],[0,3]], "holes": [ [[1,0.5],[2.5,0.5],[2.5,2.5],[1,2.5]] ] })";
  for (const char* arrangement : {"random", "lattice", "dense"}) {
    INFO(arrangement);
    const Scene scene = scene_of(
        "", fmt::format(R"("fill": [ {{ "name": "ring", "material": "rock", "arrangement": "{}",
      "region": [[0, 0], [9, 0], [9, 9], [0, 9]], "shapes": [ {}, {{ "polygon_random": {{ "corners": 5 }} }} ],
      "diameter": {{ "uniform": [0.3, 0.9] }}, "count": 40, "angle": "random" }} ], )",
                        arrangement, ring));
    REQUIRE(scene.model.bodies.size() == 40);
    int rings = 0;
    for (const RigidBody& body : scene.model.bodies) {
      const Polygon here = placed(body);
      rings += here.has_holes();
      for (const RigidBody& other : scene.model.bodies) {
        if (&other == &body) continue;
        CHECK(apart_from(placed(other), here));
        if (std::string(arrangement) == "random") continue;
        CHECK_FALSE(strictly_inside(here.outer_ring(), placed(other)[0]));
      }
      if (!here.has_holes()) continue;
      // The diameter is that of the disc of the area without the hole, and the shape is similar.
      CHECK(body.area >= M_PI / 4 * .09 * (1 - 1e-12));
      CHECK(body.area <= M_PI / 4 * .81 * (1 + 1e-12));
      const double side = (here[1] - here[0]).norm();
      CHECK(body.area == Approx(6 * side * side / 9).epsilon(1e-12));
      const Vec2 along = (here[1] - here[0]) / side, up(-along.y(), along.x());
      CHECK((here.ring(1)[0] - here[0] - side / 3 * along - side / 6 * up).norm() < 1e-12);
    }
    CHECK(rings > 5);
    CHECK(rings < 35);
  }
  // Meshes of such blocks.
  const std::string fill =
      R"("fill": [ { "name": "ring", "material": "rock", "region": [[0,0],[9,0],[9,9],[0,9]],
    "shapes": [ )" +
      ring + R"( ], "count": 2, "angle": [0,0], "mesh": { "size": 0.25, "element": ")";
  const Scene meshed = scene_of("", fill + "T3\" } } ], ");
  REQUIRE(meshed.model.deformables.size() == 2);
  CHECK(boundary(meshed.model.deformables[0].mesh).loops.size() == 2);
  const Scene cells = scene_of("", fill + "polygon\" } } ], ");
  REQUIRE(cells.model.deformables.size() == 2);
  for (const DeformableBody& body : cells.model.deformables) {
    CHECK(boundary(body.mesh).loops.size() == 2);
    double area = 0;
    for (int e = 0; e < body.mesh.element_count(); ++e) area += element_area(body.mesh, e);
    CHECK(area ==
          Approx(
              mesh_quality(meshed.model.deformables[&body - &cells.model.deformables[0]].mesh).area)
              .epsilon(1e-12));
  }
  CHECK_THAT(
      error_of("", R"("fill": [ { "name": "s", "material": "rock", "region": [[0,0],[9,0],[9,9]],
    "shapes": [ { "cross": {}, "holes": [] } ], "diameter": 1, "count": 1 } ], )"),
      Contains("/fill/0/shapes/0/holes: belongs to a \"polygon\"; other shapes have no holes"));
}

TEST_CASE("blocks at random may lie in the holes of larger ones of their fill", "[fill][holes]") {
  const Scene scene = scene_of("", R"("fill": [ { "name": "nest", "material": "rock",
      "region": [[0, 0], [9, 0], [9, 9], [0, 9]], "gap": 0.01, "count": 30, "angle": "random",
      "shapes": [ { "polygon": [[0,0],[3,0],[3,3],[0,3]],
        "holes": [ [[0.1,0.1],[1.4,0.1],[1.4,2.9],[0.1,2.9]], [[1.6,0.1],[2.9,0.1],[2.9,2.9],[1.6,2.9]] ] } ],
      "diameter": { "uniform": [0.1, 0.9] } } ], )");
  REQUIRE(scene.model.bodies.size() == 30);
  std::vector<Polygon> bodies;
  for (const RigidBody& body : scene.model.bodies) bodies.push_back(placed(body));
  int nested = 0;
  for (const Polygon& inner : bodies) {
    int around = 0;
    for (const Polygon& outer : bodies) {
      if (&outer == &inner) continue;
      CHECK(apart_from(outer, inner));
      around += strictly_inside(outer.outer_ring(), inner[0]);
    }
    nested += around > 0;
  }
  CHECK(nested > 0);
}

TEST_CASE("the region of a fill may be a file with holes", "[fill][holes]") {
  const Folder folder;
  folder.write("r.wkt", "POLYGON ((0 0, 4 0, 4 4, 0 4), (1 1, 3 1, 3 3, 1 3))");
  const std::string fill = R"("fill": [ { "name": "s", "material": "rock", "region": "r.wkt",
    "shapes": [ { "quadrilateral": {} } ], "diameter": 0.2, "solid_fraction": 0.3 } ], )";
  const Scene scene = read_scene(folder.write("scene.json", scene_with("", fill)));
  double area = 0;
  const std::vector<Vec2> hole{{1, 1}, {3, 1}, {3, 3}, {1, 3}};
  for (const RigidBody& body : scene.model.bodies) {
    area += body.area;
    CHECK_FALSE(strictly_inside(hole, body.position + scene.model.origin));
  }
  CHECK(area == Approx(.3 * 12).margin(M_PI / 4 * .04));
  const std::string cells = R"("fill": [ { "name": "s", "material": "rock", "region": "r.wkt",
    "arrangement": "voronoi", "count": 5 } ], )";
  area = 0;
  for (const RigidBody& body :
       read_scene(folder.write("scene.json", scene_with("", cells))).model.bodies) {
    area += body.area;
  }
  CHECK(area == Approx(12).epsilon(1e-12));
}

TEST_CASE("regions count bodies and areas without holes", "[population][holes]") {
  // A frame whose hole is the middle of the region, which has a hole itself.
  const Scene scene = scene_of(kDrum, R"("regions": {
    "all": { "polygon": [[-4,-4],[4,-4],[4,4],[-4,4]] },
    "right": { "polygon": [[0,-4],[4,-4],[4,4],[0,4]], "holes": [ [[1,-1],[3.5,-1],[3.5,1],[1,1]] ] } }, )");
  const Model& model = scene.model;
  State state(Layout{1, 0});
  state.pose(0) << model.bodies[0].position, 0;
  const std::vector<RegionSums> sums =
      region_sums(model, state, {}, {}, body_statistics(model, state, {}, {}));
  const double drum = 36 - 16 + .4;
  CHECK(sums[0].solid_area == Approx(drum).epsilon(1e-14));
  CHECK(sums[0].area == 64);
  CHECK(sums[1].solid_area == Approx(drum / 2 - 2).epsilon(1e-14));  // a strip of 1 x 2 is out
  CHECK(sums[1].area == 32 - 5);
}

}  // namespace holed_bodies
