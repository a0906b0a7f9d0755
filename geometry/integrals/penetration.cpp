#include "geometry/integrals/penetration.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/integrals/placement.hpp"
#include "geometry/polygon/cyclic.hpp"
#include "lib/execution/elementary.hpp"

namespace apothem {

namespace {

constexpr double kAccuracy = 1e-12;  // relative accuracy of a largest distance
// Shortest interval to be divided, as a fraction of the segment.
constexpr double kShortest = 1e-14;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

void BoundaryDistance::add(const Vec2& from, const Vec2& to) {
  segments_.push_back({from, to - from, 1 / (to - from).norm()});
}

double BoundaryDistance::Segment::distance(const Vec2& point) const {
  const Vec2 arm = point - from;
  const double fraction = arm.dot(along) * inverse_length * inverse_length;
  if (fraction > 0 && fraction < 1) return std::abs(cross(along, arm)) * inverse_length;
  return std::sqrt(std::min(arm.squaredNorm(), (arm - along).squaredNorm()));
}

double BoundaryDistance::at(const Vec2& point) const {
  double nearest = kInfinity;
  for (const Segment& segment : segments_) nearest = std::min(nearest, segment.distance(point));
  return nearest;
}

// Branch and bound. Along a line the distance from one segment is a convex function. On an interval
// it is therefore at most the larger of its values at the two ends, and the smallest of these over
// all segments bounds the distance from the boundary. An interval is divided where the chords of
// the two segments meet that are nearest to its ends. That is the largest distance if both
// functions are linear; every third division is in the middle, so that curved ones converge as
// well.
double BoundaryDistance::largest(const Vec2& p, const Vec2& q, double floor) {
  double best = floor;
  open_.assign(1, {0, 1, 0});
  while (!open_.empty()) {
    const Interval i = open_.back();
    open_.pop_back();
    const Vec2 start = p + i.from * (q - p);
    const Vec2 end = p + i.to * (q - p);
    struct Nearest {
      double here = kInfinity, there = kInfinity;  // distances at this end and at the other one
    } first, last;
    double bound = kInfinity;
    for (const Segment& segment : segments_) {
      const double d0 = segment.distance(start);
      const double d1 = segment.distance(end);
      if (d0 < first.here) first = {d0, d1};
      if (d1 < last.here) last = {d1, d0};
      bound = std::min(bound, std::max(d0, d1));
    }
    if (!(bound < kInfinity)) return best;  // no boundary, or a coordinate that is not finite
    best = std::max({best, first.here, last.here});
    if (bound <= best * (1 + kAccuracy) || i.to - i.from < kShortest) continue;
    const double rise = last.there - first.here;
    const double fall = first.there - last.here;
    const double fraction = rise / (rise + fall);
    const bool chords = i.level % 3 < 2 && fraction > 0 && fraction < 1;
    const double middle = i.from + (chords ? fraction : .5) * (i.to - i.from);
    open_.push_back({i.from, middle, i.level + 1});
    open_.push_back({middle, i.to, i.level + 1});
  }
  return best;
}

void find_penetrations(const PlacedPotential& a, const PlacedPotential& b, const Vec2& offset,
                       std::span<const BoundarySegment> segments, PenetrationWorkspace& workspace,
                       std::span<double> deepest) {
  const auto place = [](const PlacedPotential& p, const Vec2& origin, BoundaryDistance& boundary) {
    boundary.clear();
    for (int i = 0; i < p.size; ++i) {
      const int end = p.end(i);
      boundary.add(Vec2(p.x[i], p.y[i]) - origin, Vec2(p.x[end], p.y[end]) - origin);
    }
  };
  // The points of segments are relative to the reference point of a.
  place(a, a.reference, workspace.a);
  place(b, edge_detail::arm(a, b, offset) + b.reference, workspace.b);
  for (const BoundarySegment& segment : segments) {
    double& deep = deepest[static_cast<size_t>(segment.patch)];
    deep = (segment.of_a ? workspace.b : workspace.a).largest(segment.start, segment.end, deep);
  }
}

double penetration(const Polygon& a, const Polygon& b) {
  // Any potential finds the patches. This one needs no skeleton.
  const PotentialChoice any{PotentialChoice::Kind::distance, PotentialChoice::Field::distance,
                            PotentialChoice::Reference::length, 1};
  const Potential potential_a = make_potential(a, any);
  const Potential potential_b = make_potential(b, any);
  const PlacedPair placed(a, potential_a, b, potential_b);
  PatchWorkspace patch_workspace;
  std::vector<BoundarySegment> segments;
  std::vector<PairIntegral> patches;
  contact_patches(placed.a.view, placed.b.view, Vec2::Zero(), patch_workspace, segments, patches);
  std::vector<double> deepest(patches.size());
  PenetrationWorkspace workspace;
  find_penetrations(placed.a.view, placed.b.view, Vec2::Zero(), segments, workspace, deepest);
  return deepest.empty() ? 0 : *std::max_element(deepest.begin(), deepest.end());
}

double depth_ratio(const Potential& potential) {
  double ratio = 1;
  for (const Vec2& g : potential.gradients) {  // they differ in the area potential
    const double steeper = potential.steepest / g.norm();
    if (steeper > 1 + 1e-9) ratio = std::max(ratio, steeper);
  }
  if (!potential.roof) return ratio;
  // A point of the face of an edge is at the height h above the edge's line, and no farther from
  // the boundary than the hypotenuse of h and of the distance o by which its foot misses the edge.
  // o/h is largest at a corner of the face.
  const int n = potential.size();
  for (int e = 0; e < n; ++e) {
    const Vec2& from = potential.vertices[e];
    const Vec2 along = potential.vertices[potential.next(e)] - from;
    const double length = along.norm();
    for (const int node : potential.roof->faces[e]) {
      if (node < n) continue;  // on the boundary
      const Vec2 arm = potential.roof->points[node] - from;
      const double foot = arm.dot(along) / length;
      const double height = cross(along, arm) / length;
      ratio = std::max(ratio, hypotenuse(1, std::max({0., -foot, foot - length}) / height));
    }
  }
  return ratio;
}

}  // namespace apothem
