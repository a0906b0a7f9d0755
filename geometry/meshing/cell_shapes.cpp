#include "geometry/meshing/cell_shapes.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <numbers>
#include <optional>
#include <set>

#include "geometry/polygon/cyclic.hpp"
#include "geometry/polygon/predicates.hpp"
#include "lib/execution/elementary.hpp"

namespace apothem {
namespace {

constexpr double kStraight = 1e-9;                  // rad
constexpr int kSweeps = 100;                        // over all nodes
constexpr std::array kSteps{.4, .2, .1, .05, .02};  // of a move, over the shortest edge
constexpr double kGain = 1e-3;  // rad by which a move must open the first angle that differs

using NodeRing = std::vector<int>;

// Cuts one cell.
class CellCutter {
 public:
  CellCutter(const std::vector<Vec2>& points, std::vector<NodeRing>& cells)
      : points_(points), cells_(cells) {}

  // Cuts cell c in two if it has a reflex corner; returns whether it has.
  bool cut(size_t c) {
    const NodeRing cell = cells_[c];
    const int n = static_cast<int>(cell.size());
    std::optional<Cut> best;
    for (int i = 0; i < n; ++i) {
      if (!is_reflex(angle(cell, previous(i, n), i, next(i, n)))) continue;
      for (int j = 0; j < n; ++j) {
        if (!is_diagonal(cell, i, j)) continue;
        const Cut cut = diagonal(cell, i, j);
        if (!best || cut.better_than(*best)) best = cut;
      }
    }
    if (!best) return false;
    NodeRing parts[2];
    for (int k = best->from; k != best->to; k = next(k, n)) parts[0].push_back(cell[k]);
    parts[0].push_back(cell[best->to]);
    for (int k = best->to; k != best->from; k = next(k, n)) parts[1].push_back(cell[k]);
    parts[1].push_back(cell[best->from]);
    cells_[c] = std::move(parts[0]);
    cells_.push_back(std::move(parts[1]));
    return true;
  }

 private:
  struct Cut {
    int from, to;
    bool opens;    // leaves no reflex corner where it begins
    double angle;  // the smallest one beside it, rad
    bool better_than(const Cut& other) const {
      return std::pair(opens, angle) > std::pair(other.opens, other.angle);
    }
  };

  [[nodiscard]] double angle(const NodeRing& cell, int before, int at, int after) const {
    const Vec2& p = points_[cell[at]];
    return corner_angle(p - points_[cell[before]], points_[cell[after]] - p);
  }

  [[nodiscard]] Cut diagonal(const NodeRing& cell, int i, int j) const {
    const int n = static_cast<int>(cell.size());
    const std::array begin{angle(cell, previous(i, n), i, j), angle(cell, j, i, next(i, n))};
    const std::array end{angle(cell, previous(j, n), j, i), angle(cell, i, j, next(j, n))};
    return {i, j, !is_reflex(begin[0]) && !is_reflex(begin[1]),
            std::min({begin[0], begin[1], end[0], end[1]})};
  }

  // True if the segment between two corners runs through the inside of the cell.
  [[nodiscard]] bool is_diagonal(const NodeRing& cell, int i, int j) const {
    const int n = static_cast<int>(cell.size());
    if (i == j || next(i, n) == j || next(j, n) == i) return false;
    const Vec2& p = points_[cell[i]];
    const Vec2& q = points_[cell[j]];
    const Vec2& before = points_[cell[previous(i, n)]];
    const Vec2& after = points_[cell[next(i, n)]];
    const bool left = orientation(before, p, q) > 0, right = orientation(p, after, q) > 0;
    if (orientation(before, p, after) >= 0 ? !(left && right) : !(left || right)) return false;
    for (int k = 0; k < n; ++k) {
      const int l = next(k, n);
      if (k == i || k == j || l == i || l == j) continue;
      if (segments_meet(p, q, points_[cell[k]], points_[cell[l]])) return false;
    }
    // A triangle that the segment cuts off has an area.
    if (next(next(i, n), n) == j && orientation(p, after, q) <= 0) return false;
    return next(next(j, n), n) != i || orientation(before, p, q) > 0;
  }

  const std::vector<Vec2>& points_;
  std::vector<NodeRing>& cells_;
};

// Moves the nodes of a mesh.
class AngleOpener {
 public:
  AngleOpener(PolygonMesh& mesh, const std::vector<int>& freedom, double smallest, double shortest)
      : mesh_(mesh),
        freedom_(freedom),
        smallest_(smallest),
        shortest_(shortest),
        corners_at_(mesh.points.size()),
        line_(mesh.points.size()) {
    for (int c = 0; c < static_cast<int>(mesh.cells.size()); ++c) {
      for (int i = 0; i < static_cast<int>(mesh.cells[c].size()); ++i) {
        corners_at_[mesh.cells[c][i]].push_back({c, i});
      }
    }
    find_lines();
  }

  int run() {
    int moves = 0;
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
      const int before = moves;
      for (int node = 0; node < static_cast<int>(mesh_.points.size()); ++node) {
        if (freedom_[node] != kNowhere && improve(node)) ++moves;
      }
      if (moves == before) break;
    }
    return moves;
  }

 private:
  struct Corner {
    int cell, at;
  };

  // The vertices of the outline between which the edge of every node on it runs.
  void find_lines() {
    std::map<int, int> next;  // along the boundary
    std::set<std::pair<int, int>> edges;
    for (const NodeRing& cell : mesh_.cells) {
      for (size_t i = 0; i < cell.size(); ++i) edges.insert({cell[i], after(cell, i)});
    }
    for (const auto& [u, v] : edges) {
      if (!edges.count({v, u})) next[u] = v;
    }
    for (const auto& [start, first] : next) {
      if (freedom_[start] != kNowhere) continue;
      std::vector<int> between;
      int node = first;
      for (; freedom_[node] != kNowhere; node = next.at(node)) between.push_back(node);
      for (const int i : between) line_[i] = {start, node};
    }
  }

