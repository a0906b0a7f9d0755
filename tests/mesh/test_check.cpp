// What is refused as a mesh, and with which element or node.
#include "lib/mesh/invalid_mesh.hpp"
#include "lib/mesh/rectangle_mesh.hpp"
#include "tests/mesh/mesh_laws.hpp"

using namespace apothem;
using namespace apothem::test;
using Catch::Contains;

namespace {

// Nodes 3 j + i at (i, j); the four unit squares 0, 1 below, 2, 3 above.
Mesh squares() { return rectangle_mesh({2, 2}, {2, 2}, {0, 0}, ElementShape::quadrilateral); }

struct Refusal {
  std::string what;
  int element = -2;
  int node = -2;
};

Refusal refusal(const Mesh& mesh, const MeshRules& rules = {}) {
  try {
    check_mesh(mesh, rules);
    return {};
  } catch (const InvalidMesh& error) {
    return {error.what(), error.element(), error.node()};
  }
}

void check_refused(const Mesh& mesh, const std::string& what, int element, int node) {
  const Refusal r = refusal(mesh);
  CHECK_THAT(r.what, Contains(what));
  CHECK(r.element == element);
  CHECK(r.node == node);
}

Mesh elements(std::vector<Vec2> nodes, const std::vector<std::vector<int>>& corners) {
  Mesh mesh;
  mesh.nodes = std::move(nodes);
  for (const auto& c : corners) mesh.add_element(c);
  return mesh;
}

}  // namespace

TEST_CASE("bad nodes and elements are refused by number", "[mesh]") {
  CHECK(refusal(squares()).what.empty());
  Mesh mesh = squares();
  mesh.nodes[4].x() = std::nan("");
  check_refused(mesh, "node 4 is not finite", -1, 4);
  mesh.nodes[4].x() = 1e70;
  check_refused(mesh, "node 4 has a coordinate beyond", -1, 4);

  mesh = squares();
  mesh.add_element(std::array{0, 1});
  check_refused(mesh, "element 4 has 2 corners", 4, -1);

  mesh = squares();
  mesh.corners[4 * 2 + 1] = mesh.corners[4 * 2];
  check_refused(mesh, "element 2 repeats its corner, node 3", 2, 3);

  mesh = squares();
  mesh.corners[5] = 9;
  check_refused(mesh, "element 1 has the corner 9", 1, -1);

  mesh = squares();
  std::reverse(mesh.corners.begin() + 12, mesh.corners.end());
  check_refused(mesh, "element 3 is inverted", 3, -1);

  mesh = squares();
  std::swap(mesh.corners[4], mesh.corners[5]);
  check_refused(mesh, "element 1 is not a simple polygon", 1, 4);

  check_refused(elements({{0, 0}, {1, 1}, {2, 2}, {3, 0}}, {{0, 3, 1}, {0, 1, 2}}),
                "element 1 has no area", 1, -1);
  check_refused(elements({{0, 0}, {1, 0}, {2, 1e-13}}, {{0, 1, 2}}), "element 0 is degenerate", 0,
                -1);
  // All turns to the left, but twice around.
  check_refused(
      elements({{0, 1}, {-.59, -.81}, {.95, .31}, {-.95, .31}, {.59, -.81}}, {{0, 1, 2, 3, 4}}),
      "element 0 is not a simple polygon", 0, 2);
  check_refused({}, "has no elements", -1, -1);
}

TEST_CASE("quadrilaterals must be convex where the element needs it", "[mesh]") {
  for (const Vec2& tip : {Vec2(.5, .5), Vec2(.25, .25)}) {
    const Mesh mesh = elements({{0, 0}, {1, 0}, tip, {0, 1}}, {{0, 1, 2, 3}});
    check_refused(mesh, "element 0 is a quadrilateral with a corner of 180 degrees or more", 0, 2);
    CHECK(refusal(mesh, {.convex_quadrilaterals = false}).what.empty());
  }
}

TEST_CASE("nodes that do not belong are refused", "[mesh]") {
  Mesh mesh = squares();
  mesh.nodes.emplace_back(5, 5);
  check_refused(mesh, "node 9 belongs to no element", -1, 9);

  // A crack: the middle line's right end opened, both lips in one place.
  mesh = squares();
  mesh.groups.clear();
  mesh.nodes.push_back(mesh.nodes[5]);
  std::replace(mesh.corners.begin() + 8, mesh.corners.end(), 5, 9);
  check_refused(mesh, "node 9 is in the same place as node 5", -1, 9);
  mesh.nodes[9].y() += 1e-13;
  check_refused(mesh, "node 9 is in the same place as node 5", -1, 9);
  mesh.nodes[9].y() += .1;
  CHECK(refusal(mesh).what.empty());
}

