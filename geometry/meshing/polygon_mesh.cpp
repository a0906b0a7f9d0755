#include "geometry/meshing/polygon_mesh.hpp"

#include <algorithm>
#include <map>
#include <queue>
#include <set>
#include <tuple>

#include "geometry/polygon/cyclic.hpp"
#include "geometry/polygon/ring_moments.hpp"

namespace apothem {
namespace {

// Throws InvalidPolygon unless the ring is a simple counter-clockwise polygon.
void require_counter_clockwise(const std::vector<Vec2>& ring) {
  const Polygon polygon(ring);
  if (polygon.vertices().size() != ring.size()) throw InvalidPolygon("repeats a vertex", 0);
  if (polygon.input_index(1) != 1) throw InvalidPolygon("is clockwise", 0);
}

// Does the work of collapse_short_edges.
class Collapse {
 public:
  Collapse(PolygonMesh& mesh, std::vector<int> freedom, double shortest)
      : mesh_(mesh),
        freedom_(std::move(freedom)),
        shortest_(shortest),
        cells_of_(mesh.points.size()) {
    for (int c = 0; c < static_cast<int>(mesh_.cells.size()); ++c) {
      for (const int node : mesh_.cells[c]) cells_of_[node].push_back(c);
    }
  }

  ShortEdges run() {
    for (int c = 0; c < static_cast<int>(mesh_.cells.size()); ++c) push_short_edges(c);
    ShortEdges result;
    while (!queue_.empty()) {
      const auto [length, u, v] = queue_.top();
      queue_.pop();
      // The entry is out of date: a node has been removed, or the edge has changed its length.
      if (cells_of_[u].empty() || cells_of_[v].empty() || distance(u, v) != length) continue;
      if (collapse(u, v)) ++result.collapsed;
    }
    result.left = count_short_edges();
    drop_unused_nodes();
    return result;
  }

 private:
  using Entry = std::tuple<double, int, int>;  // length of an edge and its two nodes

  [[nodiscard]] double distance(int u, int v) const {
    return (mesh_.points[u] - mesh_.points[v]).norm();
  }

  template <class Visit>
  void for_edges(int c, const Visit& visit) const {
    const std::vector<int>& cell = mesh_.cells[c];
    for (size_t i = 0; i < cell.size(); ++i) visit(cell[i], after(cell, i));
  }

  void push_short_edges(int c) {
    for_edges(c, [&](int u, int v) {
      const auto [first, second] = std::minmax(u, v);
      if (const double length = distance(first, second); length < shortest_) {
        queue_.push({length, first, second});
      }
    });
  }

  // The cells that have uv as an edge. The list is empty if uv must not collapse, because another
  // cell has both nodes or a triangle would vanish.
  [[nodiscard]] std::vector<int> cells_along(int u, int v) const {
    std::vector<int> along;
    for (const int c : cells_of_[u]) {
      const std::vector<int>& cell = mesh_.cells[c];
      if (std::ranges::find(cell, v) == cell.end()) continue;
      bool is_edge = false;
      for_edges(c, [&](int a, int b) { is_edge |= std::minmax(a, b) == std::minmax(u, v); });
      if (!is_edge || cell.size() == 3) return {};
      along.push_back(c);
    }
    return along;
  }

  // Collapses the edge uv if that is possible; returns whether it was.
  bool collapse(int u, int v) {
    // From here on u is the node with less freedom. It is the one that remains.
    if (freedom_[v] == kNowhere || freedom_[u] == kAnywhere) std::swap(u, v);
    if (freedom_[v] == kNowhere) return false;
    const std::vector<int> along = cells_along(u, v);
    if (along.empty()) return false;
    // The collapse of an edge that crosses the inside between two nodes on the outline would cut
    // the mesh in two there.
    if (freedom_[v] != kAnywhere && along.size() == 2) return false;
    const Vec2 p = mesh_.points[u];
    const Vec2 q = mesh_.points[v];
    std::vector<Vec2> places{p};
    if (freedom_[u] != kNowhere && freedom_[v] != kAnywhere) places.push_back(q);
    if (freedom_[u] == kAnywhere) places = {(p + q) / 2, p, q};

    std::vector<int> around = cells_of_[u];
    around.insert(around.end(), cells_of_[v].begin(), cells_of_[v].end());
    std::ranges::sort(around);
    around.erase(std::unique(around.begin(), around.end()), around.end());
    for (const Vec2& place : places) {
      const bool valid = std::ranges::all_of(around, [&](int c) {
        return is_valid_cell(ring_after(c, u, v, place)) ||
               !is_valid_cell(cell_ring(mesh_, mesh_.cells[c]));
      });
      if (!valid) continue;
      replace(u, v, place, around);
      return true;
    }
    return false;
  }

  // The ring of cell c after the nodes u and v have been joined at `place`.
  [[nodiscard]] std::vector<Vec2> ring_after(int c, int u, int v, const Vec2& place) const {
    const std::vector<int>& cell = mesh_.cells[c];
    const bool both = std::ranges::find(cell, u) != cell.end();
    std::vector<Vec2> ring;
    for (const int node : cell) {
      if (node == v && both) continue;
      ring.push_back(node == u || node == v ? place : mesh_.points[node]);
    }
    return ring;
  }

