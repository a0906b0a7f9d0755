// The reader of gmsh's text format.
#include <fmt/format.h>

#include "apps/cases/samples.hpp"
#include "lib/mesh/disc_mesh.hpp"
#include "lib/mesh/gmsh.hpp"
#include "lib/mesh/rectangle_mesh.hpp"
#include "lib/scene/mesh_file.hpp"
#include "tests/folder.hpp"
#include "tests/mesh/mesh_laws.hpp"
#include "tests/support.hpp"

using namespace apothem;
using namespace apothem::test;
using Catch::Contains;

namespace {

std::string row(int tag, const Vec2& p) { return fmt::format("{} {} {} 0\n", tag, p.x(), p.y()); }

std::string corners_row(const Mesh& mesh, int e) {
  std::string text;
  for (const int c : mesh.element(e)) text += fmt::format(" {}", c + 100);
  return text + "\n";
}

// All elements of a mesh in group "all", its line groups as they are, node i with the tag i + 100.
std::string version_2(const Mesh& mesh) {
  std::string text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n";
  text += fmt::format("{}\n2 1 \"all\"\n", mesh.groups.size() + 1);
  for (size_t g = 0; g < mesh.groups.size(); ++g) {
    text += fmt::format("1 {} \"{}\"\n", g + 2, mesh.groups[g].name);
  }
  text += fmt::format("$EndPhysicalNames\n$Nodes\n{}\n", mesh.nodes.size());
  for (size_t i = 0; i < mesh.nodes.size(); ++i)
    text += row(static_cast<int>(i) + 100, mesh.nodes[i]);
  std::string elements;
  int tag = 0;
  for (size_t g = 0; g < mesh.groups.size(); ++g) {
    for (const auto& [a, b] : mesh.groups[g].edges) {  // the wrong way round
      elements += fmt::format("{} 1 2 {} 5 {} {}\n", ++tag, g + 2, b + 100, a + 100);
    }
  }
  for (int e = 0; e < mesh.element_count(); ++e) {
    elements +=
        fmt::format("{} {} 2 1 6", ++tag, mesh.element(e).size() - 1) + corners_row(mesh, e);
  }
  return text + fmt::format("$EndNodes\n$Elements\n{}\n{}$EndElements\n", tag, elements);
}

// Every group is a curve, the elements one surface; Windows line ends.
std::string version_4(const Mesh& mesh) {
  const size_t curves = mesh.groups.size();
  std::string text = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n";
  text += fmt::format("{}\n2 1 \"all\"\n", curves + 1);
  for (size_t g = 0; g < curves; ++g)
    text += fmt::format("1 {} \"{}\"\n", g + 2, mesh.groups[g].name);
  text += fmt::format("$EndPhysicalNames\n$Entities\n0 {} 1 0\n", curves);
  for (size_t g = 0; g < curves; ++g) text += fmt::format("{} 0 0 0 1 1 0 1 {} 0\n", g + 1, g + 2);
  text += fmt::format("1 0 0 0 1 1 0 1 1 0\n$EndEntities\n$Nodes\n1 {0} 100 {1}\n2 1 0 {0}\n",
                      mesh.nodes.size(), mesh.nodes.size() + 99);
  for (size_t i = 0; i < mesh.nodes.size(); ++i) text += fmt::format("{}\n", i + 100);
  for (const Vec2& p : mesh.nodes) text += fmt::format("{} {} 0\n", p.x(), p.y());
  std::string blocks;
  int tag = 0;
  for (size_t g = 0; g < curves; ++g) {
    blocks += fmt::format("1 {} 1 {}\n", g + 1, mesh.groups[g].edges.size());
    for (const auto& [a, b] : mesh.groups[g].edges) {
      blocks += fmt::format("{} {} {}\n", ++tag, a + 100, b + 100);
    }
  }
  blocks += fmt::format("2 1 {} {}\n", mesh.element(0).size() - 1, mesh.element_count());
  for (int e = 0; e < mesh.element_count(); ++e)
    blocks += fmt::format("{}", ++tag) + corners_row(mesh, e);
  text += fmt::format("$EndNodes\n$Elements\n{} {} 1 {}\n{}$EndElements\n", curves + 1, tag, tag,
                      blocks);
  std::string windows;
  for (const char c : text) windows += c == '\n' ? std::string("\r\n") : std::string(1, c);
  return windows;
}

void check_same(const Mesh& read, const Mesh& mesh) {
  CHECK(read.nodes == mesh.nodes);
  CHECK(read.corners == mesh.corners);
  CHECK(read.first == mesh.first);
  for (const MeshGroup& wanted : mesh.groups) {
    CHECK(group(read, wanted.name).edges == wanted.edges);
    CHECK(group(read, wanted.name).nodes == wanted.nodes);
  }
  CHECK(group(read, "all").nodes.size() == mesh.nodes.size());
  CHECK(group(read, "all").edges.empty());
  CHECK(group(read, "all").elements.size() == static_cast<size_t>(mesh.element_count()));
  CHECK(read.groups.size() == mesh.groups.size() + 1);
}

std::string sample(const std::string& name) { return kSource + "/data/meshes/" + name + ".msh"; }

const std::string& mixed() {
  static const std::string text = content(sample("mixed"));
  return text;
}

// The message and line for the hand-written sample with one change.
std::pair<std::string, int> refusal(const std::string& what, const std::string& by) {
  std::string text = mixed();
  const size_t at = text.find(what);
  REQUIRE(at != std::string::npos);
  try {
    parse_gmsh(text.replace(at, what.size(), by));
    return {"", -1};
  } catch (const BadMeshText& error) {
    return {error.what(), error.line()};
  }
}

}  // namespace

