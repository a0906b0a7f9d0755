// Fills of scenes: bodies from shapes, sizes, and arrangements.
#include <catch2/catch.hpp>

#include "geometry/meshing/cell_shapes.hpp"
#include "geometry/polygon/predicates.hpp"
#include "lib/model/rotation.hpp"
#include "lib/scene/scene.hpp"
#include "tests/folder.hpp"
#include "tests/support.hpp"

using namespace apothem;
using namespace apothem::test;

namespace fills {
namespace {

std::string scene_with(const std::string& fill, const std::string& bodies = "") {
  return R"({ "materials": { "rock": { "density": 2000, "young": 1e9, "poisson": 0.2 } },
    "contact": { "normal_stiffness": 1e8 },)" +
         (bodies.empty() ? "" : "\"bodies\": [" + bodies + "],") + R"( "fill": [ { "name": "stone",
      "material": "rock", "region": [[0, 0], [4, 0], [4, 4], [0, 4]], )" +
         fill + R"( } ], "time": { "end": 1 } })";
}

Model model_of(const std::string& fill, const std::string& bodies = "") {
  const Folder folder;
  return read_scene(folder.write("scene.json", scene_with(fill, bodies))).model;
}

std::string error_of(const std::string& fill, const std::string& bodies = "") {
  try {
    model_of(fill, bodies);
  } catch (const SceneError& error) {
    return error.what();
  }
  return "";
}

std::vector<Vec2> ring_of(const RigidBody& body) {
  std::vector<Vec2> ring = body.potential.vertices;
  for (Vec2& v : ring) v = body.position + turned(v, body.angle);
  return ring;
}

bool exactly_apart(const std::vector<Vec2>& a, const std::vector<Vec2>& b) {
  for (size_t i = 0; i < a.size(); ++i) {
    for (size_t j = 0; j < b.size(); ++j) {
      if (segments_meet(a[i], a[(i + 1) % a.size()], b[j], b[(j + 1) % b.size()])) return false;
    }
  }
  return !strictly_inside(a, b[0]) && !strictly_inside(b, a[0]);
}

}  // namespace

TEST_CASE("a fill makes bodies of the shapes and sizes that it names", "[fill]") {
  const Model model =
      model_of(R"("shapes": [ { "quadrilateral": {} }, { "cross": { "arm": 1 }, "weight": 2 },
    { "polygon": [[0, 0], [0.2, 0], [0, 0.2]] }, { "polygon_random": { "corners": [5, 8], "aspect": [1, 2] } } ],
    "diameter": { "uniform": [0.1, 0.2] }, "count": 120, "seed": 4, "velocity": [1, -2], "spin": 3)");
  REQUIRE(model.bodies.size() == 120);
  size_t crosses = 0;
  for (size_t i = 0; i < 120; ++i) {
    const RigidBody& b = model.bodies[i];
    CHECK(b.name == "stone-" + std::to_string(i));
    const double d = std::sqrt(4 * b.area / M_PI);
    CHECK((d > .1 && d < .2));
    CHECK(b.velocity == Vec2(1, -2));
    CHECK(b.spin == 3);
    crosses += b.potential.size() == 12;
    for (size_t j = 0; j < i; ++j) CHECK(exactly_apart(ring_of(b), ring_of(model.bodies[j])));
  }
  CHECK(crosses > 30);
  CHECK(crosses < 70);
}

