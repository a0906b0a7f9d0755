#include "geometry/spatial/loops.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/polygon/cyclic.hpp"
#include "geometry/polygon/predicates.hpp"
#include "geometry/polygon/segment.hpp"
#include "geometry/spatial/boxes.hpp"
#include "lib/execution/elementary.hpp"

namespace apothem {

double distance(const Loops& loops, const Vec2& point) {
  double least = HUGE_VAL;
  for (const std::vector<Vec2>& ring : loops.rings) {
    least = std::min(least, distance_to_ring(ring, point));
  }
  return least;
}

std::optional<Vec2> deep_vertex(const Loops& a, const Loops& b, double reach) {
  for (const std::vector<Vec2>& ring : a.rings) {
    for (const Vec2& p : ring) {
      if (apart(box_of(p, p), b.box)) continue;
      bool inside = false;
      for (const std::vector<Vec2>& other : b.rings) inside ^= strictly_inside(other, p);
      if (inside && distance(b, p) > reach) return p;
    }
  }
  return {};
}

namespace {

constexpr double kParallel = 5 * M_PI / 180;  // sides at a smaller angle do not form a wedge
constexpr double kWedge = .4;  // of the thickness over the boundary between, in a straight wedge
constexpr double kRound = 1. / 3;  // of the boundary between: less is not a round end

// An edge of one of the lines, with the length and the turning of its line up to its start.
struct RingEdge {
  Vec2 start, edge;
  size_t ring;
  double before, turned;
};

constexpr double kSharp = .67;  // sine of half the angle of an inner corner

// The parameter at which the ray p + h d leaves the region, or `most`.
double way_out(const std::vector<std::vector<Vec2>>& rings, const Vec2& p, const Vec2& d,
               double most) {
  for (const std::vector<Vec2>& ring : rings) {
    for (size_t j = 0; j < ring.size(); ++j) {
      const Vec2 from = ring[j] - p, edge = after(ring, j) - ring[j];
      const double across = cross(d, edge);
      if (!(across > 0)) continue;  // only edges through which the ray goes out
      const double h = cross(from, edge) / across, u = cross(from, d) / across;
      if (h > 0 && h < most && u >= 0 && u <= 1) most = h;
    }
  }
  return most;
}

// True if the boundary between both ends of a way across of the length t is that of a wedge or of a
// round end. `between`: its length; `turning`: the angle by which it turns.
bool tapers(double t, double between, double turning) {
  const double angle = M_PI - turning;
  return t >= between * (angle > kParallel ? kWedge * tangent(angle / 2) : kRound);
}

}  // namespace

double smallest_thickness(const std::vector<std::vector<Vec2>>& rings, double most) {
  std::vector<RingEdge> edges;
  std::vector<double> length(rings.size()), turning_round(rings.size());
  for (size_t r = 0; r < rings.size(); ++r) {
    const std::vector<Vec2>& ring = rings[r];
    double turned = 0;
    for (size_t i = 0; i < ring.size(); ++i) {
      const Vec2 edge = after(ring, i) - ring[i];
      if (i > 0) {
        const Vec2& last = edges.back().edge;
        turned += arc_tangent(cross(last, edge), last.dot(edge));
      }
      edges.push_back({ring[i], edge, r, length[r], turned});
      length[r] += edge.norm();
    }
    const Vec2 &last = edges.back().edge, &first = edges[edges.size() - ring.size()].edge;
    turning_round[r] = turned + arc_tangent(cross(last, first), last.dot(first));
  }
  std::vector<Box> boxes;
  for (const RingEdge& e : edges) {
    const Vec2 inwards = most * Vec2(-e.edge.y(), e.edge.x()).normalized();
    Box box;
    for (const Vec2& p : {e.start, Vec2(e.start + e.edge)}) {
      box.include(p);
      box.include(p + inwards);
    }
    boxes.push_back(box);
  }
  std::vector<BoxPair> pairs;
  BoxGrid().find_pairs(boxes, pairs);
  double smallest = most;
  const auto look = [&](const RingEdge& e, const RingEdge& f) {
    const Vec2 inwards = Vec2(-e.edge.y(), e.edge.x()).normalized();
    const double closing = cross(f.edge, inwards);
    if (!(closing < 0)) return;  // only edges that look the other way
    for (const double u : {.02, .5, .98}) {
      const Vec2 from = e.start + u * e.edge - f.start;
      const double t = -cross(f.edge, from) / closing;
      if (!(t > 0 && t < smallest)) continue;
      const double v = (from + t * inwards).dot(f.edge) / f.edge.squaredNorm();
      if (v < 0 || v > 1) continue;
      if (e.ring == f.ring) {
        const double ahead = f.before + v * f.edge.norm() - e.before - u * e.edge.norm();
        const double turning = f.turned - e.turned;
        const double size = std::abs(ahead), whole = length[e.ring];
        // Both ways round.
        const double along = ahead > 0 ? turning : -turning;
        if (tapers(t, size, along) || tapers(t, whole - size, turning_round[e.ring] - along))
          continue;
      }
      smallest = t;
    }
  };
  for (const auto& [i, j] : pairs) {
    const auto a = static_cast<size_t>(i), b = static_cast<size_t>(j);
    look(edges[a], edges[b]), look(edges[b], edges[a]);
  }
  return smallest;
}

std::optional<InnerCorner> lowest_inner_corner(const std::vector<std::vector<Vec2>>& rings,
                                               double most) {
  std::optional<InnerCorner> lowest;
  for (const std::vector<Vec2>& corners : rings) {
    for (size_t i = 0; i < corners.size(); ++i) {
      const Vec2 &p = corners[i], in = (p - before(corners, i)).normalized();
      const Vec2 out = (after(corners, i) - p).normalized();
      const double sine = (in + out).norm() / 2;  // of half the angle between the sides
      if (!(cross(in, out) < 0 && sine < kSharp)) continue;
      const double height = way_out(rings, p, (in - out).normalized() / sine, most);
      if (!(height < most)) continue;
      most = height;
      lowest = {p, 2 * arc_tangent(sine, std::sqrt(1 - sine * sine)), height};
    }
  }
  return lowest;
}

}  // namespace apothem
