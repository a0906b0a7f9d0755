// The mesh of a body as a scene gives it, and what is refused there.
#include "lib/scene/mesh_reader.hpp"

#include "tests/folder.hpp"
#include "tests/mesh/mesh_laws.hpp"
#include "tests/support.hpp"

using namespace apothem;
using namespace apothem::test;
using Catch::Contains;

namespace {

// As in a scene beside data/meshes.
MeshSpec read(const std::string& text, const std::string& file = kSource + "/data/scene.json") {
  return read_mesh(JsonReader(file), parse_json(text, file));
}

std::string refusal(const std::string& text) {
  try {
    read(text);
    return "";
  } catch (const SceneError& error) {
    return error.what();
  }
}

}  // namespace

TEST_CASE("every way to make a mesh", "[mesh][scene]") {
  struct Case {
    const char* text;
    double area;
    int elements;
    ElementKind element;
  };
  using K = ElementKind;
  const Case cases[]{
      {R"({"rectangle": {"size": [10, 1], "cells": [20, 2]}})", 10, 40, K::quad4},
      {R"({"rectangle": {"size": [10, 1], "cells": [20, 2], "origin": [1, 2]}, "element": "T3"})",
       10, 80, K::tri3},
      {R"({"rectangle": {"size": [2, 1], "cells": [2, 2]}, "element": "Q4-full"})", 2, 4,
       K::quad4_full},
      {R"({"rectangle": {"size": [2, 1], "cells": [2, 2]}, "element": "polygon"})", 2, 4,
       K::polygon},
      {R"({"disc": {"radius": 0.5, "cells": 4}})", 8 * .25 * std::sin(std::acos(-1.) / 8), 48,
       K::quad4},
      {R"({"disc": {"radius": 0.5, "centre": [3, 4], "cells": 4, "grading": 2}, "element": "T3"})",
       8 * .25 * std::sin(std::acos(-1.) / 8), 96, K::tri3},
      {R"({"half_disc": {"radius": 2, "fine": 1, "cells": 1}})", 5.998757, 0, K::quad4},
      {R"({"half_disc": {"radius": 2, "fine": 0.5, "cells": 40, "growth": 1.05, "pole": [1, 2]},
           "mirror": {"y": 3}, "element": "T3"})",
       6.281609, 0, K::tri3},
      {R"({"rectangle": {"size": [10, 1], "cells": [20, 2]}, "mirror": {"x": -1}})", 10, 40,
       K::quad4},
      {R"({"fill": {"polygon": [[0,0],[1,0],[0,1]], "size": 0.1}})", .5, 0, K::quad4},
      {R"({"fill": {"polygon": [[0,0],[1,0],[0,1]], "size": 0.1}, "element": "T3"})", .5, 0,
       K::tri3},
      {R"({"fill": {"file": "polygons/boulder.json", "size": 0.5}})", 7.37375, 0, K::quad4},
      {R"({"fill": {"polygon": "polygons/boulder.json", "size": 0.5}})", 7.37375, 0, K::quad4},
      {R"({"voronoi": {"polygon": [[0,0],[2,0],[0,1]], "cells": 30, "seed": 2, "lloyd": 5,
           "shortest_edge": 0.2}})",
       1, 30, K::polygon},
      {R"({"voronoi": {"size": [2, 1], "origin": [-1, 0], "cells": 20}})", 2, 20, K::polygon},
      {R"({"file": "meshes/mixed.msh"})", 3, 4, K::polygon},
      {R"({"file": "meshes/quarter-disc.msh", "element": "Q4"})", .780361, 95, K::quad4},
      {R"({"file": "meshes/quarter-disc-triangles.msh"})", .780361, 170, K::tri3},
  };
  for (const Case& c : cases) {
    INFO(c.text);
    const MeshSpec spec = read(c.text);
    check_laws(spec.mesh, c.area, 0, 1e-5);
    if (c.elements > 0) CHECK(spec.mesh.element_count() == c.elements);
    CHECK(spec.element == c.element);
    CHECK_FALSE(spec.mesh.groups.empty());
  }
  const MeshSpec holed = read(
      R"({"fill": {"polygon": [[0,0],[4,0],[4,4],[0,4]], "holes": [[[1,1],[2,1],[1,2]]], "size": 1}})");
  check_laws(holed.mesh, 15.5, 1);
}