TEST_CASE("meshes come back from gmsh's formats to the last bit", "[mesh]") {
  for (const ElementShape shape : {ElementShape::quadrilateral, ElementShape::triangle}) {
    for (const Mesh& mesh : {rectangle_mesh({1, .7}, {5, 3}, {.1, .3}, shape),
                             disc_mesh({.1, .2}, 1. / 3, {4}, shape)}) {
      check_same(parse_gmsh(version_2(mesh)), mesh);
      check_same(parse_gmsh(version_4(mesh)), mesh);
    }
  }
}

TEST_CASE("files made by gmsh", "[mesh]") {
  for (const char* name : {"quarter-disc", "quarter-disc-triangles"}) {
    const Mesh mesh = read_mesh_file(sample(name));
    // The polygon under the arc: between 16 sides or so and the disc.
    const double area = mesh_quality(mesh).area;
    CHECK(area < std::acos(-1.) / 4);
    CHECK(area > .985 * std::acos(-1.) / 4);
    check_laws(mesh, area);
    check_share_boundary(mesh, {"bottom", "arc", "left"});
    for (const int node : group(mesh, "arc").nodes)
      CHECK(std::abs(mesh.nodes[node].norm() - 1) < 1e-7);
    for (const int node : group(mesh, "bottom").nodes) CHECK(mesh.nodes[node].y() == 0);
    CHECK(group(mesh, "disc").nodes.size() == mesh.nodes.size());
    REQUIRE(group(mesh, "centre").nodes.size() == 1);
    CHECK(mesh.nodes[group(mesh, "centre").nodes[0]] == Vec2(0, 0));
  }
  CHECK(mesh_quality(read_mesh_file(sample("quarter-disc"))).quadrilaterals > 50);
  CHECK(mesh_quality(read_mesh_file(sample("quarter-disc-triangles"))).quadrilaterals == 0);
}

TEST_CASE("mixed elements, and a point of the geometry that is no node", "[mesh]") {
  const Mesh mesh = read_mesh_file(sample("mixed"));
  check_laws(mesh, 3);
  CHECK(mesh.nodes.size() == 8);
  CHECK(mesh_quality(mesh).triangles == 2);
  CHECK(mesh_quality(mesh).quadrilaterals == 2);
  CHECK(group(mesh, "corner").nodes == std::vector<int>{0});
  CHECK(group(mesh, "left").edges == std::vector<std::array<int, 2>>{{4, 0}});
  CHECK(group(mesh, "squares").nodes == std::vector<int>{0, 1, 2, 4, 5, 6});
  CHECK(group(mesh, "squares").elements == std::vector<int>{0, 1});
  CHECK(group(mesh, "left").elements.empty());
}

TEST_CASE("clockwise elements are turned, repeated ones are one", "[mesh]") {
  std::string text = mixed();
  const std::string square = "4 3 2 9 1 10 11 21 20\n";
  text.replace(text.find(square), square.size(), "4 3 2 9 1 10 20 21 11\n44 3 2 8 1 10 20 21 11\n");
  text.replace(text.find("$Elements\n7"), 11, "$Elements\n8");
  const Mesh mesh = parse_gmsh(text);
  check_laws(mesh, 3);
  CHECK(mesh.element_count() == 4);
  CHECK(group(mesh, "surface-8").nodes == std::vector<int>{0, 1, 4, 5});
}