  // The corners whose angles change with a node.
  struct Corners {
    std::vector<double> angles;  // ascending, rad; at most the wanted one, as reflex ones are, too
    int reflex = 0;

    // True if the first angle that clearly differs is larger, none before it is smaller, and no
    // more corners are reflex.
    [[nodiscard]] bool better_than(const Corners& other) const {
      for (size_t i = 0; i < angles.size() && angles[i] >= other.angles[i] - kStraight; ++i) {
        if (angles[i] > other.angles[i] + kGain) return reflex <= other.reflex;
      }
      return false;
    }
  };

  [[nodiscard]] Corners corners_of(int node) const {
    Corners result;
    for (const Corner& corner : corners_at_[node]) {
      const NodeRing& cell = mesh_.cells[corner.cell];
      const int n = static_cast<int>(cell.size());
      const auto point = [&](int i) -> const Vec2& { return mesh_.points[cell[i]]; };
      for (const int at : {previous(corner.at, n), corner.at, next(corner.at, n)}) {
        const double angle =
            corner_angle(point(at) - point(previous(at, n)), point(next(at, n)) - point(at));
        result.angles.push_back(std::min(angle, smallest_));
        result.reflex += is_reflex(angle);
      }
    }
    std::ranges::sort(result.angles);
    return result;
  }

  // Distances of a node from its neighbours, m.
  [[nodiscard]] std::vector<double> lengths(int node, const std::set<int>& neighbours) const {
    std::vector<double> result;
    result.reserve(neighbours.size());
    for (const int other : neighbours) {
      result.push_back((mesh_.points[other] - mesh_.points[node]).norm());
    }
    return result;
  }

  bool improve(int node) {
    const Corners before = corners_of(node);
    if (before.angles.front() >= smallest_) return false;
    std::set<int> neighbours;
    for (const Corner& corner : corners_at_[node]) {
      neighbours.insert(apothem::before(mesh_.cells[corner.cell], corner.at));
      neighbours.insert(after(mesh_.cells[corner.cell], corner.at));
    }
    const std::vector<double> long_before = lengths(node, neighbours);
    const double reach = *std::ranges::min_element(long_before);
    const Vec2 old = mesh_.points[node];
    std::vector<Vec2> ways;
    if (freedom_[node] != kAnywhere) {
      const Vec2 along = mesh_.points[line_[node][1]] - mesh_.points[line_[node][0]];
      ways = {along.normalized(), -along.normalized()};
    } else {
      for (const int other : neighbours) {
        const Vec2 way = (mesh_.points[other] - old).normalized();
        for (const Vec2& w : {way, Vec2(-way.y(), way.x())}) ways.insert(ways.end(), {w, -w});
      }
    }
    for (const double step : kSteps) {
      Corners best = before;
      Vec2 place = old;
      for (const Vec2& way : ways) {
        mesh_.points[node] = moved(node, old, step * reach * way);
        const Corners now = corners_of(node);
        if (!now.better_than(best) || !is_allowed(node, neighbours, long_before)) continue;
        best = now;
        place = mesh_.points[node];
      }
      mesh_.points[node] = place;
      if (place != old) return true;
    }
    return false;
  }

  // The place of a node after a move, on its edge of the outline if it lies on one.
  [[nodiscard]] Vec2 moved(int node, const Vec2& from, const Vec2& move) const {
    if (freedom_[node] == kAnywhere) return from + move;
    const Vec2& start = mesh_.points[line_[node][0]];
    const Vec2 along = mesh_.points[line_[node][1]] - start;
    return start + (from + move - start).dot(along) / along.squaredNorm() * along;
  }

  [[nodiscard]] bool is_allowed(int node, const std::set<int>& neighbours,
                                const std::vector<double>& long_before) const {
    const std::vector<double> now = lengths(node, neighbours);
    for (size_t i = 0; i < now.size(); ++i) {
      if (now[i] < std::min(shortest_, long_before[i])) return false;
    }
    return std::ranges::all_of(corners_at_[node], [&](const Corner& corner) {
      return is_valid_cell(cell_ring(mesh_, mesh_.cells[corner.cell]));
    });
  }

  PolygonMesh& mesh_;
  const std::vector<int>& freedom_;
  double smallest_, shortest_;
  std::vector<std::vector<Corner>> corners_at_;  // per node
  std::vector<std::array<int, 2>> line_;         // per node on the outline: the ends of its edge
};

}  // namespace

double corner_angle(const Vec2& in, const Vec2& out) {
  return std::numbers::pi - arc_tangent(cross(in, out), in.dot(out));
}

bool is_reflex(double angle) { return angle > std::numbers::pi + kStraight; }

int cut_at_reflex_corners(PolygonMesh& mesh) {
  CellCutter cutter(mesh.points, mesh.cells);
  const size_t before = mesh.cells.size();
  for (size_t c = 0; c < mesh.cells.size(); ++c) {  // the list grows
    while (cutter.cut(c)) {
    }
  }
  return static_cast<int>(mesh.cells.size() - before);
}

int open_small_angles(PolygonMesh& mesh, const std::vector<int>& freedom, double smallest,
                      double shortest) {
  return AngleOpener(mesh, freedom, smallest, shortest).run();
}

}  // namespace apothem
