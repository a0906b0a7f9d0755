#include "geometry/integrals/edge_integral.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "geometry/integrals/distance_volume.hpp"
#include "geometry/integrals/edge_trace.hpp"
#include "geometry/integrals/overlap_energy.hpp"
#include "geometry/integrals/placement.hpp"
#include "geometry/potential/lower_envelope.hpp"
#include "geometry/spatial/boundary_inside.hpp"

namespace apothem {

using namespace edge_detail;

namespace {

bool serve_as_windows(const PlacedPotential& a, const PlacedPotential& b) {
  return std::max(a.size, b.size) > ConvexPairs::kMostSides && ConvexWindow::serves(a) &&
         ConvexWindow::serves(b);
}

}  // namespace

PairIntegral pair_integral(const PlacedPotential& a, const PlacedPotential& b, const Vec2& offset,
                           EdgeWorkspace& workspace, NearEdges& near) {
  if (ConvexPairs::serves(a) && ConvexPairs::serves(b)) {
    workspace.convex.add(a, b, offset, near);
    return workspace.convex.evaluate()[0];
  }
  if (serve_as_windows(a, b)) {
    if (const auto pair = windowed_integral(a, b, offset, near, workspace)) return *pair;
  }
  const auto nothing = [](const auto&...) {};
  return integrate_pair<false>(a, b, offset, near, workspace, nothing, nothing);
}

PairIntegral pair_integral(const PlacedPotential& a, const PlacedPotential& b, const Vec2& offset,
                           EdgeWorkspace& workspace) {
  NearEdges all;
  return pair_integral(a, b, offset, workspace, all);
}

namespace {

// The linear functions of the edges of p, in coordinates shifted by `shift`.
std::vector<lower_envelope::Line<double>> lines(const PlacedPotential& p, const Vec2& shift) {
  std::vector<lower_envelope::Line<double>> result;
  for (int i = 0; i < p.size; ++i) {
    const Vec2 g(p.gx[i], p.gy[i]);
    result.push_back({g, -g.dot(Vec2(p.x[i], p.y[i]) + shift)});
  }
  return result;
}

using Ring = std::vector<Vec2>;
using PlacedRings = std::vector<Ring>;
using Parts = std::vector<lower_envelope::SignedRing<double>>;

// The rings of a polygon. Holes are clockwise, so that integrals over a polygon are the sums of
// those over its rings.
PlacedRings placed_rings(const PlacedPotential& p, const Vec2& shift) {
  PlacedRings rings;
  for_each_ring(p.links, p.size, [&](int first, int last) {
    rings.emplace_back();
    for (int v = first; v < last; ++v) rings.back().push_back(Vec2(p.x[v], p.y[v]) + shift);
  });
  return rings;
}

// A polygon as a signed sum of convex ones.
Parts convex_parts(const PlacedPotential& p, const PlacedRings& rings) {
  if (p.convex()) return {{rings[0], 1}};
  Parts parts;
  for (const Ring& ring : rings) {
    Parts more = lower_envelope::fan(ring);
    std::move(more.begin(), more.end(), std::back_inserter(parts));
  }
  return parts;
}

// INT phi_p dA over the overlap of p with the other polygon, which is given by its outer ring and
// its convex parts.
double volume_under(const PlacedPotential& p, const Vec2& shift, const Ring& other,
                    const Parts& parts) {
  if (!p.roof) {
    const Ring outline = placed_rings(p, shift).front();
    OverlapEnergy energy;
    double volume = 0;
    for (const auto& part : parts) {
      volume +=
          part.sign * energy.volume_under(p, shift, lower_envelope::inside(part.ring, outline));
    }
    return volume;
  }
  // Convex parts may reach beyond their polygon. Faces that the polygon does not meet are skipped,
  // because their sum would be 0.
  const std::vector<lower_envelope::Line<double>> planes = lines(p, shift);
  const lower_envelope::Bounds<double> reach(other);
  std::vector<Ring> faces;
  std::vector<lower_envelope::Line<double>> of_faces;
  RoofNodes placed;
  placed.place(p);
  for (size_t e = 0; e < p.roof->faces.size(); ++e) {
    Ring face;
    for (const int i : p.roof->faces[e]) face.push_back(Vec2(placed.x[i], placed.y[i]) + shift);
    if (reach.apart(lower_envelope::Bounds<double>(face))) continue;
    faces.push_back(std::move(face));
    of_faces.push_back(planes[e]);
  }
  return lower_envelope::volume_under_faces(faces, of_faces, p.capped, parts);
}

struct BoxedEdge {
  int index;
  Box box;
};

// The edges of a polygon moved by `shift` whose boxes meet `reach`.
std::vector<BoxedEdge> edges_in(const PlacedPotential& p, const Vec2& shift, const Box& reach) {
  std::vector<BoxedEdge> edges;
  for (int e = 0; e < p.size; ++e) {
    const int end = p.end(e);
    const Box box = box_of(Vec2(p.x[e], p.y[e]) + shift, Vec2(p.x[end], p.y[end]) + shift);
    if (!apart(box, reach)) edges.push_back({e, box});
  }
  return edges;
}

// Whether the box of an edge of p, which is moved by `shift`, meets a box. `edges` are those that
// may.
bool any_meets(const PlacedPotential& p, const std::vector<BoxedEdge>& edges, const Vec2& shift,
               const Box& box) {
  if (!p.trees) {
    return std::ranges::any_of(edges, [&](const BoxedEdge& edge) { return !apart(edge.box, box); });
  }
  const Box moved{box.x0 - shift.x(), box.y0 - shift.y(), box.x1 - shift.x(), box.y1 - shift.y()};
  bool found = false;
  p.trees->each([&](const Box& run) { return !found && !apart(run, moved); },
                [&](int e) {
                  const int end = p.end(e);
                  found = found ||
                          !apart(box_of(Vec2(p.x[e], p.y[e]), Vec2(p.x[end], p.y[end])), moved);
                });
  return found;
}

// Whether p, which is moved by `shift`, encloses a point.
bool surrounds(const PlacedPotential& p, const Vec2& shift, const Vec2& point) {
  return p.trees ? p.trees->encloses(point - shift) : encloses(p, shift, point);
}

// Extends a box by the edges of p that may be part of the boundary of its overlap with another
// polygon, as far as they are in `reach`: those near an edge of the other polygon, and those inside
// it. An edge that follows one away from all edges of the other is on the same side of these.
// Returns whether an edge has been seen to lie outside the other polygon.
template <class Near, class Inside>
bool include_edges(const PlacedPotential& p, const std::vector<BoxedEdge>& edges, const Near& nears,
                   const Box& reach, const Inside& inside, Box& box) {
  int away = -1;  // start of the edge behind the last one that is away from all others
  bool is_inside = false, any_outside = static_cast<int>(edges.size()) < p.size;
  for (const BoxedEdge& edge : edges) {
    const bool near = nears(edge.box);
    if (!near && away != edge.index) is_inside = inside(edge.index);
    away = near ? -1 : p.end(edge.index);
    if (!near && !is_inside) any_outside = true;
    if (!near && !is_inside) continue;
    box.include(std::max(edge.box.x0, reach.x0), std::max(edge.box.y0, reach.y0));
    box.include(std::min(edge.box.x1, reach.x1), std::min(edge.box.y1, reach.y1));
  }
  return any_outside;
}

// Bounds of the overlap of p with q, which is moved by `shift`. Both have finite coordinates. If q
// is partly outside p, each component of the overlap has a part of p's boundary, so that no point
// of it is deeper than the box around it is long.
OverlapBounds overlap_bounds(const PlacedPotential& p, const PlacedPotential& q,
                             const Vec2& shift) {
  const Box of_p = box_of(p, Vec2::Zero()), of_q = box_of(q, shift);
  const double slack = kFarAway * std::max(of_p.extent(), of_q.extent());
  const Box reach = Box{std::max(of_p.x0, of_q.x0), std::max(of_p.y0, of_q.y0),
                        std::min(of_p.x1, of_q.x1), std::min(of_p.y1, of_q.y1)}
                        .grown(slack);
  Box box;
  if (!(reach.x0 <= reach.x1 && reach.y0 <= reach.y1)) return {box, 0};
  const Vec2 zero = Vec2::Zero();
  std::vector<BoxedEdge> edges_p = edges_in(p, zero, reach);
  const std::vector<BoxedEdge> edges_q = edges_in(q, shift, reach);
  for (BoxedEdge& edge : edges_p) edge.box = edge.box.grown(slack);
  const auto near_q = [&](const Box& b) { return any_meets(q, edges_q, shift, b); };
  const auto near_p = [&](const Box& b) {
    return any_meets(p, edges_p, zero, p.trees ? b.grown(slack) : b);
  };
  const auto in_q = [&](int e) { return surrounds(q, shift, {p.x[e], p.y[e]}); };
  const auto in_p = [&](int e) { return surrounds(p, zero, Vec2(q.x[e], q.y[e]) + shift); };
  include_edges(p, edges_p, near_q, reach, in_q, box);
  const bool partly = include_edges(q, edges_q, near_p, reach, in_p, box);
  box = box.grown(slack);
  const double diagonal = Vec2(box.x1 - box.x0, box.y1 - box.y0).norm();
  return {box, partly ? diagonal : std::numeric_limits<double>::infinity()};
}

// INT phi_p dA over the overlap if p has a distance field. `shift` moves the coordinates of the
// other polygon to the frame of p.
double volume_under_distance(const PlacedPotential& p, const PlacedPotential& other,
                             const Vec2& shift) {
  const double finite = all_finite(other, p, shift.x(), shift.y());
  if (!(finite == 0)) return finite;
  const OverlapBounds overlap = overlap_bounds(p, other, shift);
  if (!(overlap.box.x0 <= overlap.box.x1)) return 0;
  DistanceVolume<double> integral;
  double volume = 0;
  for (const Ring& ring : placed_rings(other, shift)) {
    std::vector<double> x, y;
    for (const Vec2& v : ring) {
      x.push_back(v.x());
      y.push_back(v.y());
    }
    volume += integral.over(placed_distance(p), x, y, overlap);
  }
  return volume;
}

// A pair in the frame of b.
struct ClippedPair {
  ClippedPair(const PlacedPotential& placed_a, const PlacedPotential& placed_b, const Vec2& shift)
      : a(placed_a),
        b(placed_b),
        offset(shift),
        rings_a(placed_rings(a, offset)),
        rings_b(placed_rings(b, Vec2::Zero())),
        parts_a(convex_parts(a, rings_a)),
        parts_b(convex_parts(b, rings_b)) {}