TEST_CASE("a partitioned mesh has the groups of the whole", "[mesh]") {
  // A square in two triangles, each of them a part, with two parts of the curve around it. The
  // curve between the parts has the tag of the surface's group, which is that of no curve.
  const std::string text =
      "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n"
      "$PhysicalNames\n3\n1 1 \"rim\"\n1 2 \"other\"\n2 2 \"body\"\n$EndPhysicalNames\n"
      "$Entities\n0 1 1 0\n1 0 0 0 1 1 0 1 1 0\n1 0 0 0 1 1 0 1 2 1 1\n$EndEntities\n"
      "$PartitionedEntities\n2\n1\n7 1\n1 3 2 0\n3 1 1 2 1 2 0 0 0 1 1\n"
      "2 1 1 1 1 0 0 0 1 1 0 1 1 0\n3 1 1 1 2 0 0 0 1 1 0 1 1 0\n4 2 1 2 1 2 0 0 0 1 1 0 1 2 0\n"
      "2 2 1 1 1 0 0 0 1 1 0 1 2 3 2 3 4\n3 2 1 1 2 0 0 0 1 1 0 1 2 3 2 3 4\n"
      "$EndPartitionedEntities\n"
      "$Nodes\n1 4 1 4\n2 2 0 4\n1\n2\n3\n4\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n$EndNodes\n"
      "$Elements\n5 7 1 7\n1 2 1 2\n1 1 2\n2 2 3\n1 3 1 2\n3 3 4\n4 4 1\n1 4 1 1\n5 1 3\n"
      "2 2 2 1\n6 1 2 3\n2 3 2 1\n7 1 3 4\n$EndElements\n"
      "$GhostElements\n1\n6 1 1 2\n$EndGhostElements\n";
  const Mesh mesh = parse_gmsh(text);
  REQUIRE(mesh.groups.size() == 2);
  CHECK(group(mesh, "rim").edges.size() == 4);
  CHECK(group(mesh, "body").elements == std::vector<int>{0, 1});
}

TEST_CASE("nodes with their parameters on the geometry are read", "[mesh]") {
  const Mesh mesh = parse_gmsh(
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$ParametricNodes\n4\n1 0 0 0 0 1\n2 1 0 0 1 1 0.5\n"
      "3 1 1 0 2 1 0.5 0.25\n4 0 1 0 2 1 0 1\n$EndParametricNodes\n"
      "$Elements\n2\n1 2 2 0 1 1 2 3\n2 2 2 0 1 1 3 4\n$EndElements\n");
  CHECK(mesh.element_count() == 2);
  CHECK(mesh.nodes[2] == Vec2(1, 1));
}

TEST_CASE("a file that gmsh saved without its surface says why", "[mesh]") {
  const std::string start =
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n1 1 \"rim\"\n$EndPhysicalNames\n"
      "$Nodes\n3\n1 0 0 0\n2 1 0 0\n3 0 1 0\n$EndNodes\n";
  CHECK_THROWS_WITH(parse_gmsh(start + "$Elements\n1\n1 1 2 1 1 1 2\n$EndElements\n"),
                    Contains("has no triangles or quadrilaterals; mesh the surface (gmsh -2); ") &&
                        Contains("Physical Surface") && Contains("Mesh.SaveAll"));
  CHECK_THROWS_WITH(parse_gmsh(start), Contains("has no triangles or quadrilaterals"));
  CHECK_THROWS_WITH(parse_gmsh("$NOD\n1\n1 0 0 0\n$ENDNOD\n"),
                    Contains("is of version 1, which is not read; save it as 4.1 or 2.2"));
}

