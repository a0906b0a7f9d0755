// Eq. 8 of the paper on an overlap polygon, for any number type. This header is private to
// overlap.cpp and exact_integral.cpp. All coordinates of one call are relative to one origin, which
// is best chosen inside the overlap.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "geometry/exact/overlap.hpp"
#include "geometry/integrals/distance_volume.hpp"
#include "geometry/polygon/cyclic.hpp"
#include "geometry/potential/lower_envelope.hpp"

namespace apothem::overlap_detail {

using namespace lower_envelope;

/// A ring of the boundary of the overlap. All integrals over the overlap are sums of those over its
/// rings, in which those over clockwise rings are negative.
template <class Real>
struct Region {
  std::vector<Vec<Real>> vertices;  ///< vertices, counter-clockwise; clockwise around a hole
  std::vector<OverlapEdge> edges;   ///< input edges that its edges lie on; empty if not known
};

/// The rings of the overlap by exact constructions, with coordinates relative to `origin` and
/// rounded to Real, which is double or cpp_bin_float_100.
template <class Real>
std::vector<Region<Real>> exact_regions(const Polygon& a, const Polygon& b, const Vec2& origin);

/// The potential phi of a polygon. For a convex polygon it is the minimum of the linear functions
/// `lines`. Otherwise it is a roof, whose faces lie on the planes `lines`, or a distance field. If
/// `capped`, phi is limited to 1.
template <class Real>
struct Envelope {
  std::vector<Line<Real>> lines;  ///< one linear function per edge
  bool capped;                    ///< whether phi is limited to 1
  Vec<Real> reference;            ///< reference point of the moments
  const Roof* roof = nullptr;     ///< graph of the roof, or null
  /// Coordinates of the roof's nodes, or of the vertices for a distance field; and phi at the nodes
  /// of the roof, not limited to 1.
  std::vector<Real> x{}, y{}, values{};
  const DistanceField* distance = nullptr;  ///< distance field, or null
  Real slope = 0;                           ///< inverse of the distance field's reference length
  std::vector<Real> gx{}, gy{};             ///< gradients of `lines`, for a distance field
  const RingLinks* links = nullptr;         ///< neighbours of the vertices if there are holes

  /// The largest slope of `lines`.
  [[nodiscard]] Real steepest() const {
    using std::sqrt;
    Real most = 0;
    for (const Line<Real>& line : lines) {
      most = std::max(most, Real(sqrt(Real(line.gradient.squaredNorm()))));
    }
    return most;
  }
  /// Makes phi a distance field with the inverse reference length `inverse_reference`.
  void set_distance(const DistanceField& field, const std::vector<Vec<Real>>& vertices,
                    const Real& inverse_reference) {
    distance = &field;
    slope = inverse_reference;
    for (size_t i = 0; i < vertices.size(); ++i) {
      x.push_back(vertices[i].x());
      y.push_back(vertices[i].y());
      gx.push_back(lines[i].gradient.x());
      gy.push_back(lines[i].gradient.y());
    }
  }
  /// The distance field with its coordinates.
  [[nodiscard]] PlacedDistance<Real> placed_distance() const {
    return {static_cast<int>(x.size()), x.data(), y.data(), gx.data(), gy.data(), slope,
            &distance->corners,         capped,   links};
  }

