#include "lib/mesh/check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "geometry/polygon/polygon.hpp"
#include "geometry/polygon/predicates.hpp"
#include "geometry/spatial/boxes.hpp"
#include "lib/execution/elementary.hpp"
#include "lib/mesh/boundary.hpp"
#include "lib/mesh/invalid_mesh.hpp"
#include "lib/mesh/measure.hpp"

namespace apothem {
namespace {

constexpr double kLargest = 1e60;     // coordinate, m; the same limit as in Polygon
constexpr double kFlat = 1e-12;       // area over squared diagonal
constexpr double kSamePlace = 1e-12;  // times the mesh's size
constexpr double kOnEdge = 1e-9;      // times the edge's length

// The checks of check_mesh, in an order in which each may rely on the earlier ones.
class Check {
 public:
  Check(const Mesh& mesh, const MeshRules& rules) : mesh_(mesh), rules_(rules) {}

  void run() {
    arrays();
    coordinates();
    for (int e = 0; e < mesh_.element_count(); ++e) element(e);
    dangling_nodes();
    duplicate_nodes();
    edges_ = mesh_edges(mesh_);
    boundary_edges_meet_in_nodes();
    one_body();
    for (const MeshGroup& part : mesh_.groups) group(part);
  }

 private:
  [[nodiscard]] bool is_node(int n) const {
    return n >= 0 && n < static_cast<int>(mesh_.nodes.size());
  }

  void arrays() const {
    if (mesh_.first.empty() || mesh_.first.front() != 0 ||
        mesh_.first.back() != static_cast<int>(mesh_.corners.size()) ||
        !std::ranges::is_sorted(mesh_.first)) {
      throw InvalidMesh("the elements do not share out the list of corners", -1, -1);
    }
    if (mesh_.element_count() == 0) throw InvalidMesh("has no elements", -1, -1);
    for (int e = 0; e < mesh_.element_count(); ++e) {
      for (const int n : mesh_.element(e)) {
        if (is_node(n)) continue;
        throw InvalidMesh::at_element(
            e, fmt::format("has the corner {}, but there are {} nodes", n, mesh_.nodes.size()));
      }
    }
  }

  void coordinates() const {
    for (int n = 0; n < static_cast<int>(mesh_.nodes.size()); ++n) {
      if (!is_finite(mesh_.nodes[n])) throw InvalidMesh::at_node(n, "is not finite");
      if (!(mesh_.nodes[n].cwiseAbs().maxCoeff() < kLargest)) {
        throw InvalidMesh::at_node(n, "has a coordinate beyond 1e60");
      }
    }
  }

  void element(int e) const {
    const auto corners = mesh_.element(e);
    const size_t n = corners.size();
    if (n < 3) {
      throw InvalidMesh::at_element(e,
                                    fmt::format("has {} corners; an element needs at least 3", n));
    }
    repeated_corner(e);
    // Four left turns make a simple quadrilateral: their sum is a multiple of 360 degrees and less
    // than 4 x 180 degrees.
    bool convex = n <= 4;
    for (size_t i = 0; i < n && convex; ++i) {
      convex = orientation(mesh_.nodes[corners[i]], mesh_.nodes[after(corners, i)],
                           mesh_.nodes[corners[(i + 2) % n]]) > 0;
      if (n == 3) break;
    }
    if (!convex) general_element(e);
    const Box box = box_of(mesh_.places(corners));
    const double diagonal = hypotenuse(box.x1 - box.x0, box.y1 - box.y0);
    if (!(element_area(mesh_, e) >= kFlat * diagonal * diagonal)) {
      throw InvalidMesh::at_element(e, "is degenerate: its area is below 1e-12 of its diameter^2");
    }
  }

