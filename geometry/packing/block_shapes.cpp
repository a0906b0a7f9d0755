#include "geometry/packing/block_shapes.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "geometry/polygon/cyclic.hpp"
#include "geometry/polygon/polygon.hpp"
#include "lib/execution/elementary.hpp"

namespace apothem {
namespace {

constexpr double kTurn = .45;      // rad
constexpr double kNearest = .5;    // of a corner from the centre, over a common length
constexpr double kFarthest = .72;  // likewise
constexpr int kDraws = 1000;

bool angles_between(const std::vector<Vec2>& ring, double smallest, double largest) {
  for (size_t i = 0; i < ring.size(); ++i) {
    const Vec2 to_next = after(ring, i) - ring[i], to_last = before(ring, i) - ring[i];
    const double angle = arc_tangent(cross(to_next, to_last), to_next.dot(to_last));
    if (!(angle >= smallest && angle <= largest)) return false;
  }
  return true;
}

}  // namespace

std::vector<Vec2> random_quadrilateral(RandomNumbers& random, double smallest, double largest) {
  for (int draw = 0; draw < kDraws; ++draw) {
    std::vector<Vec2> ring;
    for (int k = 0; k < 4; ++k) {
      const double angle = k * M_PI / 2 + random.uniform(-kTurn, kTurn);
      const double radius = random.uniform(kNearest, kFarthest);
      const auto [s, c] = sine_cosine(angle);
      ring.emplace_back(radius * c, radius * s);
    }
    if (angles_between(ring, smallest, largest)) return normalised(std::move(ring));
  }
  throw std::invalid_argument("no quadrilateral has all its angles in this narrow a range");
}

std::vector<Vec2> random_polygon(RandomNumbers& random, int corners, double aspect,
                                 double roundness) {
  const double off = (1 - roundness) / 2;
  std::vector<Vec2> ring;
  for (int k = 0; k < corners; ++k) {
    const double angle = 2 * M_PI * (k + random.uniform(-off, off)) / corners;
    const auto [s, c] = sine_cosine(angle);
    ring.emplace_back(aspect * c, s);
  }
  return normalised(std::move(ring));
}

std::vector<Vec2> cross_shape(double arm) {
  const double near = .5, far = near + arm;
  return normalised({{-near, -far},
                     {near, -far},
                     {near, -near},
                     {far, -near},
                     {far, near},
                     {near, near},
                     {near, far},
                     {-near, far},
                     {-near, near},
                     {-far, near},
                     {-far, -near},
                     {-near, -near}});
}

std::vector<Vec2> normalised(std::vector<Vec2> ring) {
  const Polygon polygon(std::move(ring));
  const AreaMoments moments = area_moments(polygon);
  std::vector<Vec2> result = polygon.local_vertices();
  const double scale = 1 / std::sqrt(moments.area);
  for (Vec2& v : result) v = scale * (v - moments.centroid);
  return result;
}

PolygonWithHoles normalised_with_holes(const Polygon& polygon) {
  Rings rings = rings_of(polygon);
  const Polygon outer(rings[0]);
  const Vec2 middle = outer.origin() + area_moments(outer).centroid;
  const double scale = 1 / std::sqrt(area_moments(polygon).area);
  for (std::vector<Vec2>& ring : rings) {
    for (Vec2& v : ring) v = scale * (v - middle);
  }
  return polygon_of_rings(rings);
}

void place_into(const std::vector<Vec2>& ring, const Vec2& place, double angle, double scale,
                std::vector<Vec2>& result) {
  const auto [sine, cosine] = sine_cosine(angle);
  const double c = scale * cosine, s = scale * sine;
  result.clear();
  for (const Vec2& v : ring) {
    result.emplace_back(place.x() + c * v.x() - s * v.y(), place.y() + s * v.x() + c * v.y());
  }
}

std::vector<Vec2> placed(const std::vector<Vec2>& ring, const Vec2& place, double angle,
                         double scale) {
  std::vector<Vec2> result;
  place_into(ring, place, angle, scale, result);
  return result;
}

}  // namespace apothem