TEST_CASE("a mesh that cannot be is refused at its place", "[mesh][scene]") {
  const std::pair<const char*, const char*> cases[]{
      {"{}", "must give one of rectangle, disc"},
      {"[]", "must be an object"},
      {R"({"rectangel": {}})",
       "/rectangel: unknown key \"rectangel\"; did you mean \"rectangle\"?"},
      {R"({"disc": {"radius": 1, "cells": 4}, "file": "x.msh"})",
       "/file: a mesh is made in one way, and \"disc\" is given"},
      {R"({"rectangle": {"size": [1, 1]}})", "/rectangle: missing key \"cells\""},
      {R"({"rectangle": {"size": [1, 1], "cells": 4}})", "/rectangle/cells: must be an array"},
      {R"({"rectangle": {"size": [1, 1], "cells": [4, 2.5]}})",
       "/rectangle/cells/1: must be a whole"},
      {R"({"rectangle": {"size": [1, 0], "cells": [4, 2]}})",
       "/rectangle: the sides of a rectangle"},
      {R"({"rectangle": {"size": [1, 1], "cells": [0, 2]}})", "/rectangle: there must be 1 to 1e8"},
      {R"({"rectangle": {"size": [1, 1], "cells": [1, 2], "orgin": [0, 0]}})",
       "did you mean \"origin\"?"},
      {R"({"disc": {"radius": -1, "cells": 4}})", "/disc/radius: must be positive"},
      {R"({"disc": {"radius": 1, "cells": 0}})", "/disc: there must be 1 to 5000 cells"},
      {R"({"disc": {"radius": 1, "cells": 4, "grading": 0}})", "/disc: the grading"},
      {R"({"half_disc": {"radius": 1, "cells": 4}})", "/half_disc: missing key \"fine\""},
      {R"({"half_disc": {"radius": 1, "fine": 0.6, "cells": 4}})", "/half_disc: the fine block"},
      {R"({"rectangle": {"size": [1, 1], "cells": [1, 2]}, "mirror": {}})",
       "/mirror: must give the line"},
      {R"({"rectangle": {"size": [1, 1], "cells": [1, 2]}, "mirror": {"x": 0, "y": 0}})",
       "/mirror: must give the line"},
      {R"({"rectangle": {"size": [1, 1], "cells": [1, 2]}, "mirror": {"x": 1e300}})",
       "/mirror: node 0 has a coordinate beyond 1e60"},
      {R"({"fill": {"size": 1}})", "/fill: missing key \"polygon\""},
      {R"({"fill": {"polygon": [[0,0],[1,0],[0,1]], "size": 0}})", "/fill/size: must be positive"},
      {R"({"fill": {"polygon": [[0,0],[1,0],[0,1]], "file": "x", "size": 1}})",
       "/fill/file: the polygon is given twice"},
      {R"({"fill": {"polygon": [[0,0],[1,1],[1,0],[0,1]], "size": 1}})",
       "/fill/polygon/2: not a usable polygon"},
      {R"({"fill": {"file": "none.json", "size": 1}})", "/fill/file: "},
      {R"({"fill": {"polygon": [[0,0],[4,0],[0,4]], "holes": [[[3,3],[5,3],[5,5]]], "size": 1}})",
       "/fill/holes/0/0: not a usable polygon: hole 0 "},
      {R"({"fill": {"polygon": [[0,0],[9,0],[0,9]], "holes": [[[1,1],[2,1],[3,1]]], "size": 1}})",
       "/fill/holes/0/0: not a usable polygon: hole 0: vertex 0 is a spike"},
      {R"({"voronoi": {"polygon": [[0,0],[1,0],[0,1]], "cells": 0}})",
       "/voronoi: the number of cells"},
      {R"({"voronoi": {"size": [1, -1], "cells": 3}})", "/voronoi/size: must be two positive"},
      {R"({"voronoi": {"size": [1, 1], "cells": 3}, "element": "Q4"})",
       "/element: \"Q4\" has 4 corners, but element "},
      {R"({"file": "meshes/mixed.msh", "element": "T3"})",
       "/element: \"T3\" has 3 corners, but element 0 of the mesh has 4; \"polygon\" fits every"},
      {R"({"file": "meshes/mixed.msh", "element": "T4"})", "/element: unknown choice \"T4\""},
      {R"({"file": "meshes/none.msh"})", "none.msh: cannot be opened"},
      {R"({"file": 3})", "/file: must be a string"},
  };
  for (const auto& [text, message] : cases) {
    INFO(text);
    const std::string error = refusal(text);
    CHECK_THAT(error, Contains(message));
    CHECK_THAT(error, Contains("scene.json:1"));
  }
}