  [[nodiscard]] double energy() const {
    return (a.distance ? volume_under_distance(a, b, -offset)
                       : volume_under(a, offset, rings_b.front(), parts_b)) +
           (b.distance ? volume_under_distance(b, a, offset)
                       : volume_under(b, Vec2::Zero(), rings_a.front(), parts_a));
  }
  [[nodiscard]] double overlap_area() const {
    const lower_envelope::Line<double> one{Vec2::Zero(), 1};
    double area = 0;
    std::vector<Box> boxes;
    for (const auto& part_b : parts_b) boxes.push_back(box_of(part_b.ring));
    for (const auto& part_a : parts_a) {
      const Box box = box_of(part_a.ring);
      for (size_t i = 0; i < parts_b.size(); ++i) {
        if (apart(box, boxes[i])) continue;
        const auto& part_b = parts_b[i];
        area +=
            part_a.sign * part_b.sign *
            lower_envelope::area_integral(lower_envelope::inside(part_a.ring, part_b.ring), one);
      }
    }
    return area;
  }

 private:
  const PlacedPotential &a, &b;
  Vec2 offset;
  PlacedRings rings_a, rings_b;
  Parts parts_a, parts_b;
};

}  // namespace

double pair_energy(const PlacedPotential& a, const PlacedPotential& b, const Vec2& offset,
                   OverlapEnergy& memory) {
  if (!a.convex() || !b.convex()) return ClippedPair(a, b, offset).energy();
  if (serve_as_windows(a, b)) {
    NearEdges near;
    EdgeWorkspace& edges = memory.edges();
    if (const auto pair = windowed_integral(a, b, offset, near, edges)) {
      const ConvexWindows& windows = edges.windows;
      return pair->touching() ? memory.of_convex(windows.a.view(), windows.b.view(), offset) : 0;
    }
  }
  return memory.of_convex(a, b, offset);
}

PairVolume pair_volume(const PlacedPotential& a, const PlacedPotential& b, const Vec2& offset) {
  OverlapEnergy memory;
  return {pair_energy(a, b, offset, memory), ClippedPair(a, b, offset).overlap_area()};
}

Vec2 loading_point(const PairIntegral& pair) {
  const double size = pair.force.norm();
  if (!(size > kNoLineOfAction * pair.weight)) return pair.centre;
  const Vec2 tangent(-pair.force.y() / size, pair.force.x() / size);
  return pair.centre + tangent * ((cross(pair.centre, pair.force) - pair.moment_a) / size);
}

namespace {

// Single evaluations of needles (very thin polygons) use more digits. In the step loop this would
// not help, because the rotation of the vertices has rounded them already.
using Fine = long double;

bool is_needle(const Polygon& a, const Potential& potential_a, const Polygon& b,
               const Potential& potential_b) {
  const double size = std::max(bounding_box(a).extent(), bounding_box(b).extent());
  const double steepest = std::max(potential_a.steepest, potential_b.steepest);
  return a.is_convex() && b.is_convex() && size * steepest > kNeedle;
}

// The heights of points over the edges of y divided by the reference length. The directions of the
// edges are computed again from the vertices.
class FineLines {
 public:
  explicit FineLines(const PlacedPotential& y) : y_(y) {
    for (int i = 0; i < y.size; ++i) {
      const Fine tx = static_cast<Fine>(y.x[y.end(i)]) - y.x[i];
      const Fine ty = static_cast<Fine>(y.y[y.end(i)]) - y.y[i];
      const Fine slope =
          std::hypot(static_cast<Fine>(y.gx[i]), static_cast<Fine>(y.gy[i])) / std::hypot(tx, ty);
      gx_.push_back(-ty * slope);
      gy_.push_back(tx * slope);
    }
  }
  [[nodiscard]] std::vector<Fine> at(Fine px, Fine py) const {
    std::vector<Fine> row;
    row.reserve(static_cast<size_t>(y_.size) + 1);
    for (int i = 0; i < y_.size; ++i)
      row.push_back(gx_[i] * (px - y_.x[i]) + gy_[i] * (py - y_.y[i]));
    if (y_.capped) row.push_back(1);
    return row;
  }