  // Moves node u to `place` and replaces node v by it in the cells `around` both.
  void replace(int u, int v, const Vec2& place, const std::vector<int>& around) {
    mesh_.points[u] = place;
    for (const int c : around) {
      std::vector<int>& cell = mesh_.cells[c];
      if (std::ranges::find(cell, u) != cell.end()) {
        std::erase(cell, v);
      } else {
        std::ranges::replace(cell, v, u);
      }
    }
    cells_of_[u] = around;
    cells_of_[v].clear();
    for (const int c : around) push_short_edges(c);
  }

  [[nodiscard]] int count_short_edges() const {
    std::map<std::pair<int, int>, int> cells_at;
    for (int c = 0; c < static_cast<int>(mesh_.cells.size()); ++c) {
      for_edges(c, [&](int u, int v) {
        if (distance(u, v) < shortest_) ++cells_at[std::minmax(u, v)];
      });
    }
    return static_cast<int>(std::ranges::count_if(cells_at, [&](const auto& edge) {
      const auto& [u, v] = edge.first;
      return edge.second == 2 || freedom_[u] != kNowhere || freedom_[v] != kNowhere;
    }));
  }

  void drop_unused_nodes() {
    std::vector<int> index(mesh_.points.size(), -1);
    int count = 0;
    for (size_t i = 0; i < index.size(); ++i) {
      if (cells_of_[i].empty()) continue;
      index[i] = count;
      mesh_.points[count++] = mesh_.points[i];
    }
    mesh_.points.resize(count);
    for (std::vector<int>& cell : mesh_.cells) {
      for (int& node : cell) node = index[node];
      std::rotate(cell.begin(), std::ranges::min_element(cell), cell.end());
    }
  }

  PolygonMesh& mesh_;
  std::vector<int> freedom_;
  double shortest_;
  std::vector<std::vector<int>> cells_of_;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue_;
};

}  // namespace

std::vector<Vec2> cell_ring(const PolygonMesh& mesh, const std::vector<int>& cell) {
  std::vector<Vec2> ring;
  ring.reserve(cell.size());
  for (const int node : cell) ring.push_back(mesh.points[node]);
  return ring;
}

bool is_valid_cell(const std::vector<Vec2>& ring) {
  try {
    require_counter_clockwise(ring);
    return true;
  } catch (const InvalidPolygon&) {
    return false;
  }
}

std::vector<std::vector<int>> tiling_boundary(const PolygonMesh& mesh, int holes) {
  std::map<std::pair<int, int>, int> cell_left_of;
  for (int c = 0; c < static_cast<int>(mesh.cells.size()); ++c) {
    const std::vector<int>& cell = mesh.cells[c];
    const std::string name = "cell " + std::to_string(c);
    try {
      require_counter_clockwise(cell_ring(mesh, cell));
    } catch (const InvalidPolygon& error) {
      throw InvalidPolygon(name + ": " + error.what(), error.vertex());
    }
    for (size_t i = 0; i < cell.size(); ++i) {
      const std::pair edge(cell[i], after(cell, i));
      const auto [other, is_new] = cell_left_of.try_emplace(edge, c);
      if (!is_new) {
        throw InvalidPolygon(
            name + " lies on the same side of an edge as cell " + std::to_string(other->second),
            static_cast<int>(i));
      }
    }
  }
  std::map<int, int> next;
  for (const auto& [edge, cell] : cell_left_of) {
    if (cell_left_of.count({edge.second, edge.first})) continue;
    if (!next.emplace(edge.first, edge.second).second) {
      throw InvalidPolygon("cell " + std::to_string(cell) + ": the boundary meets itself at node " +
                               std::to_string(edge.first),
                           0);
    }
  }
  std::set<int> taken;
  std::vector<std::vector<int>> rings;
  for (const auto& [start, unused] : next) {
    if (taken.count(start)) continue;
    std::vector<int>& ring = rings.emplace_back();
    for (int node = start; ring.empty() || node != start; node = next.at(node)) {
      ring.push_back(node);
      taken.insert(node);
    }
  }
  if (static_cast<int>(rings.size()) != holes + 1) {
    throw InvalidPolygon("the cells have gaps: their boundary has " + std::to_string(rings.size()) +
                             " rings instead of " + std::to_string(holes + 1),
                         0);
  }
  const auto outer = std::ranges::find_if(
      rings, [&](const auto& ring) { return ring_area(cell_ring(mesh, ring)) > 0; });
  if (outer != rings.end()) std::rotate(rings.begin(), outer, outer + 1);
  require_counter_clockwise(cell_ring(mesh, rings.front()));
  Rings around;
  for (size_t i = 1; i < rings.size(); ++i) {
    around.push_back(cell_ring(mesh, {rings[i].rbegin(), rings[i].rend()}));
    require_counter_clockwise(around.back());
  }
  const Polygon whole(cell_ring(mesh, rings.front()), around);
  return rings;
}

ShortEdges collapse_short_edges(PolygonMesh& mesh, std::vector<int> freedom, double shortest) {
  return Collapse(mesh, std::move(freedom), shortest).run();
}

}  // namespace apothem