  /// The integral of phi dA over a counter-clockwise polygon; minus that over a clockwise one.
  [[nodiscard]] Real volume(const std::vector<Vec<Real>>& polygon) const {
    if (distance) {
      std::vector<Real> px, py;
      for (const Vec<Real>& p : polygon) {
        px.push_back(p.x());
        py.push_back(p.y());
      }
      return DistanceVolume<Real>().over(placed_distance(), px, py);
    }
    if (!roof) {
      std::vector<Line<Real>> all = lines;
      if (capped) all.push_back({Vec<Real>(0, 0), 1});
      lower_envelope::Memory<Real> memory;
      return volume_under(all, polygon, memory);
    }
    std::vector<std::vector<Vec<Real>>> faces;
    for (const std::vector<int>& nodes : roof->faces) {
      faces.emplace_back();
      for (const int i : nodes) faces.back().emplace_back(x[i], y[i]);
    }
    return volume_under_faces(faces, lines, capped, fan(polygon));
  }
};

/// Integrates phi along segments. The envelope of a convex polygon along a segment is a polyline,
/// which is cut by one linear function after the other. The memory is kept between calls.
template <class Real>
class EdgeTrace {
 public:
  /// The integrals of phi along the segment from p to q.
  SegmentMoments<Real> integrate(const Envelope<Real>& phi, const Vec<Real>& p,
                                 const Vec<Real>& q) {
    if (phi.roof) return integrate_roof(phi, p, q);
    if (phi.distance) {
      return distance_.integrate(phi.placed_distance(), p.x(), p.y(), q.x() - p.x(), q.y() - p.y(),
                                 [](const Real&, const Real&) {});
    }
    knots_.assign({{0, phi.lines[0](p)}, {1, phi.lines[0](q)}});
    for (size_t i = 1; i < phi.lines.size(); ++i) cut(phi.lines[i](p), phi.lines[i](q));
    if (phi.capped) cut(1, 1);
    SegmentMoments<Real> result;
    for (size_t i = 1; i < knots_.size(); ++i) add_positive_part(knots_[i - 1], knots_[i], result);
    return result;
  }

 private:
  // A corner of the polyline: its parameter on the segment and the value there.
  struct Knot {
    Real u, value;
  };

  SegmentMoments<Real> integrate_roof(const Envelope<Real>& phi, const Vec<Real>& p,
                                      const Vec<Real>& q) {
    roof_.cross(
        {&phi.roof->arcs, static_cast<int>(phi.lines.size()), static_cast<int>(phi.values.size()),
         phi.x.data(), phi.y.data(), phi.values.data()},
        p.x(), p.y(), q.x() - p.x(), q.y() - p.y());
    SegmentMoments<Real> result;
    roof_.pieces([&](const Real& u1, const Real& v1, const Real& u2, const Real& v2) {
      knots_.assign({{u1, v1}, {u2, v2}});
      if (phi.capped) cut(1, 1);
      for (size_t i = 1; i < knots_.size(); ++i)
        add_positive_part(knots_[i - 1], knots_[i], result);
    });
    return result;
  }

  static Knot between(const Knot& k, const Knot& l, const Real& share) {
    return {k.u + share * (l.u - k.u), k.value + share * (l.value - k.value)};
  }

  // Replaces the polyline by its minimum with the linear function from `start` to `end`.
  void cut(const Real& start, const Real& end) {
    cut_.clear();
    Real previous = 0;
    for (size_t i = 0; i < knots_.size(); ++i) {
      const Knot& knot = knots_[i];
      const Real line = start + knot.u * (end - start);
      const Real gap = line - knot.value;
      if (i > 0 && (gap < 0) != (previous < 0)) {
        cut_.push_back(between(knots_[i - 1], knot, previous / (previous - gap)));
      }
      if (!(gap < 0)) {
        cut_.push_back(knot);
      } else if (i == 0 || i + 1 == knots_.size()) {
        cut_.push_back({knot.u, line});
      }
      previous = gap;
    }
    std::swap(knots_, cut_);
  }

  // Adds the part of a piece where phi is positive, because negative values inside the overlap are
  // round-off.
  static void add_positive_part(Knot k, Knot l, SegmentMoments<Real>& result) {
    if (k.value < 0 && l.value < 0) return;
    if (k.value < 0) k = {between(k, l, k.value / (k.value - l.value)).u, 0};
    if (l.value < 0) l = {between(k, l, k.value / (k.value - l.value)).u, 0};
    result.add(k.u, k.value, l.u, l.value);
  }

