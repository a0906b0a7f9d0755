// Potentials of polygons at their given positions, for single evaluations of a contact. This header
// is private to edge_integral.cpp and penetration.cpp.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "geometry/integrals/edge_integral.hpp"
#include "lib/execution/elementary.hpp"

namespace apothem {

/// A PlacedPotential with the arrays that it points to, for a polygon that does not move.
/// Coordinates are relative to `origin`, and the reference point of the moments is vertex 0.
struct Placement {
  Placement(const Polygon& polygon, const Potential& potential, const Vec2& origin) {
    const auto n = static_cast<size_t>(polygon.size());
    for (std::vector<double>* v : {&x, &y, &gx, &gy}) v->assign(n + 2 + kReadBehind, 0);
    for (size_t i = 0; i < n + 2; ++i) {
      const size_t from = (i + n - 1) % n;
      const Vec2 point = polygon[static_cast<int>(from)] - origin;
      x[i] = point.x(), y[i] = point.y();
      gx[i] = potential.gradients[from].x(), gy[i] = potential.gradients[from].y();
    }
    double radius = 0;
    for (size_t i = 2; i < n + 2; ++i)
      radius = std::max(radius, hypotenuse(x[i] - x[1], y[i] - y[1]));
    // Each edge of the other polygon would look at all cells of a boundary layer, but the trees
    // find the few features that are near it.
    if (potential.distance && polygon.size() > EdgeTrees::kMany) {
      trees.emplace(x.data() + 1, y.data() + 1, polygon.size(), potential.ring_links());
    }
    // The boundary nodes are the vertices exactly as given. The inner nodes are shifted from the
    // coordinates of the polygon.
    view = {.x = x.data() + 1,
            .y = y.data() + 1,
            .gx = gx.data() + 1,
            .gy = gy.data() + 1,
            .size = polygon.size(),
            .capped = potential.capped(),
            .roof = potential.roof ? &*potential.roof : nullptr,
            .distance = potential.distance ? &*potential.distance : nullptr,
            .reference = Vec2(x[1], y[1]),
            .radius = radius,
            .steepest = potential.steepest,
            .layer = potential.layer && !trees ? &*potential.layer : nullptr,
            .links = potential.ring_links(),
            .trees = trees ? &*trees : nullptr,
            .shift = polygon.origin() - origin};
  }
  Placement(const Placement&) = delete;
  Placement& operator=(const Placement&) = delete;
  std::vector<double> x, y, gx, gy;
  std::optional<EdgeTrees> trees;
  PlacedPotential view;
};

/// Two polygons in a common frame, whose origin lies near both.
struct PlacedPair {
  PlacedPair(const Polygon& polygon_a, const Potential& potential_a, const Polygon& polygon_b,
             const Potential& potential_b)
      : PlacedPair(polygon_a, potential_a, polygon_b, potential_b,
                   common_origin(polygon_a, polygon_b)) {}
  Placement a, b;
  Vec2 centroid_a, centroid_b;  ///< centroids relative to vertex 0 of each polygon, m

  /// Changes the reference points of a PairIntegral or a BoundarySegment from vertex 0 to the
  /// centroids.
  template <class Integrals>
  void about_centroids(Integrals& pair) const {
    pair.moment_a -= cross(centroid_a, pair.force);
    pair.moment_b += cross(centroid_b, pair.force);
    pair.centre -= centroid_a;
    if constexpr (requires { pair.middle; }) {
      if (const double size = pair.force.norm(); size > 0) {
        pair.middle -= cross(pair.force, centroid_a) / size;
      }
    }
  }

 private:
  PlacedPair(const Polygon& polygon_a, const Potential& potential_a, const Polygon& polygon_b,
             const Potential& potential_b, const Vec2& origin)
      : a(polygon_a, potential_a, origin),
        b(polygon_b, potential_b, origin),
        centroid_a(area_moments(polygon_a).centroid),
        centroid_b(area_moments(polygon_b).centroid) {}

  static Vec2 common_origin(const Polygon& a, const Polygon& b) {
    Box box = bounding_box(a);
    box.include(bounding_box(b));
    return local_origin(box);
  }
};

}  // namespace apothem