TEST_CASE("fills stay clear of bodies, of meshes, and of each other", "[fill]") {
  const Folder folder;
  const std::string quads = R"("shapes": [ { "quadrilateral": {} } ], "diameter": 0.3)";
  const Scene scene = read_scene(folder.write("scene.json", R"({
    "materials": { "rock": { "density": 2000, "young": 1e9, "poisson": 0.2 } },
    "contact": { "normal_stiffness": 1e8 },
    "bodies": [ { "name": "big", "material": "rock", "polygon": [[0, 0], [2, 0], [2, 2], [0, 2]], "position": [2, 2], "angle": 0.5 },
      { "name": "mesh", "material": "rock", "mesh": { "rectangle": { "size": [1, 1], "cells": [2, 2] } }, "position": [3.3, 3.3] } ],
    "fill": [ { "name": "a", "material": "rock", "region": [[0, 0], [4, 0], [4, 4], [0, 4]], "count": 30, )" +
                                                                quads + R"( },
              { "name": "b", "material": "rock", "region": [[0, 0], [4, 0], [4, 4], [0, 4]], "count": 20, )" +
                                                                quads + R"( } ],
    "time": { "end": 1 } })"));
  const std::vector<RigidBody>& bodies = scene.model.bodies;
  REQUIRE(bodies.size() == 51);
  for (size_t i = 0; i < bodies.size(); ++i) {
    for (size_t j = 0; j < i; ++j) CHECK(exactly_apart(ring_of(bodies[i]), ring_of(bodies[j])));
    if (i > 0) {
      CHECK(exactly_apart(ring_of(bodies[i]), {{2.8, 2.8}, {3.8, 2.8}, {3.8, 3.8}, {2.8, 3.8}}));
    }
  }
}

TEST_CASE("a solid fraction is met to half a block", "[fill]") {
  const Model model = model_of(
      R"("shapes": [ { "cross": {} } ], "diameter": { "uniform_area": [0.1, 0.3] }, "solid_fraction": 0.2)");
  double solid = 0;
  for (const RigidBody& b : model.bodies) solid += b.area;
  CHECK(std::abs(solid - .2 * 16) < M_PI / 8 * .09);
}

TEST_CASE("size distributions have the moments that they promise", "[fill][slow]") {
  const auto diameters = [](const std::string& diameter) {
    const Model model = model_of(
        R"("shapes": [ { "quadrilateral": {} } ], "count": 2000, "diameter": )" + diameter);
    std::vector<double> d;
    for (const RigidBody& b : model.bodies) d.push_back(std::sqrt(4 * b.area / M_PI));
    return d;
  };
  const auto mean = [](const std::vector<double>& d, auto&& f) {
    double sum = 0;
    for (const double x : d) sum += f(x) / static_cast<double>(d.size());
    return sum;
  };
  const auto area = [](double d) { return d * d; };
  const std::vector<double> even = diameters(R"({ "uniform_area": [0.02, 0.04] })");
  CHECK(mean(even, area) == Approx(1e-3).epsilon(.02));
  const std::vector<double> table = diameters(R"({ "table": [[0.02, 3], [0.04, 1]] })");
  CHECK(mean(table, [](double x) { return x > .03 ? 1. : 0.; }) == Approx(.25).margin(.04));
  const std::vector<double> skew =
      diameters(R"({ "lognormal": { "median": 0.02, "sigma": 0.3, "between": [0.005, 0.05] } })");
  CHECK(mean(skew, [](double x) { return std::log(x / .02); }) == Approx(0).margin(.03));
  CHECK(mean(skew, [](double x) { return std::pow(std::log(x / .02), 2); }) ==
        Approx(.09).epsilon(.1));
}

TEST_CASE("blocks of a fill can have meshes", "[fill]") {
  for (const char* element : {"Q4", "T3", "polygon"}) {
    const Model model = model_of(
        std::string(R"("shapes": [ { "cross": {} }, { "quadrilateral": {} } ], "diameter": 0.4,
      "count": 6, "mesh": { "size": 0.1, "element": ")") +
        element + "\" }");
    REQUIRE(model.deformables.size() == 6);
    for (const DeformableBody& b : model.deformables) CHECK(b.mesh.element_count() > 4);
  }
}

TEST_CASE("Voronoi cells and a dense packing fill a region", "[fill][slow]") {
  const Model cells = model_of(R"("arrangement": "voronoi", "count": 50)");
  double area = 0;
  for (const RigidBody& b : cells.bodies) area += b.area;
  CHECK(area == Approx(16).epsilon(1e-12));
  const Model drilled = model_of(R"("arrangement": "voronoi", "count": 9,
    "holes": [ [[1, 2], [2, 2], [2, 3]], [[2.5, 3], [3, 3], [3, 3.5], [2.5, 3.5]] ])");
  CHECK(drilled.bodies.size() >= 9);
  area = 0;
  for (const RigidBody& b : drilled.bodies) area += b.area;
  CHECK(area == Approx(16 - .75).epsilon(1e-12));
  // Beside the corners of a hole, cells are not convex or have small angles.
  const auto cells_with = [](const std::string& how) {
    std::vector<Polygon> found;
    for (const RigidBody& b : model_of(R"("arrangement": "voronoi", "count": 12,
      "holes": [ [[1, 1], [2.9, 1.2], [2.7, 3.1], [1.2, 2.8]] ])" +
                                       how)
                                  .bodies) {
      found.emplace_back(ring_of(b));
    }
    return found;
  };
  const auto not_convex = [](const Polygon& cell) { return !cell.is_convex(); };
  const auto smallest = [](const std::vector<Polygon>& of) {
    double angle = M_PI;
    for (const Polygon& cell : of) {
      for (int i = 0; i < cell.size(); ++i) {
        angle = std::min(angle, corner_angle(cell[i] - cell.before(i), cell.after(i) - cell[i]));
      }
    }
    return angle;
  };
  const std::vector<Polygon> plain = cells_with("");
  CHECK(std::ranges::any_of(plain, not_convex));
  const std::vector<Polygon> convex = cells_with(R"(, "convex": true)");
  CHECK(std::ranges::none_of(convex, not_convex));
  CHECK(smallest(cells_with(R"(, "convex": true, "smallest_angle": 0.9)")) >
        smallest(convex) + .05);
  const Model dense = model_of(R"("arrangement": "dense", "shapes": [ { "quadrilateral": {} } ],
    "diameter": 0.5, "solid_fraction": 0.7)");
  area = 0;
  for (const RigidBody& b : dense.bodies) area += b.area;
  CHECK(area == Approx(.7 * 16).margin(.1));
  for (size_t i = 0; i < dense.bodies.size(); ++i) {
    for (size_t j = 0; j < i; ++j) {
      CHECK(exactly_apart(ring_of(dense.bodies[i]), ring_of(dense.bodies[j])));
    }
  }
}

TEST_CASE("a repeated fill makes the bodies of all batches", "[fill]") {
  const Model model = model_of(R"("shapes": [ { "quadrilateral": {} } ], "diameter": 0.3,
    "count": 10, "repeat": { "times": 4, "every": 0.5 })");
  CHECK(model.bodies.size() == 40);
  REQUIRE(model.inflows.size() == 1);
  CHECK(model.inflows[0].every == .5);
  REQUIRE(model.inflows[0].batches.size() == 3);
  CHECK(model.inflows[0].batches[1] ==
        std::vector<BodyIndex>{20, 21, 22, 23, 24, 25, 26, 27, 28, 29});
  CHECK(model.bodies[0].position != model.bodies[10].position);
}

TEST_CASE("batches of a repeated fill share the region, later fills keep clear of the first",
          "[fill]") {
  // Each batch alone fills 0.45 of the region: two do not fit side by side.
  const std::string quads = R"("shapes": [ { "quadrilateral": {} } ], "diameter": 0.3, )";
  const Model full =
      model_of(quads + R"("solid_fraction": 0.45, "repeat": { "times": 3, "every": 0.5 })");
  REQUIRE(full.inflows.size() == 1);
  CHECK(full.inflows[0].batches.size() == 2);
  CHECK(full.bodies.size() > 3 * 100);
  for (size_t b = 0; b < 3; ++b) {
    const size_t n = full.bodies.size() / 3;
    for (size_t i = b * n; i < (b + 1) * n; ++i) {
      for (size_t j = b * n; j < i; ++j) {
        REQUIRE(exactly_apart(ring_of(full.bodies[i]), ring_of(full.bodies[j])));
      }
    }
  }
  // The second fill must miss the first batch of the first one, which is there at time 0.
  const Model two = model_of(quads + R"("count": 40, "repeat": { "times": 2 } }, {
    "name": "pebble", "material": "rock", "region": [[0, 0], [4, 0], [4, 4], [0, 4]], )" +
                             quads + R"("count": 40)");
  REQUIRE(two.bodies.size() == 120);
  for (size_t i = 80; i < 120; ++i) {
    for (size_t j = 0; j < 40; ++j) {
      REQUIRE(exactly_apart(ring_of(two.bodies[i]), ring_of(two.bodies[j])));
    }
  }
}