  std::vector<Knot> knots_, cut_;
  RoofTrace<Real> roof_;
  DistanceTrace<Real> distance_;
};

/// Evaluates Eq. 8 on the rings of the overlap and, if `with_energy`, the energy.
template <class Real>
PairResult integrate(const std::vector<Region<Real>>& overlap, const Envelope<Real>& a,
                     const Envelope<Real>& b, bool with_energy = true) {
  using std::sqrt;
  if (overlap.empty()) return {};
  const Line<Real> one{Vec<Real>(0, 0), 1};
  Vec<Real> force(0, 0), centre(0, 0);
  Real moment = 0, weight = 0, own_a = 0, own_b = 0, area = 0, energy = 0;
  Real largest_a = 0, largest_b = 0;  // phi of a and of b
  EdgeTrace<Real> trace;
  for (const Region<Real>& region : overlap) {
    const std::vector<Vec<Real>>& v = region.vertices;
    for (size_t i = 0; i < v.size(); ++i) {
      const Vec<Real>& p = v[i];
      const Vec<Real> d = after(v, i) - p;
      const Vec<Real> normal(d.y(), -d.x());
      const Real length = sqrt(d.squaredNorm());
      // The potential of a polygon vanishes on its own edges.
      const bool known = !region.edges.empty();
      const bool skip_a = known && region.edges[i].edge_of_a >= 0;
      const bool skip_b = known && region.edges[i].edge_of_b >= 0;
      const auto phi_a = skip_a ? SegmentMoments<Real>{} : trace.integrate(a, p, p + d);
      const auto phi_b = skip_b ? SegmentMoments<Real>{} : trace.integrate(b, p, p + d);
      if (known ? skip_a : phi_a.sum <= phi_b.sum) own_a += length;
      if (known ? skip_b : phi_b.sum <= phi_a.sum) own_b += length;
      const Real difference = phi_a.sum - phi_b.sum;
      force += normal * difference;
      moment += cross<Real>(p, normal) * difference - d.squaredNorm() * (phi_a.first - phi_b.first);
      const Real sum = phi_a.sum + phi_b.sum;
      weight += length * sum;
      centre += length * (p * sum + d * (phi_a.first + phi_b.first));
      largest_a = std::max(largest_a, phi_a.largest);
      largest_b = std::max(largest_b, phi_b.largest);
    }
    area += area_integral(v, one);
    if (with_energy) energy += a.volume(v) + b.volume(v);
  }

  const auto rounded = [](const Real& x) { return static_cast<double>(x); };
  const auto rounded_vec = [&](const Vec<Real>& x) { return Vec2(rounded(x.x()), rounded(x.y())); };
  PairResult result;
  PairIntegral& pair = result.integral;
  pair.force = rounded_vec(force);
  pair.moment_a = rounded(moment - cross(a.reference, force));
  pair.moment_b = rounded(cross(b.reference, force) - moment);
  pair.weight = rounded(weight);
  if (weight != 0) pair.centre = rounded_vec(centre / weight - a.reference);
  pair.own_length_a = rounded(own_a);
  pair.own_length_b = rounded(own_b);
  pair.largest_phi = rounded(std::max(largest_a, largest_b));
  pair.depth = rounded(std::max<Real>(largest_a / a.steepest(), largest_b / b.steepest()));
  if (const Real size = sqrt(force.squaredNorm()); size > 0) {
    const Vec<Real> across(-force.y() / size, force.x() / size);
    Real low = across.dot(overlap[0].vertices[0]);
    Real high = low;
    for (const Region<Real>& region : overlap) {
      for (const Vec<Real>& v : region.vertices) {
        const Real x = across.dot(v);
        low = std::min(low, x);
        high = std::max(high, x);
      }
    }
    pair.breadth = rounded(high - low);
    pair.middle = rounded((high + low) / 2 - across.dot(a.reference));
  }
  result.volume = {rounded(energy), rounded(area)};
  return result;
}

}  // namespace apothem::overlap_detail
