// The penetration of two polygons: how deep the boundary of one lies in the other.
//
// The penetration of a contact patch is the largest Euclidean distance, from the whole boundary of
// one polygon, of a point of the patch that lies on the boundary of the other one. For a tip pushed
// into a face it is how far the tip is in, for face on face the distance of the two faces. It does
// not depend on the potential.
#pragma once

#include <span>
#include <vector>

#include "geometry/integrals/contact_patches.hpp"
#include "geometry/potential/potential.hpp"

namespace apothem {

/// Distances from a boundary, which is a list of segments. No allocation after the first calls with
/// boundaries of a given size.
class BoundaryDistance {
 public:
  void clear() { segments_.clear(); }
  [[nodiscard]] bool empty() const { return segments_.empty(); }
  /// Adds the segment between two points, m.
  void add(const Vec2& from, const Vec2& to);
  /// The distance of a point, m; infinite if there is no segment.
  [[nodiscard]] double at(const Vec2& point) const;
  /// The largest distance of a point of the segment from p to q, m, to 1e-12 of itself; `floor` if
  /// it is not larger than that. Points on both sides of the boundary count.
  [[nodiscard]] double largest(const Vec2& p, const Vec2& q, double floor = 0);

 private:
  struct Segment {
    Vec2 from, along;
    double inverse_length;  // 1/m
    [[nodiscard]] double distance(const Vec2& point) const;
  };
  struct Interval {
    double from, to;  // interval of the segment p q, from 0 to 1
    int level;        // number of divisions so far
  };
  std::vector<Segment> segments_;
  std::vector<Interval> open_;
};

/// The boundaries of two polygons. Keep one per thread.
struct PenetrationWorkspace {
  BoundaryDistance a, b;
};

/// Raises the entry of `deepest` of every patch, m, to the patch's penetration if that is larger.
/// `segments` are those that contact_patches has found for the same arguments.
void find_penetrations(const PlacedPotential& a, const PlacedPotential& b, const Vec2& offset,
                       std::span<const BoundarySegment> segments, PenetrationWorkspace& workspace,
                       std::span<double> deepest);

/// The largest penetration of two polygons at their given positions, m; 0 if they do not touch. It
/// is meant for single evaluations and allocates. Throws InvalidPolygon if a polygon is thinner
/// than double precision resolves.
double penetration(const Polygon& a, const Polygon& b);

/// A bound of the ratio of the distance from a polygon's boundary to phi over the steepest slope,
/// which is the depth that PairIntegral has. It is 1 where that depth is the distance. In faces of
/// a roof beyond the end of their edge, at reflex vertices, the distance is larger.
double depth_ratio(const Potential& potential);

}  // namespace apothem