 private:
  const PlacedPotential& y_;
  std::vector<Fine> gx_, gy_;
};

// The integrals of phi of y along the edges of x in long double, for polygons at their given
// positions.
Half integrate_needle(const PlacedPotential& x, const PlacedPotential& y, SegmentEnds& ends) {
  const FineLines lines(y);
  Half half;
  for (int e = 0; e < x.size; ++e) {
    const BasicEdge<Fine> edge(x, y, e, 0, 0);
    const std::vector<Fine> start = lines.at(edge.px, edge.py);
    const std::vector<Fine> end = lines.at(edge.px + edge.ex, edge.py + edge.ey);
    const Row<Fine> row{start.data(), end.data(), y.size, static_cast<int>(start.size())};
    Fine s0, s1;
    if (!clip(row, s0, s1)) continue;
    const Fine fraction = s1 - s0;
    SegmentMoments<Fine> moments;  // along the part of the edge inside y
    walk_envelope(row, s0, s1, true, [&](bool there, Fine u1, Fine v1, Fine u2, Fine v2) {
      moments.add(there, (u1 - s0) / fraction, v1, (u2 - s0) / fraction, v2);
    });
    PlacedEdge part(x, y, e, 0, 0);
    part.qx = static_cast<double>(edge.qx + s0 * edge.ex);
    part.qy = static_cast<double>(edge.qy + s0 * edge.ey);
    part.ex = static_cast<double>(fraction * edge.ex);
    part.ey = static_cast<double>(fraction * edge.ey);
    const SegmentMoments<double> rounded{static_cast<double>(moments.sum),
                                         static_cast<double>(moments.first),
                                         static_cast<double>(moments.largest)};
    half.add(along_edge(part, rounded, 1.));
    ends.add(part, 0, 1);
  }
  return half;
}

PairIntegral needle_integral(const PlacedPotential& a, const PlacedPotential& b,
                             EdgeWorkspace& workspace) {
  SegmentEnds ends(workspace.ends);
  const Half of_a = integrate_needle(a, b, ends);
  const size_t middle = ends.used();
  const Half of_b = integrate_needle(b, a, ends);
  return join(a, b, Vec2::Zero(), of_a, of_b, ends, middle);
}

}  // namespace

PairResult edge_method(const Polygon& a, const Potential& potential_a, const Polygon& b,
                       const Potential& potential_b) {
  PairResult result;
  const double own_length_a = boundary_inside(a, b);
  const double own_length_b = boundary_inside(b, a);
  if (own_length_a == 0 && own_length_b == 0) return result;
  const PlacedPair placed(a, potential_a, b, potential_b);
  EdgeWorkspace workspace;
  PairIntegral& pair = result.integral;
  pair = is_needle(a, potential_a, b, potential_b)
             ? needle_integral(placed.a.view, placed.b.view, workspace)
             : pair_integral(placed.a.view, placed.b.view, Vec2::Zero(), workspace);
  placed.about_centroids(pair);
  pair.own_length_a = own_length_a;
  pair.own_length_b = own_length_b;
  // The area by clipped triangles takes n^2 steps.
  constexpr double kManyPairs = 64. * 64;  // of edges
  if (static_cast<double>(a.size()) * b.size() > kManyPairs) {
    OverlapEnergy memory;
    result.volume = {pair_energy(placed.a.view, placed.b.view, Vec2::Zero(), memory),
                     area_inside(a, b)};
  } else {
    result.volume = pair_volume(placed.a.view, placed.b.view, Vec2::Zero());
  }
  return result;
}

}  // namespace apothem
