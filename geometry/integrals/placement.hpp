// Potentials of polygons at their given positions, for single evaluations of a contact. This header
// is private to edge_integral.cpp, contact_patches.cpp and penetration.cpp.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "apothem/geometry/integrals/edge_integral.hpp"

namespace apothem {

/// A PlacedPotential with the arrays that it points to, for a polygon that does not move.
/// Coordinates are relative to `origin`, and the reference point of the moments is vertex 0.
struct Placement {
  Placement(const Polygon& polygon, const Potential& potential, const Vec2& origin) {
    const auto add = [&](const Vec2& p) {
      x.push_back(p.x());
      y.push_back(p.y());
    };
    for (const Vec2& v : polygon.vertices()) add(v - origin);
    add(polygon[0] - origin);
    for (const Vec2& g : potential.gradients) {
      gx.push_back(g.x());
      gy.push_back(g.y());
    }
    if (potential.roof) {
      // Boundary nodes are the vertices exactly as given. Inner nodes are shifted from the
      // coordinates of the polygon.
      node_x.assign(x.begin(), x.end() - 1);
      node_y.assign(y.begin(), y.end() - 1);
      const Vec2 shift = polygon.origin() - origin;
      for (size_t i = polygon.vertices().size(); i < potential.roof->points.size(); ++i) {
        node_x.push_back(potential.roof->points[i].x() + shift.x());
        node_y.push_back(potential.roof->points[i].y() + shift.y());
      }
    }
    double radius = 0;
    for (size_t i = 1; i < x.size(); ++i)
      radius = std::max(radius, std::hypot(x[i] - x[0], y[i] - y[0]));
    view = {x.data(),
            y.data(),
            gx.data(),
            gy.data(),
            polygon.size(),
            potential.capped(),
            potential.roof ? &*potential.roof : nullptr,
            node_x.data(),
            node_y.data(),
            potential.distance ? &*potential.distance : nullptr,
            Vec2(x[0], y[0]),
            radius,
            potential.steepest,
            potential.cells.empty() ? nullptr : potential.cells.data()};
  }
  std::vector<double> x, y, gx, gy, node_x, node_y;
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

  /// Changes the reference points of a PairIntegral or a BoundaryRun from vertex 0 to the
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
    const Box box_b = bounding_box(b);
    box.include(box_b.x0, box_b.y0);
    box.include(box_b.x1, box_b.y1);
    return local_origin(box);
  }
};

}  // namespace apothem