TEST_CASE("what a fill cannot do is one error with its place and a remedy", "[fill]") {
  using Catch::Matchers::Contains;
  const std::string quads = R"("shapes": [ { "quadrilateral": {} } ], )";
  CHECK_THAT(error_of(quads + R"("diameter": 0.5, "count": 500)"),
             Contains("/fill/0: ") && Contains(" of 500 blocks could be placed"));
  CHECK_THAT(
      error_of(R"("arrangement": "dense", )" + quads + R"("diameter": 1, "solid_fraction": 0.999)"),
      Contains("blocks could be placed") && Contains("of their size"));
  CHECK_THAT(error_of(quads + R"("diameter": 0.5)"), Contains("\"count\" or \"solid_fraction\""));
  CHECK_THAT(error_of(quads + R"("count": 5)"), Contains("diameter"));
  CHECK_THAT(error_of(quads + R"("count": 5, "diameter": -1)"), Contains("/fill/0/diameter"));
  CHECK_THAT(error_of(quads + R"("count": 5, "diameter": 1, "sead": 1)"),
             Contains("did you mean \"seed\""));
  CHECK_THAT(error_of(quads + R"("count": 5, "diameter": { "uniform": [2, 1] })"),
             Contains("ascending"));
  CHECK_THAT(
      error_of(
          R"("shapes": [ { "quadrilateral": { "angles": [1.6, 2] } } ], "count": 5, "diameter": 1)"),
      Contains("pi/2"));
  CHECK_THAT(error_of(R"("shapes": [ { "polygon": [[0,0],[1,1],[1,0],[0,1]] } ], "count": 5)"),
             Contains("/fill/0/shapes/0/polygon"));
  CHECK_THAT(error_of(quads + R"("count": 5, "diameter": 1, "holes": [[[1,1],[5,1],[5,2]]])"),
             Contains("inside the region"));
  CHECK_THAT(
      error_of(quads + R"("count": 2, "diameter": 0.5)",
               R"({ "name": "stone-1", "material": "rock", "polygon": [[9,9],[10,9],[10,10]] })"),
      Contains("already the name of another body"));
  CHECK_THAT(error_of(quads + R"("count": 5, "diameter": 1, "convex": true)"),
             Contains("/fill/0/convex") && Contains("is for the arrangement \"voronoi\""));
  CHECK_THAT(error_of(R"("arrangement": "voronoi", "count": 10, "smallest_angle": 2)"),
             Contains("/fill/0"));
  CHECK_THAT(error_of(R"("arrangement": "voronoi", "count": 10)",
                      R"({ "name": "a", "material": "rock", "polygon": [[1,1],[2,1],[2,2]] })"),
             Contains("overlaps a body"));
}

}  // namespace fills
