#include "geometry/skeleton/moving_front.hpp"

#include <cmath>

#include "geometry/polygon/random_numbers.hpp"

namespace apothem {
namespace {

using Real = DoubleDouble;
using Time = MovingFront::Time;

// A vertex moves by no more than this share of its distance from the opposite side of a triangle.
constexpr double kSafe = 0x1p-10;

FineVec fine(const Vec2& p) { return {p.x(), p.y()}; }

FrontLine line_through(const FineVec& a, const FineVec& b) {
  const FineVec side = b - a;
  const Real length = sqrt(side.dot(side));
  const FineVec tangent{side.x / length, side.y / length};
  const FineVec normal{-tangent.y, tangent.x};
  return {tangent, normal, normal.dot(a)};
}

// The time at which a decreasing linear function reaches zero, or nothing.
Time zero(const Real& now, const Real& value, const Real& rate) {
  if (!(rate < 0)) return std::nullopt;
  return now - value / rate;
}

Time earlier(const Time& a, const Time& b) {
  if (!a || !b) return a ? a : b;
  return *b < *a ? b : a;
}

}  // namespace

Real twice_area(const FineVec& a, const FineVec& b, const FineVec& c) {
  return cross(b - a, c - a);
}

std::vector<FineVec> moved_vertices(const Polygon& polygon, const std::vector<Triangle>& triangles,
                                    double movement, unsigned seed) {
  std::vector<FineVec> points;
  for (const Vec2& v : polygon.vertices()) points.push_back(fine(v));
  std::vector<double> steps(points.size(), movement);
  for (const Triangle& t : triangles) {
    const double area = static_cast<double>(twice_area(points[t[0]], points[t[1]], points[t[2]]));
    double longest = 0;
    for (int k = 0; k < 3; ++k) {
      longest = std::max(longest, (polygon[t[k]] - polygon[t[(k + 1) % 3]]).norm());
    }
    for (const int v : t) steps[v] = std::min(steps[v], kSafe * area / longest);
  }
  RandomNumbers random(seed);
  for (size_t i = 0; i < points.size(); ++i) {
    const double x = random.uniform(-1, 1);
    const double y = random.uniform(-1, 1);
    points[i] = points[i] + Real(steps[i]) * FineVec{x, y};
  }
  return points;
}

void MovingFront::add_line(const FineVec& a, const FineVec& b) {
  lines_.push_back(line_through(a, b));
}

int MovingFront::add_vertex(const FineVec& start, const Real& since, int before, int after,
                            int node) {
  // The speed v solves n_before . v = n_after . v = 1.
  const FineVec sum = lines_[before].normal + lines_[after].normal;
  vertices_.push_back({start, Real(2) / sum.dot(sum) * sum, since, before, after, node});
  return static_cast<int>(vertices_.size()) - 1;
}

FineVec MovingFront::meeting_point(int e, int f, int g, const Real& time) const {
  const std::array<std::array<int, 2>, 3> pairs{{{e, f}, {f, g}, {g, e}}};
  std::array<int, 2> best = pairs[0];
  Real largest;
  for (const auto& pair : pairs) {
    const Real sine = cross(lines_[pair[0]].normal, lines_[pair[1]].normal);
    if (abs(sine) > abs(largest)) largest = sine, best = pair;
  }
  const FrontLine &p = lines_[best[0]], &q = lines_[best[1]];
  const Real along_p = p.offset + time;
  const Real along_q = q.offset + time;
  return {(along_p * q.normal.y - along_q * p.normal.y) / largest,
          (along_q * p.normal.x - along_p * q.normal.x) / largest};
}

Time MovingFront::collapse_time(const FrontTriangle& t, const Real& now) const {
  const int count = t.front_sides();
  if (count == 3) return end_time(t, now);
  if (count == 0) return flat_time(t, now);
  Time time;
  for (int k = 0; k < 3; ++k) {
    if (t.sides[k] >= 0) continue;
    time = earlier(time, shrink_time(t, k, now));
    if (count == 1) time = earlier(time, reach_time(t, k, now));
  }
  return time;
}

Time MovingFront::shrink_time(const FrontTriangle& t, int k, const Real& now) const {
  const int a = t.corners[(k + 1) % 3];
  const int b = t.corners[(k + 2) % 3];
  const FineVec& tangent = lines_[~t.sides[k]].tangent;
  return zero(now, tangent.dot(place(b, now) - place(a, now)),
              tangent.dot(vertices_[b].speed - vertices_[a].speed));
}

Time MovingFront::reach_time(const FrontTriangle& t, int k, const Real& now) const {
  const FrontLine& line = lines_[~t.sides[k]];
  const int c = t.corners[k];
  return zero(now, line.normal.dot(place(c, now)) - line.offset - now,
              line.normal.dot(vertices_[c].speed) - 1);
}

// The time at which a triangle without front edges becomes flat: the first zero of a quadratic
// function of the time at which it decreases.
Time MovingFront::flat_time(const FrontTriangle& t, const Real& now) const {
  const auto [a, b, c] = t.corners;
  const FineVec origin = place(a, now);
  const FineVec p = place(b, now) - origin;
  const FineVec q = place(c, now) - origin;
  const FineVec dp = vertices_[b].speed - vertices_[a].speed;
  const FineVec dq = vertices_[c].speed - vertices_[a].speed;
  const Real value = cross(p, q);
  const Real half = (cross(p, dq) + cross(dp, q)) * 0.5;
  const Real square = cross(dp, dq);
  if (!(value > 0) && half < 0) return now;
  const Real root = half * half - value * square;
  if (root < 0) return std::nullopt;
  // The zeros are (-half -+ sqrt(root)) / square; the one where the function decreases is
  // (-half - sqrt(root)) / square = value / (sqrt(root) - half). The form without cancellation
  // is taken.
  if (half < 0) return now + value / (sqrt(root) - half);
  if (!(square < 0)) return std::nullopt;
  return now + (half + sqrt(root)) / -square;
}

// The time at which a triangle whose sides are all front edges shrinks to a point: a corner
// reaches the opposite side. The two sides at the corner with the largest angle between their
// lines determine the corner best.
Time MovingFront::end_time(const FrontTriangle& t, const Real& now) const {
  int best = 0;
  double largest = -1;
  for (int k = 0; k < 3; ++k) {
    const double sine = std::abs(static_cast<double>(
        cross(lines_[~t.sides[(k + 1) % 3]].normal, lines_[~t.sides[(k + 2) % 3]].normal)));
    if (sine > largest) largest = sine, best = k;
  }
  return reach_time(t, best, now);
}

}  // namespace apothem
