#include "geometry/skeleton/convex_skeleton.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "geometry/polygon/cyclic.hpp"
#include "geometry/skeleton/edge_lines.hpp"
#include "lib/execution/elementary.hpp"

namespace apothem {
namespace {

using Ring = std::vector<Vec2>;
using Node = Skeleton::Node;
using Faces = std::vector<std::vector<int>>;

// Builds the skeleton of a convex polygon: the edge of the front that vanishes first is removed
// until three edges are left. All nodes are computed from the lines of the original edges, so a
// wrong order of nearly simultaneous events does no harm. Among simultaneous events, which occur
// along a ridge of constant height, the one with the shortest new arcs comes first.

class ConvexShrink {
 public:
  explicit ConvexShrink(const Polygon& polygon)
      : ring_(polygon.local_vertices()),
        lines_(edge_lines(polygon)),
        size_(polygon.size()),
        simultaneous_(1e-13 * bounding_box(polygon).extent()),
        previous_(size_),
        next_(size_),
        left_(size_),
        right_(size_),
        events_(size_) {
    for (const Vec2& v : ring_) nodes_.push_back({v, 0});
    for (int e = 0; e < size_; ++e) {
      next_[e] = next(e, size_);
      previous_[next_[e]] = e;
    }
    for (int e = 0; e < size_; ++e) events_[e] = collapse(e);
  }

  SkeletonParts run() {
    std::vector<int> front(size_);
    std::iota(front.begin(), front.end(), 0);
    while (front.size() > 3) {
      const auto first = first_event(front);
      take_out(*first);
      front.erase(first);
    }
    const auto best = std::max_element(front.begin(), front.end(), [&](int e, int f) {
      return events_[e].conditioning < events_[f].conditioning;
    });
    const int top = add_node(events_[*best]);
    for (const int e : front) right_[e].push_back(top);
    return {std::move(nodes_), faces()};
  }

 private:
  // The point at which an edge of the front vanishes.
  struct Event {
    Vec2 point;           // relative to polygon.origin(), m
    double height;        // height of the roof there, m; infinite if the edge does not vanish
    double conditioning;  // determinant of the bisectors; the larger, the more exact is the point
  };

  [[nodiscard]] std::vector<int>::iterator first_event(std::vector<int>& front) const {
    double lowest = std::numeric_limits<double>::infinity();
    for (const int e : front) lowest = std::min(lowest, events_[e].height);
    auto first = front.end();
    double shortest = std::numeric_limits<double>::infinity();
    for (auto e = front.begin(); e != front.end(); ++e) {
      if (!(events_[*e].height <= lowest + simultaneous_)) continue;
      const double way = way_to(*e);
      if (first == front.end() || way < shortest) {
        first = e;
        shortest = way;
      }
    }
    return first;
  }

  // Total length of the two arcs on which the ends of a front edge travel to the point at which
  // they meet.
  [[nodiscard]] double way_to(int e) const {
    const int left = left_[e].empty() ? e : left_[e].back();
    const int right = right_[e].empty() ? next(e, size_) : right_[e].back();
    const Vec2& point = events_[e].point;
    return (nodes_[left].point - point).norm() + (nodes_[right].point - point).norm();
  }

  // Bisector of edge e and its neighbour f in the front, seen from the end point of e. At the
  // height t it has moved by (t rise - gap) / run along e, away from this end point. `rise` is
  // written without a difference that would cancel for a small angle between the edges.
  struct Bisector {
    double run, rise, gap;
  };
  [[nodiscard]] Bisector bisector(int e, int f, double turn, double gap) const {
    const double rise = (lines_[e].tangent - lines_[f].tangent).squaredNorm() / 2;
    const double norm = hypotenuse(turn, rise);
    if (!(norm > 0)) return {1, 0, 0};  // straight on
    return {turn / norm, rise / norm, gap / norm};
  }

  // The event at which edge e vanishes between its present neighbours in the front.
  [[nodiscard]] Event collapse(int e) const {
    const int p = previous_[e];
    const int q = next_[e];
    const EdgeLine &line = lines_[e], &before = lines_[p], &after = lines_[q];
    const Vec2& end = ring_[next(e, size_)];
    const Bisector a = bisector(e, p, cross(before.tangent, line.tangent),
                                cross(before.tangent, line.start - ring_[next(p, size_)]));
    const Bisector b =
        bisector(e, q, cross(line.tangent, after.tangent), cross(after.tangent, end - after.start));
    const double determinant = a.run * b.rise + b.run * a.rise;
    const double reach = line.length * b.run + b.gap;
    const double height = (a.run * reach + b.run * a.gap) / determinant;
    const double along = (a.rise * reach - b.rise * a.gap) / determinant;
    if (!(determinant > 0)) return {line.start, std::numeric_limits<double>::infinity(), 0};
    return {line.start + along * line.tangent + height * line.normal(), height, determinant};
  }

  int add_node(const Event& event) {
    nodes_.push_back({event.point, event.height});
    return static_cast<int>(nodes_.size()) - 1;
  }

  // Removes the vanishing edge e from the front.
  void take_out(int e) {
    const int node = add_node(events_[e]);
    const int p = previous_[e];
    const int q = next_[e];
    right_[e].push_back(node);
    right_[p].push_back(node);
    left_[q].push_back(node);
    next_[p] = q;
    previous_[q] = p;
    events_[p] = collapse(p);
    events_[q] = collapse(q);
  }

  [[nodiscard]] Faces faces() const {
    Faces result(size_);
    for (int e = 0; e < size_; ++e) {
      result[e] = {e, next(e, size_)};
      result[e].insert(result[e].end(), right_[e].begin(), right_[e].end());
      result[e].insert(result[e].end(), left_[e].rbegin(), left_[e].rend());
    }
    return result;
  }

  Ring ring_;
  std::vector<EdgeLine> lines_;
  int size_;
  double simultaneous_;               // heights that differ by no more are simultaneous, m
  std::vector<int> previous_, next_;  // neighbours of each edge in the shrinking front
  Faces left_, right_;                // nodes on the two sides of each face, from below
  std::vector<Event> events_;         // per edge of the front
  std::vector<Node> nodes_;
};

}  // namespace

SkeletonParts shrink_convex(const Polygon& polygon) { return ConvexShrink(polygon).run(); }

}  // namespace apothem
