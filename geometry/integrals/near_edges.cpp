#include "geometry/integrals/near_edges.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/integrals/placed_potential.hpp"
#include "geometry/polygon/segment.hpp"

namespace apothem {

namespace {

using Segment = NearEdgesWorkspace::Segment;

double distance2(const Box& a, const Box& b) {
  const double dx = std::max({0., a.x0 - b.x1, b.x0 - a.x1});
  const double dy = std::max({0., a.y0 - b.y1, b.y0 - a.y1});
  return dx * dx + dy * dy;
}

double distance2(const Vec2& point, const Segment& s) {
  return nearest_on_segment(point - s.from, s.to - s.from).distance2;
}

// The squared distance of two segments. Segments that only just cross have an end whose distance is
// round-off; others cross clearly.
double distance2(const Segment& s, const Segment& t) {
  const auto separates = [](const Segment& line, const Segment& other) {
    const Vec2 along = line.to - line.from;
    return (cross(along, Vec2(other.from - line.from)) > 0) !=
           (cross(along, Vec2(other.to - line.from)) > 0);
  };
  if (separates(s, t) && separates(t, s)) return 0;
  return std::min(
      {distance2(s.from, t), distance2(s.to, t), distance2(t.from, s), distance2(t.to, s)});
}

// Finds the edges of x whose boxes are nearer than the skin to the box of the other polygon. Lowers
// `rest2` to the squared distance of the other edges.
void collect(const PlacedPotential& x, const Vec2& shift, const Box& other, double skin2,
             std::vector<Segment>& segments, double& rest2) {
  segments.clear();
  for (int e = 0; e < x.size; ++e) {
    Segment s{Vec2(x.x[e], x.y[e]) + shift,
              Vec2(x.x[x.end(e)], x.y[x.end(e)]) + shift,
              {},
              e,
              std::numeric_limits<double>::infinity()};
    s.box = box_of(s.from, s.to);
    const double d2 = distance2(s.box, other);
    if (d2 > skin2) {
      rest2 = std::min(rest2, d2);
    } else {
      segments.push_back(s);
    }
  }
}

std::uint64_t select(std::vector<Segment>& segments, const PlacedPotential& other,
                     const Vec2& shift, double skin2, double& rest2) {
  std::uint64_t set = 0;
  for (const Segment& s : segments) {
    if (s.distance2 <= skin2 || encloses(other, shift, s.from)) {
      set |= std::uint64_t{1} << (s.edge % 64);
    } else {
      rest2 = std::min(rest2, s.distance2);
    }
  }
  return set;
}

}  // namespace

NearEdges near_edges(const PlacedPotential& a, const PlacedPotential& b, const Vec2& offset,
                     double skin, NearEdgesWorkspace& workspace) {
  const Vec2 zero = Vec2::Zero();
  const Box box_a = box_of(a, offset);
  const Box box_b = box_of(b, zero);
  const double size =
      (box_a.x1 - box_a.x0) + (box_a.y1 - box_a.y0) + (box_b.x1 - box_b.x0) + (box_b.y1 - box_b.y0);
  const double finite = size + all_finite(a, b, offset.x(), offset.y());
  // Distances are rounded; an edge within the round-off counts as near.
  const double round = 1e-12 * size;
  if (!(finite < HUGE_VAL) || !(skin > 2 * round)) return {};
  const double skin2 = skin * skin;
  auto& [of_a, of_b] = workspace;
  double rest2 = std::numeric_limits<double>::infinity();
  collect(a, offset, box_b, skin2, of_a, rest2);
  collect(b, zero, box_a, skin2, of_b, rest2);
  for (Segment& s : of_a) {
    for (Segment& t : of_b) {
      const double known = std::max(s.distance2, t.distance2);
      if (!(distance2(s.box, t.box) < known)) continue;
      const double d2 = distance2(s, t);
      s.distance2 = std::min(s.distance2, d2);
      t.distance2 = std::min(t.distance2, d2);
    }
  }
  NearEdges result;
  result.of_a = select(of_a, b, zero, skin2, rest2);
  result.of_b = select(of_b, a, offset, skin2, rest2);
  result.skin = (result.none() ? std::sqrt(rest2) : skin) - round;
  return result;
}

}  // namespace apothem
