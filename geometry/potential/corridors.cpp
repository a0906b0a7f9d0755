#include "geometry/potential/corridors.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "geometry/spatial/strip.hpp"

namespace apothem {
namespace {

constexpr double kNearlyParallel = 1e-4;  // sine of the angle between walls of a corridor
constexpr double kInTheWay = .5;   // a circle that moves towards an edge at this rate stops at once
constexpr double kBeyond = 4;      // further than any two points of a polygon of size 1
constexpr double kBlur = 0x1p-50;  // larger than the round-off of a distance

// Directions in which the edges that a circle touches push it.
class Barriers {
 public:
  void add(const Vec2& push) { pushes_.push_back(push); }

  /// True if edges block the circle in the directions u and -u, which is the case for most pairs of
  /// edges of a round polygon. Those that did so the last time are asked first.
  bool block(const Vec2& u) { return find(u) && find(-u); }

 private:
  // True if an edge pushes the circle in the direction u.
  bool find(const Vec2& u) {
    const auto pushes = [&](const Vec2& push) { return push.dot(u) > kInTheWay; };
    if (std::ranges::any_of(last_, pushes)) return true;
    const auto found = std::ranges::find_if(pushes_, pushes);
    if (found == pushes_.end()) return false;
    last_[1] = std::exchange(last_[0], *found);
    return true;
  }

  std::vector<Vec2> pushes_;
  std::array<Vec2, 2> last_{Vec2::Zero(), Vec2::Zero()};
};

// The pairs of edges with nearly opposite directions, in ascending order. They are found by their
// angles, so that a circle that touches very many edges is no matter.
std::vector<std::pair<int, int>> opposite_pairs(const std::vector<const PolygonEdge*>& edges) {
  std::vector<std::pair<double, int>> angles;  // in ascending order
  angles.reserve(edges.size());
  for (int i = 0; i < static_cast<int>(edges.size()); ++i) {
    angles.emplace_back(std::atan2(edges[i]->direction.y(), edges[i]->direction.x()), i);
  }
  std::ranges::sort(angles);
  std::vector<std::pair<int, int>> pairs;
  for (const auto& [angle, i] : angles) {
    const PolygonEdge& a = *edges[i];
    const double opposite = angle > 0 ? angle - M_PI : angle + M_PI;
    for (const double turn : {-2 * M_PI, 0., 2 * M_PI}) {
      const double low = opposite + turn - 2 * kNearlyParallel;
      for (auto j = std::ranges::lower_bound(angles, std::pair(low, 0));
           j != angles.end() && j->first <= low + 4 * kNearlyParallel; ++j) {
        const PolygonEdge& b = *edges[j->second];
        if (i < j->second && !(a.direction.dot(b.direction) > 0) &&
            std::abs(cross(a.direction, b.direction)) <= kNearlyParallel) {
          pairs.emplace_back(i, j->second);
        }
      }
    }
  }
  std::ranges::sort(pairs);
  return pairs;
}

}  // namespace

Centre Corridors::longest(const Vec2& point, double radius, double most) const {
  std::vector<const PolygonEdge*> touched;
  Barriers barriers;
  each_touched(point, radius, [&](const PolygonEdge& edge, const Distance& distance) {
    touched.push_back(&edge);
    barriers.add(distance.gradient);
  });
  Centre longest{point, point};
  for (const auto& [i, j] : opposite_pairs(touched)) {
    const PolygonEdge &a = *touched[i], &b = *touched[j];
    Vec2 u = ((a.end - a.start) - (b.end - b.start)).normalized();
    if (barriers.block(u)) continue;
    // Short edges give an inexact direction. It is improved with the points of the wall that the
    // circles at both ends of the segment touch.
    for (double length = 0, previous = -1; length > 2 * previous;
         u = along_wall(longest, u, most)) {
      previous = length;
      const Centre way = free_way(point, u, radius);
      length = (way.last - way.first).norm();
      if (length > (longest.last - longest.first).norm()) longest = way;
    }
  }
  return longest;
}

// Calls f(edge, its distance) for all edges that the circle about a point touches.
template <class F>
void Corridors::each_touched(const Vec2& point, double radius, const F& f) const {
  const double reach = radius + slack_;
  const Box around = box_of(point, point).grown(reach + kBlur);
  int first = 0;
  for (const RingTree& ring : trees_) {
    ring.each([&](const Box& box) { return !apart(box, around); },
              [&](int e) {
                const PolygonEdge& edge = edges_[first + e];
                const Distance distance = edge.distance_and_gradient(point);
                if (distance.value <= reach) f(edge, distance);
              });
    first += ring.size();
  }
}

// The longest segment through a point in the direction u that keeps the distance `radius` or more
// from all edges.
Centre Corridors::free_way(const Vec2& point, const Vec2& u, double radius) const {
  double ahead = HUGE_VAL;
  double behind = HUGE_VAL;
  const auto in_the_way = [&](const Box& box) {
    const Vec2 start = point - std::min(behind, kBeyond) * u;
    return Strip(start, point + std::min(ahead, kBeyond) * u, radius + kBlur).meets(box);
  };
  int first = 0;
  for (const RingTree& ring : trees_) {
    ring.each(in_the_way, [&](int e) {
      ahead = std::min(ahead, edges_[first + e].first_hit(point, u, radius));
      behind = std::min(behind, edges_[first + e].first_hit(point, -u, radius));
    });
    first += ring.size();
  }
  return {point - behind * u, point + ahead * u};
}

// Direction from the point of the right wall that the circle at the first end of the segment
// touches to the one that the circle at the last end touches.
Vec2 Corridors::along_wall(const Centre& way, const Vec2& u, double most) const {
  const auto foot = [&](const Vec2& centre) {
    double lowest = HUGE_VAL;
    Vec2 result = centre;
    each_touched(centre, most, [&](const PolygonEdge&, const Distance& distance) {
      if (const double side = cross(distance.gradient, u); side < lowest) {
        lowest = side;
        result = centre - distance.value * distance.gradient;
      }
    });
    return result;
  };
  const Vec2 d = foot(way.last) - foot(way.first);
  return d.dot(u) > 0 ? Vec2(d.normalized()) : u;
}

}  // namespace apothem