TEST_CASE("bad gmsh files are refused with line and tag", "[mesh]") {
  struct Case {
    const char* what;
    const char* by;
    const char* message;
    int line;
  };
  const Case cases[]{
      {"2.2 0 8", "2.2 1 8", "is binary; save it as text", 2},
      {"2.2 0 8", "4.0 0 8", "has version 4.0, which is not read", 2},
      {"$MeshFormat", "MeshFormat", "no gmsh file", 1},
      {"$MeshFormat", "$Nodes", "$MeshFormat must come before all other sections", 1},
      {"12 2 0 0", "12 2 zero 0", "\"zero\" is not a coordinate in m", 17},
      {"12 2 0 0", "12 2 0", "the line ends before a coordinate", 17},
      {"12 2 0 0", "12 2 0 0 0", "\"0\" is left over", 17},
      {"12 2 0 0", "11 2 0 0", "two nodes with the tag 11", 17},
      {"12 2 0 0", "12 2 0 1", "node with the tag 12 has z = 1", 17},
      {"12 2 0 0", "12 nan 0 0", "\"nan\" is not a coordinate in m", 17},
      {"7 2 2 0 2 13 23 22", "7 2 2 0 2 13 23 24", "has the node 24, which is not in $Nodes", 33},
      {"7 2 2 0 2 13 23 22", "7 2 2 0 2 13 23", "the line ends before the tag of a node", 33},
      {"7 2 2 0 2 13 23 22", "7 9 2 0 2 13 23 22 1 2 3",
       "element with the tag 7 is a 6-node triangle of higher order; mesh with first order", 33},
      {"7 2 2 0 2 13 23 22", "7 4 2 0 2 13 23 22 10", "is a tetrahedron; give a mesh of a surface",
       33},
      {"7 2 2 0 2 13 23 22", "7 77 2 0 2 13 23 22 10", "has the type 77", 33},
      {"7 2 2 0 2 13 23 22", "7 2 2 0 2 13 22 12", "node with the tag 23 belongs to no triangle",
       22},
      {"7 2 2 0 2 13 23 22", "7 2 2 0 2 13 22 23", "", -1},
      {"6 2 2 0 2 12 13 22", "6 2 2 0 2 12 13 23",
       "element 3 lies on the same side of the edge of nodes 3 and 7 as element 2 (element 3: tag "
       "7)",
       33},
      {"4 3 2 9 1 10 11 21 20", "4 3 2 9 1 10 21 11 20", "element 0 is not a simple polygon", 30},
      {"3 1 2 1 1 10 20", "3 1 2 1 1 10 21",
       "line with the tag 3 of the group \"left\" is no edge of a triangle or quadrilateral", 29},
      {"2 15 2 0 2 99", "2 15 2 5 2 99", "node with the tag 99 of the group \"point-5\"", 28},
      {"2 15 2 0 2 99\n", "", "\"$EndElements\" is not the tag of an element", 33},
      {"1 1 \"left\"", "1 1 left", "must stand in quotes", 10},
      {"1 1 \"left\"", "1 1 \"squares\"", "two physical groups have the name \"squares\"", 0},
      {"$Elements\n7", "$Elements\n8", "\"$EndElements\" is not the tag of an element", 34},
      {"$Elements\n7", "$Elements\n6", "$EndElements should stand here", 33},
      {"$Elements\n7", "$Elements\n-7", "-7 is not the number of elements", 26},
      {"$EndElements", "", "the file ends where $EndElements should follow", 34},
  };
  for (const Case& c : cases) {
    const auto [message, line] = refusal(c.what, c.by);
    INFO(c.what << " -> " << c.by << ": " << message);
    CHECK_THAT(message, Contains(c.message));
    CHECK(line == c.line);
  }
  for (const char* text : {"", "\n \n", "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n"}) {
    CHECK_THROWS_AS(parse_gmsh(text), BadMeshText);
  }
  const Folder folder;
  const auto read = [&](const std::string& file) { read_mesh_file(file); };
  CHECK_THROWS_WITH(read(folder / "none.msh"), Contains("cannot be opened"));
  std::string text = mixed();
  text.replace(text.find("12 2 0 0"), 8, "12 2 x 0");
  const std::string file = folder.write("bad.msh", text);
  CHECK_THROWS_WITH(read(file), Contains("bad.msh:17: \"x\" is not a coordinate in m"));
}

TEST_CASE("no spoilt file does harm", "[mesh]") {
  test::SeededRandom random(4);
  for (const std::string& text : {mixed(), content(sample("quarter-disc"))}) {
    for (int i = 0; i < scaled(2000); ++i) {
      std::string spoilt = text;
      for (int k = random.integer(0, 3); k >= 0; --k) {
        const size_t at = random.integer(0, static_cast<int>(spoilt.size()) - 1);
        switch (random.integer(0, 3)) {
          case 0:
            spoilt[at] = static_cast<char>('0' + random.integer(0, 9));
            break;
          case 1:
            spoilt[at] = "-.\n $e\0"[random.integer(0, 6)];
            break;
          case 2:
            spoilt.erase(at, random.integer(1, 20));
            break;
          default:
            if (k == 0 && i % 10 == 0) spoilt.resize(at);
        }
        if (spoilt.empty()) spoilt = "x";
      }
      try {
        const Mesh mesh = parse_gmsh(spoilt);
        CHECK_NOTHROW(check_mesh(mesh));
      } catch (const BadMeshText&) {
      }
    }
  }
}