  void repeated_corner(int e) const {
    const auto corners = mesh_.element(e);
    const auto refuse = [&](int node) {
      throw InvalidMesh(fmt::format("element {} repeats its corner, node {}", e, node), e, node);
    };
    if (corners.size() <= 4) {
      for (size_t i = 0; i < corners.size(); ++i) {
        for (size_t j = 0; j < i; ++j) {
          if (corners[i] == corners[j]) refuse(corners[i]);
        }
      }
      return;
    }
    std::vector<int> sorted(corners.begin(), corners.end());
    std::ranges::sort(sorted);
    const auto twice = std::ranges::adjacent_find(sorted);
    if (twice != sorted.end()) refuse(*twice);
  }

  // The full check, for elements with five or more corners and for those that fail the test above.
  void general_element(int e) const {
    const auto corners = mesh_.element(e);
    const std::vector<Vec2> ring = mesh_.places(corners);
    if (ring.size() == 3 && orientation(ring[0], ring[1], ring[2]) == 0) {
      throw InvalidMesh::at_element(e, "has no area: its corners are on one line");
    }
    try {
      const Polygon polygon(ring);
      if (polygon.vertices().size() != ring.size()) {
        throw InvalidMesh::at_element(e, "has two neighbouring corners at one place");
      }
      if (polygon.input_index(1) != 1) {
        throw InvalidMesh::at_element(e, "is inverted: its corners go clockwise");
      }
      if (ring.size() == 4 && rules_.convex_quadrilaterals) straight_or_reflex(e);
    } catch (const InvalidPolygon& error) {
      throw InvalidMesh(fmt::format("element {} is not a simple polygon: {} (corner {} is node {})",
                                    e, error.what(), error.vertex(), corners[error.vertex()]),
                        e, corners[error.vertex()]);
    }
  }

  void straight_or_reflex(int e) const {
    const auto corners = mesh_.element(e);
    for (size_t i = 0; i < 4; ++i) {
      const int node = after(corners, i);
      if (orientation(mesh_.nodes[corners[i]], mesh_.nodes[node],
                      mesh_.nodes[corners[(i + 2) % 4]]) > 0) {
        continue;
      }
      throw InvalidMesh(
          fmt::format(
              "element {} is a quadrilateral with a corner of 180 degrees or more at node {}", e,
              node),
          e, node);
    }
  }

  void dangling_nodes() const {
    std::vector<bool> used(mesh_.nodes.size(), false);
    for (const int c : mesh_.corners) used[c] = true;
    const auto unused = std::ranges::find(used, false);
    if (unused == used.end()) return;
    throw InvalidMesh::at_node(static_cast<int>(unused - used.begin()), "belongs to no element");
  }

  void duplicate_nodes() const {
    const double reach = kSamePlace * mesh_size(mesh_);
    std::vector<Box> boxes;
    boxes.reserve(mesh_.nodes.size());
    for (const Vec2& p : mesh_.nodes) {
      boxes.push_back(Box{p.x(), p.y(), p.x(), p.y()}.grown(reach / 2));
    }
    std::vector<BoxPair> pairs;
    BoxGrid().find_pairs(boxes, pairs);
    if (pairs.empty()) return;
    throw InvalidMesh::at_node(
        pairs.front().second,
        fmt::format("is in the same place as node {}; merge them", pairs.front().first));
  }

  void boundary_edges_meet_in_nodes() const {
    std::vector<MeshEdge> rim;
    std::vector<Box> boxes;
    for (const MeshEdge& edge : edges_) {
      if (!edge.on_boundary()) continue;
      const Vec2& a = mesh_.nodes[edge.nodes[0]];
      const Vec2& b = mesh_.nodes[edge.nodes[1]];
      rim.push_back(edge);
      boxes.push_back(box_of(a, b).grown(kOnEdge * (b - a).norm()));
    }
    std::vector<BoxPair> pairs;
    BoxGrid().find_pairs(boxes, pairs);
    for (const auto& [i, j] : pairs) {
      hanging_node(rim[i], rim[j]);
      hanging_node(rim[j], rim[i]);
    }
    for (const auto& [i, j] : pairs) crossing(rim[i], rim[j]);
  }