TEST_CASE("a file with holes is filled around them", "[mesh][scene][holes]") {
  const Folder folder;
  folder.write("a.wkt", "POLYGON ((0 0, 4 0, 4 4, 0 4), (1 1, 2 1, 2 2, 1 2))");
  const std::string scene = folder / "scene.json";
  const std::string fill = R"({"fill": {"file": "a.wkt", "size": 0.5, )";
  check_laws(read(fill + R"("holes": []}})", scene).mesh, 15, 1);
  const Mesh mesh = read(fill + R"("holes": [[[3,3],[3.5,3],[3,3.5]]]}})", scene).mesh;
  check_laws(mesh, 15 - .125, 2);
  CHECK(std::ranges::count(mesh.groups, "hole-1", &MeshGroup::name) == 1);
  const Mesh cells = read(R"({"voronoi": {"file": "a.wkt", "cells": 30,
    "holes": [[[3,3],[3.5,3],[3,3.5]]], "convex": true, "smallest_angle": 0.5}})",
                          scene)
                         .mesh;
  check_laws(cells, 15 - .125, 2);
  CHECK(mesh_quality(cells).not_convex == 0);
  CHECK(mesh_quality(cells).smallest_angle > .49);
  CHECK(std::ranges::count(cells.groups, "hole-1", &MeshGroup::name) == 1);
  CHECK_THROWS_WITH(
      read(R"({"voronoi": {"size": [1, 1], "cells": 3, "holes": []}})", scene),
      Contains("/voronoi/holes: belongs to a \"polygon\"; give the rectangle as one"));
  CHECK_THROWS_WITH(read(R"({"voronoi": {"size": [1, 1], "cells": 3, "convex": 1}})", scene),
                    Contains("/voronoi/convex: must be true or false"));
  CHECK_THROWS_WITH(
      read(R"({"voronoi": {"size": [1, 1], "cells": 3, "smallest_angle": 2}})", scene),
      Contains("/voronoi: the smallest angle must be between 0 and pi/3"));
}

TEST_CASE("only polygon elements may be quadrilaterals that are not convex", "[mesh][scene]") {
  const Folder folder;
  folder.write("dart.msh",
               "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 .2 .2 0\n"
               "4 0 1 0\n$EndNodes\n$Elements\n1\n1 3 2 0 1 1 2 3 4\n$EndElements\n");
  const std::string scene = folder / "scene.json";
  CHECK_THROWS_WITH(read(R"({"file": "dart.msh"})", scene),
                    Contains("dart.msh:13: element 0 is a quadrilateral with a corner of 180"));
  const MeshSpec spec = read(R"({"file": "dart.msh", "element": "polygon"})", scene);
  CHECK(spec.mesh.element_count() == 1);
  CHECK(spec.element == ElementKind::polygon);
}