TEST_CASE("elements that do not fit together are refused", "[mesh]") {
  Mesh mesh = squares();
  mesh.add_element(std::array{1, 2, 4});
  check_refused(mesh, "element 4 lies on the same side of the edge of nodes 1 and 2 as element 1",
                4, -1);

  mesh = elements({{0, 0}, {0, 1}, {-1, 0}, {1, 0}, {-1, 1}}, {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}});
  check_refused(
      mesh, "element 2 shares the edge of nodes 0 and 1 with two others, elements 0 and 1", 2, -1);

  // Node 4 in the middle of the large element's edge.
  mesh = elements({{0, 0}, {2, 0}, {2, 1}, {0, 1}, {1, 1}, {0, 2}, {2, 2}},
                  {{0, 1, 2, 3}, {3, 4, 5}, {4, 2, 6, 5}});
  check_refused(mesh, "node 4 hangs on the edge of nodes 2 and 3 of element 0", 0, 4);
  mesh.nodes[4].y() += 1e-12;
  check_refused(mesh, "node 4 hangs on the edge of nodes 2 and 3 of element 0", 0, 4);
  mesh = elements(mesh.nodes, {{0, 1, 2, 4, 3}, {3, 4, 5}, {4, 2, 6, 5}});
  CHECK(refusal(mesh).what.empty());

  mesh = squares();
  mesh.nodes.insert(mesh.nodes.end(), {{3, 2}, {3, 3}, {2, 3}});
  mesh.add_element(std::array{8, 9, 10, 11});
  check_refused(mesh, "node 8 is a pinch: elements 3 and 4", -1, 8);

  mesh = elements({{0, 0}, {1, 0}, {0, 1}, {5, 5}, {6, 5}, {5, 6}}, {{0, 1, 2}, {3, 4, 5}});
  check_refused(mesh, "falls into 2 parts", -1, -1);
  CHECK(boundary(mesh).components == 2);
  CHECK(boundary(mesh).loops.size() == 2);

  mesh = elements({{0, 0}, {4, 0}, {0, 4}, {1, 1}, {4, 2}, {2, 4}}, {{0, 1, 2}, {3, 4, 5}});
  check_refused(mesh, "element 1 overlaps or touches element 0", 1, -1);
}

TEST_CASE("a strip that winds around twice covers itself", "[mesh]") {
  // Quadrilaterals around zero between a spiral's inner and outer turn, two full turns, then joined
  // end to start across: every element is good, the boundary meets itself.
  Mesh mesh;
  const int n = 16;
  for (int i = 0; i < n; ++i) {
    const double angle = 4 * std::acos(-1.) * i / n;
    const double r = 1 + .3 * (i < n / 2 ? i : n - i) / n;
    mesh.nodes.emplace_back(r * std::cos(angle), r * std::sin(angle));
    mesh.nodes.emplace_back((r + 1) * std::cos(angle), (r + 1) * std::sin(angle));
  }
  for (int i = 0; i < n; ++i) {
    const int j = (i + 1) % n;
    mesh.add_element(std::array{2 * i, 2 * i + 1, 2 * j + 1, 2 * j});
  }
  CHECK_FALSE(refusal(mesh).what.empty());
}

TEST_CASE("groups must name what is there", "[mesh]") {
  const auto with = [](const MeshGroup& group) {
    Mesh mesh = squares();
    mesh.groups = {group};
    return mesh;
  };
  CHECK(refusal(with({"a", {0, 1}, {{0, 1}}})).what.empty());
  CHECK(refusal(with({"a", {1, 4}, {{4, 1}}})).what.empty());
  check_refused(with({"a", {0, 9}, {}}), "names node 9", -1, -1);
  check_refused(with({"a", {1, 0}, {}}), "ascending", -1, 0);
  check_refused(with({"a", {0, 1}, {{1, 0}}}), "from node 1 to node 0", -1, -1);
  check_refused(with({"a", {0, 4}, {{0, 4}}}), "from node 0 to node 4", -1, -1);
  check_refused(with({"a", {0}, {{0, 1}}}), "does not name the node", -1, 1);
  const Mesh mesh = squares();
  std::vector<int> nodes(mesh.element(1).begin(), mesh.element(1).end());
  std::sort(nodes.begin(), nodes.end());
  CHECK(refusal(with({"a", nodes, {}, {1}})).what.empty());
  check_refused(with({"a", nodes, {}, {99}}), "names element 99", -1, -1);
  check_refused(with({"a", nodes, {}, {1, 1}}), "elements in ascending order", 1, -1);
  const int gone = nodes.back();
  nodes.pop_back();
  check_refused(with({"a", nodes, {}, {1}}), "but not its node", 1, gone);
}

TEST_CASE("the boundary of a frame", "[mesh]") {
  // 3 x 3 squares without the middle one.
  Mesh mesh = rectangle_mesh({3, 3}, {3, 3}, {0, 0}, ElementShape::quadrilateral);
  mesh.groups.clear();
  mesh.corners.erase(mesh.corners.begin() + 16, mesh.corners.begin() + 20);
  mesh.first.pop_back();
  check_laws(mesh, 8, 1);
  const Boundary outline = boundary(mesh);
  CHECK(outline.loops[0].nodes == std::vector<int>{0, 1, 2, 3, 7, 11, 15, 14, 13, 12, 8, 4});
  CHECK(outline.loops[0].elements == std::vector<int>{0, 1, 2, 2, 4, 7, 7, 6, 5, 5, 3, 0});
  CHECK(outline.loops[1].nodes == std::vector<int>{5, 9, 10, 6});
  CHECK(outline.loops[1].elements == std::vector<int>{3, 6, 4, 1});
}