  void hanging_node(const MeshEdge& edge, const MeshEdge& other) const {
    const Vec2& a = mesh_.nodes[edge.nodes[0]];
    const Vec2 along = mesh_.nodes[edge.nodes[1]] - a;
    for (const int node : other.nodes) {
      if (node == edge.nodes[0] || node == edge.nodes[1]) continue;
      const Vec2 p = mesh_.nodes[node] - a;
      const double share = p.dot(along) / along.squaredNorm();
      if (share <= 0 || share >= 1 || std::abs(cross(along, p)) > kOnEdge * along.squaredNorm()) {
        continue;
      }
      throw InvalidMesh(fmt::format("node {} hangs on the edge of nodes {} and {} of element {}, "
                                    "which does not have it as a corner",
                                    node, edge.nodes[0], edge.nodes[1], edge.left),
                        edge.left, node);
    }
  }

  void crossing(const MeshEdge& p, const MeshEdge& q) const {
    for (const int node : p.nodes) {
      if (node == q.nodes[0] || node == q.nodes[1]) return;
    }
    const auto at = [&](int node) -> const Vec2& { return mesh_.nodes[node]; };
    if (!segments_meet(at(p.nodes[0]), at(p.nodes[1]), at(q.nodes[0]), at(q.nodes[1]))) return;
    throw InvalidMesh::at_element(
        std::max(p.left, q.left),
        fmt::format("overlaps or touches element {} without sharing its nodes",
                    std::min(p.left, q.left)));
  }

  void one_body() const {
    const Boundary outline = boundary(mesh_, edges_);
    if (outline.components > 1) {
      throw InvalidMesh(
          fmt::format("falls into {} parts that share no edge; give each its own body",
                      outline.components),
          -1, -1);
    }
    const auto outer = std::ranges::count_if(
        outline.loops, [](const BoundaryLoop& loop) { return !loop.is_hole; });
    if (outer != 1) throw InvalidMesh("elements cover each other", -1, -1);
  }

  void group(const MeshGroup& part) const {
    const std::string name = fmt::format("group \"{}\" ", part.name);
    for (size_t i = 0; i < part.nodes.size(); ++i) {
      if (!is_node(part.nodes[i])) {
        throw InvalidMesh(fmt::format("{}names node {}, which is none", name, part.nodes[i]), -1,
                          -1);
      }
      if (i > 0 && part.nodes[i] <= part.nodes[i - 1]) {
        throw InvalidMesh(fmt::format("{}does not name its nodes in ascending order", name), -1,
                          part.nodes[i]);
      }
    }
    for (const auto& [a, b] : part.edges) {
      const MeshEdge* edge = find_edge(edges_, a, b);
      if (edge == nullptr || (edge->on_boundary() && edge->nodes[0] != a)) {
        throw InvalidMesh(
            fmt::format("{}has an edge from node {} to node {}, which no element has", name, a, b),
            -1, -1);
      }
      for (const int node : {a, b}) {
        if (std::ranges::binary_search(part.nodes, node)) continue;
        throw InvalidMesh(
            fmt::format("{}has an edge at node {}, but does not name the node", name, node), -1,
            node);
      }
    }
    for (size_t i = 0; i < part.elements.size(); ++i) {
      const int e = part.elements[i];
      if (e < 0 || e >= mesh_.element_count()) {
        throw InvalidMesh(fmt::format("{}names element {}, which is none", name, e), -1, -1);
      }
      if (i > 0 && e <= part.elements[i - 1]) {
        throw InvalidMesh(fmt::format("{}does not name its elements in ascending order", name), e,
                          -1);
      }
      for (const int node : mesh_.element(e)) {
        if (std::ranges::binary_search(part.nodes, node)) continue;
        throw InvalidMesh(fmt::format("{}names element {}, but not its node {}", name, e, node), e,
                          node);
      }
    }
  }

  const Mesh& mesh_;
  const MeshRules& rules_;
  std::vector<MeshEdge> edges_;
};

}  // namespace

void check_mesh(const Mesh& mesh, const MeshRules& rules) { Check(mesh, rules).run(); }

}  // namespace apothem
