// Numbering along a Hilbert curve.
#include <chrono>
#include <numeric>

#include "geometry/spatial/hilbert.hpp"
#include "lib/mesh/disc_mesh.hpp"
#include "lib/mesh/rectangle_mesh.hpp"
#include "lib/mesh/reorder.hpp"
#include "tests/mesh/mesh_laws.hpp"
#include "tests/support.hpp"

using namespace apothem;
using namespace apothem::test;

namespace {

void check_permutation(std::vector<int> numbers, size_t size) {
  std::vector<int> all(size);
  std::iota(all.begin(), all.end(), 0);
  std::sort(numbers.begin(), numbers.end());
  CHECK(numbers == all);
}

}  // namespace

TEST_CASE("the Hilbert curve steps from neighbour to neighbour", "[mesh]") {
  // The corners of a grid of 2^k squares each way: every step has the length of one square.
  const int n = 32;
  std::vector<Vec2> points;
  for (int i = 0; i < n * n; ++i) points.emplace_back(i % n + .5, i / n + .5);
  points.emplace_back(0, 0);
  points.emplace_back(n, n);
  std::vector<int> order = hilbert_order(points);
  check_permutation(order, points.size());
  std::erase_if(order, [](int i) { return i >= n * n; });
  for (size_t i = 1; i < order.size(); ++i) {
    CHECK((points[order[i]] - points[order[i - 1]]).norm() == 1);
  }
  CHECK(hilbert_order({{1, 1}, {1, 1}, {1, 1}}) == std::vector<int>{0, 1, 2});
  CHECK(hilbert_order({}).empty());
}

TEST_CASE("a reordered mesh is the same mesh", "[mesh]") {
  for (const ElementShape shape : {ElementShape::quadrilateral, ElementShape::triangle}) {
    const Mesh before = disc_mesh({1, 2}, 3, {8}, shape);
    Mesh mesh = before;
    const std::vector<int> some{1, 5, 6, 40};
    mesh.groups.push_back({"some", {}, {}, some});
    const Reordering old = reorder_along_curve(mesh);
    std::vector<int> were;
    for (const int e : group(mesh, "some").elements) were.push_back(old.elements[e]);
    CHECK(std::is_sorted(group(mesh, "some").elements.begin(), group(mesh, "some").elements.end()));
    std::sort(were.begin(), were.end());
    CHECK(were == some);
    mesh.groups.pop_back();
    check_permutation(old.nodes, before.nodes.size());
    check_permutation(old.elements, before.element_count());
    check_laws(mesh, mesh_quality(before).area);
    for (size_t i = 0; i < mesh.nodes.size(); ++i) {
      CHECK(mesh.nodes[i] == before.nodes[old.nodes[i]]);
    }
    int used = 0;  // nodes come in order of first use
    for (int e = 0; e < mesh.element_count(); ++e) {
      const auto corners = mesh.element(e);
      const auto was = before.element(old.elements[e]);
      REQUIRE(corners.size() == was.size());
      for (size_t i = 0; i < corners.size(); ++i) {
        CHECK(old.nodes[corners[i]] == was[i]);
        CHECK(corners[i] <= used);
        used = std::max(used, corners[i] + 1);
      }
    }
    check_share_boundary(mesh, {"boundary"});
    const MeshGroup& now = group(mesh, "boundary");
    const MeshGroup& then = group(before, "boundary");
    CHECK(std::is_sorted(now.nodes.begin(), now.nodes.end()));
    REQUIRE(now.edges.size() == then.edges.size());
    for (size_t i = 0; i < now.edges.size(); ++i) {
      CHECK(old.nodes[now.edges[i][0]] == then.edges[i][0]);
      CHECK(old.nodes[now.edges[i][1]] == then.edges[i][1]);
    }
  }
}

TEST_CASE("a million elements are made, checked and reordered in seconds", "[mesh]") {
  const int n = scaled(1000);
  const auto start = std::chrono::steady_clock::now();
  const auto seconds = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  Mesh mesh = rectangle_mesh({1, 1}, {n, n}, {0, 0}, ElementShape::quadrilateral);
  const double made = seconds();
  check_mesh(mesh);
  const double checked = seconds();
  reorder_along_curve(mesh);
  const double all = seconds();
  // Neighbours are close: the nodes of an element mostly within a few hundred of each other.
  int near = 0;
  for (int e = 0; e < mesh.element_count(); ++e) {
    const auto [low, high] = std::minmax_element(mesh.element(e).begin(), mesh.element(e).end());
    near += *high - *low < 300;
  }
  CHECK(near > .85 * mesh.element_count());
  INFO(mesh.element_count() << " elements: made in " << made << " s, checked in " << checked - made
                            << " s, reordered in " << all - checked << " s");
  CHECK(all < 20);
}
