// The integral of a distance field over another polygon, for any number type. It needs neither the
// medial axis nor the overlap polygon.
//
// The polygon is divided into cells of the points that are nearest to the same feature, which is an
// edge or a reflex vertex. The cell of an edge of length L is 0 <= tau <= L, 0 <= h <= H(tau),
// where tau is the coordinate along the edge, h the distance from it, and H(tau) the radius of the
// largest circle inside the polygon that touches the edge at tau. The cell of a reflex vertex is 0
// <= rho <= R(theta) between the normals of its two edges, in polar coordinates rho, theta about
// the vertex. H is the lower envelope of one quadratic in tau per other feature. 1/R is the upper
// envelope of such functions; multiplied by 1 + t^2 they are quadratics in t = tan(theta/2). The
// cells tile the polygon.
//
// A feature bounds a cell only if it lies inside a circle in the polygon that touches the cell's
// own one. Of a long outline a tree of boxes finds these features, roughly those first that the
// smallest circles reach, while the circles shrink. Only the part of a cell counts that may lie in
// the other polygon, and a cell that many features bound is divided into parts with few of them.
//
// The integral is, cell by cell, a signed sum over the edges of the other polygon: each edge
// contributes the volume between itself and the foot of the cell, clamped to the cell. Edges beside
// the cell contribute nothing. Of edges in a row that are all behind the cell's far end, or all in
// front of its foot, the sum is that of one line from the first point to the last one. So a tree of
// boxes finds the few edges that count one by one.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "geometry/integrals/cell_ceiling.hpp"
#include "geometry/integrals/distance_outline.hpp"
#include "geometry/polygon/cyclic.hpp"
#include "geometry/potential/quadratic.hpp"
#include "geometry/spatial/ring_tree.hpp"
#include "lib/execution/elementary.hpp"

namespace apothem {

/// Where a polygon overlaps that of a field.
struct OverlapBounds {
  Box box;       ///< contains the overlap
  double depth;  ///< no point of it is farther from the boundary of the field's polygon, m
};

/// Integrates a distance field over a polygon.
template <class Real>
class DistanceVolume {
 public:
  /// With at most `few` edges, a polygon is searched without trees; a test may choose that.
  explicit DistanceVolume(int few = DistanceOutline<Real>::kFew) : few_(few), outline_(few) {}

  /// Returns the integral of phi dA, m^2, over the counter-clockwise ring with the coordinates x, y
  /// in the frame of the field; minus the integral for a clockwise ring, such as that of a hole. If
  /// a coordinate is not finite, the result is NaN. Of a polygon of several rings, the sum may be
  /// all that matters: then cells that do not reach into the overlap with it are left out, because
  /// they would add nothing but round-off to the sum.
  Real over(const PlacedDistance<Real>& field, const std::vector<Real>& x,
            const std::vector<Real>& y, const std::optional<OverlapBounds>& overlap = {}) {
    Real finite = 0;  // sum of 0 * coordinate, which is NaN if a coordinate is not finite
    for (int i = 0; i < field.size; ++i) finite += 0 * field.x[i] + 0 * field.y[i];
    for (size_t i = 0; i < x.size(); ++i) finite += 0 * x[i] + 0 * y[i];
    if (!(finite == 0)) return finite;
    outline_.load(field);
    capped_ = field.capped;
    reference_ = 1 / field.slope;
    ring_.clear();
    around_ = {};
    for (size_t i = 0; i < x.size(); ++i) {
      ring_.push_back({x[i], y[i]});
      around_.include(static_cast<double>(x[i]), static_cast<double>(y[i]));
    }
    plant_tree(field);
    if (overlap) around_ = overlap->box;
    ceiling_.begin(slack_);
    depth_ = overlap ? Ceiling::kSure * overlap->depth + slack_
                     : std::numeric_limits<double>::infinity();
    Real volume = 0;
    if (outline_.size() < 3) return volume;
    for (int i = 0; i < outline_.size(); ++i) volume += edge_cell(i);
    for (const int v : outline_.reflex()) volume += vertex_cell(v);
    return volume * field.slope;
  }

 private:
  using Point = PlanePoint<Real>;
  using Quadratic = apothem::Quadratic<Real>;
  using Ceiling = CellCeiling<Real>;
  using Range = CellRange;

  static Vec2 rounded(const Point& p) {
    return {static_cast<double>(p.x), static_cast<double>(p.y)};
  }

  // What round-off may do to boxes, and the tree of the ring, if it has many edges.
  void plant_tree(const PlacedDistance<Real>& field) {
    tree_.reset();
    Box all = around_;
    for (int i = 0; i < field.size; ++i) {
      all.include(static_cast<double>(field.x[i]), static_cast<double>(field.y[i]));
    }
    slack_ =
        1e-14 * std::max({std::abs(all.x0), std::abs(all.x1), std::abs(all.y0), std::abs(all.y1)});
    if (static_cast<int>(ring_.size()) <= few_) return;
    std::vector<Vec2> points;
    for (const Point& p : ring_) points.push_back(rounded(p));
    tree_.emplace(std::move(points));
  }

  // Calls f(p, q) for the edges of the ring, or for the lines that judge() lets stand for them.
  template <class Judge, class F>
  void each_line(const Judge& judge, const F& f) const {
    if (tree_) {
      tree_->each_line(judge, [&](size_t i, size_t j) { f(ring_[i], ring_[j]); });
    } else {
      for (size_t k = 0; k < ring_.size(); ++k) f(ring_[k], after(ring_, k));
    }
  }

  // The volume of one cell, summed from its foot (low) and from its ceiling (high), and the sums of
  // the absolute values of the terms. Both sums are equal up to round-off, but if the ring passes
  // only above or only below the cell, one of them is exactly 0.
  struct Sums {
    Real low = 0, low_size = 0, high = 0, high_size = 0;
    // Adds one edge of the ring: `part` is the volume below it, `full` that of the whole cell.
    void add(const Real& part, const Real& full) {
      using std::abs;
      low += part;
      low_size += abs(part);
      high += part - full;
      high_size += abs(part - full);
    }
  };

  // The interval from lo to hi is cut where the integrand changes its form. Call start_cuts first,
  // then add cuts; between_cuts calls piece for every part.
  void start_cuts(const Real& lo, const Real& hi) { cuts_.assign({lo, hi}); }
  void add_cut(const Real& s) {
    if (s > cuts_[0] && s < cuts_[1]) cuts_.push_back(s);
  }
  void add_cuts(const Quadratic& f, const Quadratic& g) {
    std::array<Real, 2> roots;
    const int count = f.crossings(g, cuts_[0], roots);
    for (int i = 0; i < count; ++i) add_cut(roots[i]);
  }
  template <class Piece>
  void between_cuts(const Piece& piece) {
    std::sort(cuts_.begin(), cuts_.end());
    for (size_t i = 1; i < cuts_.size(); ++i) {
      if (cuts_[i - 1] < cuts_[i]) piece(cuts_[i - 1], cuts_[i]);
    }
  }

  // The mean of s^2 from a to b.
  static Real mean_square(const Real& a, const Real& b) { return (a * a + a * b + b * b) / 3; }

  // INT f ds from a to b by Gauss quadrature, exact for polynomials of degree 5.
  template <class F>
  static Real gauss(const Real& a, const Real& b, const F& f) {
    using std::sqrt;
    const Real middle = (a + b) / 2;
    const Real step = (b - a) / 2 * sqrt(Real(3) / 5);
    return (b - a) / 18 * (5 * f(middle - step) + 8 * f(middle) + 5 * f(middle + step));
  }

  // The largest value of the dot product of a direction with a point of a box, seen from a point.
  // Where it is negative the box is behind a line.
  static double ahead(const Point& direction, const Point& from, const Box& box) {
    const Vec2 d = rounded(direction), p = rounded(from);
    return d.x() * ((d.x() > 0 ? box.x1 : box.x0) - p.x()) +
           d.y() * ((d.y() > 0 ? box.y1 : box.y0) - p.y());
  }
  // The same of the box around what counts.
  [[nodiscard]] double ahead(const Point& direction, const Point& from) const {
    return ahead(direction, from, around_);
  }
  // Whether all points around which something counts are farther from a feature, which lies in the
  // box of two points, than they are from the boundary.
  [[nodiscard]] bool too_far(const Point& p, const Point& q) const {
    return apart(box_of(rounded(p), rounded(q)).grown(depth_), around_);
  }

  // So many features before and behind that of a cell along the outline are tried first.
  static constexpr int kBeside = 3;

  // Calls f(number) for 0 to count - 1, closed to a ring, beginning at a number: what is near a
  // feature along the outline is often near it in the plane, and leaves little above the ceiling
  // for what follows.
  template <class F>
  static void outwards(size_t count, size_t start, const F& f) {
    for (size_t k = 0; k < count; ++k) {
      f((start + (k % 2 == 0 ? k / 2 : count - (k + 1) / 2)) % count);
    }
  }

  // Calls edge(j) for all edges and vertex(w) for all reflex vertices, those near the number i
  // first.
  template <class Edge, class Vertex>
  void all_features(int i, const Edge& edge, const Vertex& vertex) const {
    const std::vector<int>& reflex = outline_.reflex();
    outwards(static_cast<size_t>(outline_.size()), static_cast<size_t>(i),
             [&](size_t j) { edge(static_cast<int>(j)); });
    const auto start = std::lower_bound(reflex.begin(), reflex.end(), i) - reflex.begin();
    outwards(reflex.size(), static_cast<size_t>(start), [&](size_t k) { vertex(reflex[k]); });
  }

  // Calls add(j) for the features beside that with the number i along the outline: edge j and the
  // vertex where it begins.
  template <class Add>
  void features_beside(int i, const Add& add) const {
    int before = i, behind = i;
    for (int k = 0; k < kBeside; ++k) {
      before = outline_.before(before), behind = outline_.after(behind);
      add(before), add(behind);
    }
  }

  // Volume over the cell of edge i.
  Real edge_cell(int i) {
    const Point t = outline_.tangent(i);
    const Point& n = outline_.normal(i);
    const Point& start = outline_.vertex(i);
    const Point& stop = outline_.vertex(outline_.after(i));
    const Real& length = outline_.length(i);
    if (too_far(start, stop)) return 0;
    if (ahead(t, start) < 0 || ahead(n, start) < 0 || ahead(t * Real(-1), stop) < 0) return 0;
    if (!outline_.has_many()) {
      ceiling_.reset(0, length);
      all_features(
          i, [&](int j) { edge_over_edge(i, j); }, [&](int v) { vertex_over_edge(i, v); });
      return under_ceiling(i, 0, length);
    }
    const double from = -ahead(t * Real(-1), start) - slack_, to = ahead(t, start) + slack_;
    return part_of_edge_cell(i, std::max(Real(0), Real(from)), std::min(length, Real(to)));
  }

  // The same from tau = lo to hi.
  Real part_of_edge_cell(int i, const Real& lo, const Real& hi) {
    if (!(lo < hi)) return 0;
    // What is higher is outside the box.
    const double most = std::min(depth_, heights_over_edge(i, lo, hi, around_).most);
    if (!(most > 0)) return 0;
    ceiling_.reset(lo, hi);
    add_over_edge({lo, {Real(most), 0, 0}, 2 * outline_.size()}, lo, hi, 0);
    const auto add = [&](int j) {
      const bool lower = edge_over_edge(i, j);
      return (outline_.is_reflex(j) && vertex_over_edge(i, j)) || lower;
    };
    features_beside(i, add);
    const auto circle = [&](size_t k, const Real& tau) { return circle_at_edge(i, k, tau); };
    const auto counts = [&] { return use_at_edge(i, lo, hi, around_) == RunUse::edges; };
    const auto radius = [&](const Box& box) { return least_radius_at_edge(i, lo, hi, box); };
    const auto found = ceiling_.find(outline_, radius, add, circle, counts);
    if (found == Ceiling::Found::nothing) return 0;
    if (found == Ceiling::Found::too_many) {
      const Real middle = ceiling_.middle();
      return part_of_edge_cell(i, lo, middle) + part_of_edge_cell(i, middle, hi);
    }
    return under_ceiling(i, lo, hi);
  }

  // Adds a function to the ceiling over an edge.
  bool add_over_edge(const Quadratic& f, const Real& from, const Real& to, const Real& least) {
    return ceiling_.add(f, from, to, least, [&](size_t k) { return height_of_ceiling(k); });
  }
  // Adds edge j, or the reflex vertex v, to the ceiling over edge i.
  bool edge_over_edge(int i, int j) {
    typename DistanceOutline<Real>::Bisector line;
    if (j == i || !outline_.bisector(i, j, line)) return false;
    const Quadratic f{line.origin, {line.start, line.rise, 0}, j};
    return add_over_edge(f, line.from, line.to, std::min(f(line.from), f(line.to)));
  }
  bool vertex_over_edge(int i, int v) {
    if (v == i || v == outline_.after(i)) return false;
    const Real h = outline_.height(i, v);
    const Real curvature = 1 / (2 * h);
    if (!(h > 0 && curvature < std::numeric_limits<Real>::infinity())) return false;
    const Real tau = dot(outline_.tangent(i), outline_.vertex(v) - outline_.vertex(i));
    return add_over_edge({tau, {h / 2, 0, curvature}, outline_.size() + v}, 0, outline_.length(i),
                         h / 2);
  }
  // The largest height of piece k of the ceiling over an edge, which is at one of its ends.
  [[nodiscard]] Real height_of_ceiling(size_t k) const {
    const Quadratic& f = ceiling_[k].function;
    return std::max(f(ceiling_[k].from), f(ceiling_.end(k)));
  }
  [[nodiscard]] TouchingCircle circle_at_edge(int i, size_t k, const Real& tau) const {
    const Quadratic& f = ceiling_[k].function;
    const Point& n = outline_.normal(i);
    const Real radius = std::max(Real(0), f(tau));
    const Point foot = outline_.vertex(i) + outline_.tangent(i) * tau;
    const Point centre = foot + n * radius;
    const int size = outline_.size();
    const Point other = f.id == 2 * size ? centre + n * radius
                        : f.id >= size   ? outline_.vertex(f.id - size)
                                         : centre - outline_.normal(f.id) * radius;
    return {rounded(centre), static_cast<double>(radius), rounded(foot), rounded(other)};
  }

  // At most the radius of the circles that touch edge i between tau = lo and hi and reach into a
  // box: a point at the height y and beside these by x is on one with (x^2 + y^2) / (2 y) and not
  // on a smaller one.
  [[nodiscard]] double least_radius_at_edge(int i, const Real& lo, const Real& hi,
                                            const Box& box) const {
    const Point t = outline_.tangent(i);
    const Point &n = outline_.normal(i), &start = outline_.vertex(i);
    const double high = ahead(n, start, box) + slack_;
    if (!(high > 0)) return HUGE_VAL;
    const double low = std::max(0., -ahead(n * Real(-1), start, box) - slack_);
    const double x = std::max({0., -ahead(t * Real(-1), start, box) - static_cast<double>(hi),
                               static_cast<double>(lo) - ahead(t, start, box)});
    const double y = std::clamp(x, low, high);
    return y > 0 ? std::max(0., (x * x + y * y) / (2 * y) - slack_) : 0;
  }

  // The heights over edge i of the part of a box that is between tau = lo and hi.
  [[nodiscard]] Range heights_over_edge(int i, const Real& lo, const Real& hi,
                                        const Box& box) const {
    const Vec2 n = rounded(outline_.normal(i)), start = rounded(outline_.vertex(i));
    const Vec2 first = start + static_cast<double>(lo) * Vec2(n.y(), -n.x());
    const Vec2 last = start + static_cast<double>(hi) * Vec2(n.y(), -n.x());
    Range range;
    const auto cut = [&](double normal, double from, double to, double low, double high) {
      const double below = low - slack_ - std::max(from, to);
      const double above = high + slack_ - std::min(from, to);
      if (normal == 0) return;
      range.least = std::max(range.least, (normal > 0 ? below : above) / normal);
      range.most = std::min(range.most, (normal > 0 ? above : below) / normal);
    };
    cut(n.x(), first.x(), last.x(), box.x0, box.x1);
    cut(n.y(), first.y(), last.y(), box.y0, box.y1);
    return range;
  }

  // What is to be done with edges in a box, for the part of the cell of edge i from lo to hi.
  [[nodiscard]] RunUse use_at_edge(int i, const Real& lo, const Real& hi, const Box& box) const {
    const Point t = outline_.tangent(i);
    const Point& start = outline_.vertex(i);
    const Real from = -ahead(t * Real(-1), start, box) - slack_;
    const Real to = ahead(t, start, box) + slack_;
    if (to < lo || from > hi) return RunUse::none;
    const Real first = std::max(lo, from), last = std::min(hi, to);
    const auto range = [&](const Real& a, const Real& b) {
      return heights_over_edge(i, a, b, box);
    };
    const auto height = [&](size_t k, const Real& tau) { return ceiling_[k].function(tau); };
    const Range all = range(first, last);
    if (all.most < all.least) return RunUse::none;
    const bool one = all.most < 0 || ceiling_.lies_below(first, last, all, height, range);
    return one ? RunUse::whole : RunUse::edges;
  }

  // Volume over the part of the cell of edge i from lo to hi, whose ceiling is known.
  Real under_ceiling(int i, const Real& lo, const Real& hi) {
    const auto judge = [&](const Box& box) { return use_at_edge(i, lo, hi, box); };
    const Point t = outline_.tangent(i);
    const Point &n = outline_.normal(i), &start = outline_.vertex(i);
    Sums sums;
    each_line(judge, [&](const Point& from, const Point& to) {
      const Point p = from - start, q = to - start;
      under_segment(dot(t, p), dot(n, p), dot(t, q), dot(n, q), lo, hi, sums);
    });
    return sums.low_size <= sums.high_size ? sums.low : sums.high;
  }

  // INT_0^h min(r, h') dh', or without the minimum if phi is not limited to 1.
  [[nodiscard]] Real column(const Real& h) const {
    return capped_ && h > reference_ ? Real(reference_ * (h - reference_ / 2)) : Real(h * h / 2);
  }

  // Adds the volume between the foot of an edge's cell, from `first` to `last`, and a segment.
  void under_segment(Real tau1, Real h1, Real tau2, Real h2, const Real& first, const Real& last,
                     Sums& sums) {
    const int sign = tau1 < tau2 ? -1 : 1;
    if (sign > 0) std::swap(tau1, tau2), std::swap(h1, h2);
    const Real lo = std::max(first, tau1);
    const Real hi = std::min(last, tau2);
    if (!(lo < hi)) return;
    const Real rate = (h2 - h1) / (tau2 - tau1);
    const Quadratic line{tau1, {h1, rate, 0}, 0};
    const auto height = [&](const Real& tau) { return Real(h1 + rate * (tau - tau1)); };
    for (size_t k = ceiling_.at(lo); k < ceiling_.size() && ceiling_[k].from < hi; ++k) {
      const Real from = std::max(lo, ceiling_[k].from);
      const Real to = std::min(hi, ceiling_.end(k));
      if (!(from < to) || !ceiling_[k].known) continue;
      const Quadratic& ceiling = ceiling_[k].function;
      start_cuts(from, to);
      add_cut(tau1 - h1 / rate);
      add_cuts(ceiling, line);
      if (capped_) {
        add_cut(tau1 + (reference_ - h1) / rate);
        add_cuts(ceiling, {0, {reference_, 0, 0}, 0});
      }
      between_cuts([&](const Real& a, const Real& b) {
        const Real h = line.mean(a, b);
        const Real full = gauss(a, b, [&](const Real& tau) { return column(ceiling(tau)); });
        const Real part = h <= 0 ? Real(0)
                          : h < ceiling.mean(a, b)
                              ? gauss(a, b, [&](const Real& tau) { return column(height(tau)); })
                              : full;
        sums.add(sign * part, sign * full);
      });
    }
  }

  // Volume over the cell of the reflex vertex v. Directions are given by t = tan(theta/2), where
  // theta is the angle from the middle direction of the cell.
  Real vertex_cell(int v) {
    const Point& corner = outline_.vertex(v);
    if (too_far(corner, corner)) return 0;
    const int before = outline_.before(v);
    const Point& left = outline_.normal(before);
    const Point& right = outline_.normal(v);
    // The cell is between the normals, on the left of one and on the right of the other.
    if (ahead({-right.y, right.x}, corner) < 0 || ahead({left.y, -left.x}, corner) < 0) return 0;
    const Point middle =
        dot(left, right) >= 0 ? left + right : outline_.tangent(before) - outline_.tangent(v);
    using std::sqrt;
    axis_ = middle * (1 / sqrt(dot(middle, middle)));
    const Real t0 = half_tangent(in_frame(right));
    const Real t1 = half_tangent(in_frame(left));
    if (!outline_.has_many()) {
      ceiling_.reset(t0, t1);
      reaches_.clear();
      all_features(
          v, [&](int j) { edge_to_vertex(v, j, t0, t1); },
          [&](int w) { vertex_to_vertex(v, w, t0, t1); });
      return within_reach(v, t0, t1);
    }
    const Sight sight = seen_from(corner, around_);
    return part_of_vertex_cell(v, std::max(t0, Real(sight.from)), std::min(t1, Real(sight.to)));
  }

  // The same from t0 to t1.
  Real part_of_vertex_cell(int v, const Real& t0, const Real& t1) {
    if (!(t0 < t1)) return 0;
    const Point& corner = outline_.vertex(v);
    ceiling_.reset(t0, t1);
    reaches_.clear();
    // What is behind a side of the box is outside it.
    const auto close = [&](const Point& out) {
      const double d = ahead(out, corner) + slack_;
      if (!(d > 0)) return;
      const Point n = in_frame(out);
      reaches_.push_back({false, n, d, 0, 0});
      insert_reach({0, {-n.x / d, -2 * n.y / d, n.x / d}, 0}, t0, t1, 0);
    };
    close({1, 0}), close({-1, 0}), close({0, 1}), close({0, -1});
    const auto add = [&](int j) {
      const bool lower = edge_to_vertex(v, j, t0, t1);
      return (outline_.is_reflex(j) && vertex_to_vertex(v, j, t0, t1)) || lower;
    };
    features_beside(v, add);
    const auto circle = [&](size_t k, const Real& t) { return circle_at_vertex(v, k, t); };
    const auto counts = [&] { return use_at_vertex(v, t0, t1, around_) == RunUse::edges; };
    const auto radius = [&](const Box& box) { return least_radius_at_vertex(v, t0, t1, box); };
    const auto found = ceiling_.find(outline_, radius, add, circle, counts);
    if (found == Ceiling::Found::nothing) return 0;
    if (found == Ceiling::Found::too_many) {
      const Real middle = ceiling_.middle();
      return part_of_vertex_cell(v, t0, middle) + part_of_vertex_cell(v, middle, t1);
    }
    return within_reach(v, t0, t1);
  }

  // Adds the reflex vertex w to the ceiling of the cell of vertex v: the cell ends on the
  // perpendicular bisector u . p = |p|^2 / (2 rho), u the unit direction.
  bool vertex_to_vertex(int v, int w, const Real& t0, const Real& t1) {
    if (w == v) return false;
    using std::sqrt;
    const Point p = in_frame(outline_.vertex(w) - outline_.vertex(v));
    const Real d2 = dot(p, p) / 2;
    reaches_.push_back({false, p, d2, 0, 0});
    return insert_reach({0, {-p.x / d2, -2 * p.y / d2, p.x / d2}, 0}, t0, t1, sqrt(d2 / 2));
  }

  [[nodiscard]] TouchingCircle circle_at_vertex(int v, size_t k, const Real& t) const {
    const Reach& border = reaches_[ceiling_[k].function.id];
    const Point& corner = outline_.vertex(v);
    const Real radius = distance_of_ceiling(k, t);
    const Point centre = corner + unit(t) * radius;
    const Point normal = out_of_frame(border.normal);
    const Point other = border.parabola ? centre + normal * radius
                                        : corner + normal * (2 * border.d / dot(normal, normal));
    return {rounded(centre), static_cast<double>(radius), rounded(corner), rounded(other)};
  }

  [[nodiscard]] double distance_between(const Point& corner, const Box& box) const {
    const Vec2 c = rounded(corner);
    const double x = std::max({0., box.x0 - c.x(), c.x() - box.x1});
    const double y = std::max({0., box.y0 - c.y(), c.y() - box.y1});
    return std::max(0., std::sqrt(x * x + y * y) - slack_);
  }

  // The directions in which a box is seen from the corner of the present cell: all of them if it is
  // not clearly ahead.
  struct Sight {
    double from = -HUGE_VAL, to = HUGE_VAL;
  };
  static constexpr double kSameDirection = 1e-12;  // more than the round-off of directions
  [[nodiscard]] Sight seen_from(const Point& corner, const Box& box) const {
    const Vec2 c = rounded(corner), axis = rounded(axis_);
    if (!(distance_between(corner, box) > 0)) return {};
    const Box b = box.grown(slack_);
    double from = HUGE_VAL, to = -HUGE_VAL;
    for (const Vec2& p : {Vec2(b.x0, b.y0), Vec2(b.x1, b.y0), Vec2(b.x0, b.y1), Vec2(b.x1, b.y1)}) {
      const Vec2 arm = p - c;
      const double in_front = axis.dot(arm);
      if (!(in_front > 0)) return {};
      const double t = cross(axis, arm) / (in_front + arm.norm());
      from = std::min(from, t), to = std::max(to, t);
    }
    return {from - kSameDirection, to + kSameDirection};
  }

  // The distances from the corner of the present cell of the part of a box that is seen in the
  // directions t0 to t1.
  [[nodiscard]] Range distances_in(const Point& corner, const Real& t0, const Real& t1,
                                   const Box& box) const {
    const Vec2 first = rounded(unit(t0)), last = rounded(unit(t1)), c = rounded(corner);
    Range range{.least = distance_between(corner, box)};
    const auto cut = [&](const Vec2& side, double low, double high) {
      const bool passed = cross(first, side) > 0 && cross(side, last) > 0;
      const double most = passed ? 1 : std::max(first.dot(side), last.dot(side)) + kSameDirection;
      const double least = std::min(first.dot(side), last.dot(side)) - kSameDirection;
      low -= slack_, high += slack_;
      if (low > 0) range.least = std::max(range.least, most > 0 ? low / most : HUGE_VAL);
      if (least > 0) range.most = std::min(range.most, high / least);
    };
    cut({1, 0}, box.x0 - c.x(), box.x1 - c.x());
    cut({-1, 0}, c.x() - box.x1, c.x() - box.x0);
    cut({0, 1}, box.y0 - c.y(), box.y1 - c.y());
    cut({0, -1}, c.y() - box.y1, c.y() - box.y0);
    return range;
  }

  // At most the radius of the circles through vertex v whose centres are seen from there in the
  // directions t0 to t1, and that reach into a box: the circle with the centre in the direction u
  // passes through p if its radius is |p|^2 / (2 u . p).
  [[nodiscard]] double least_radius_at_vertex(int v, const Real& t0, const Real& t1,
                                              const Box& box) const {
    const Point& corner = outline_.vertex(v);
    const Vec2 first = rounded(unit(t0)), last = rounded(unit(t1)), c = rounded(corner);
    double most = 0;
    for (const Vec2& p :
         {Vec2(box.x0, box.y0), Vec2(box.x1, box.y0), Vec2(box.x0, box.y1), Vec2(box.x1, box.y1)}) {
      const Vec2 arm = p - c;
      const bool between = cross(first, arm) > 0 && cross(arm, last) > 0;
      most = std::max(most, between ? arm.norm() : std::max(first.dot(arm), last.dot(arm)));
    }
    const double least = distance_between(corner, box);
    return most > 0 ? std::max(0., least * least / (2 * (most + slack_)) - slack_) : HUGE_VAL;
  }

  // What is to be done with edges in a box, for the part of the cell of vertex v from t0 to t1.
  [[nodiscard]] RunUse use_at_vertex(int v, const Real& t0, const Real& t1, const Box& box) const {
    const Point& corner = outline_.vertex(v);
    const Point &left = outline_.normal(outline_.before(v)), &right = outline_.normal(v);
    if (ahead({-right.y, right.x}, corner, box) < -slack_ ||
        ahead({left.y, -left.x}, corner, box) < -slack_) {
      return RunUse::none;
    }
    const Sight sight = seen_from(corner, box);
    const Real first = std::max(t0, Real(sight.from)), last = std::min(t1, Real(sight.to));
    if (first > last) return RunUse::none;
    const auto range = [&](const Real& a, const Real& b) {
      return distances_in(corner, a, b, box);
    };
    const auto height = [&](size_t k, const Real& t) { return distance_of_ceiling(k, t); };
    const Range all = range(first, last);
    if (all.most < all.least) return RunUse::none;
    const bool beyond = ceiling_.lies_below(first, last, all, height, range);
    return beyond ? RunUse::whole : RunUse::edges;
  }

  // Volume over the part of the cell of vertex v from t0 to t1, whose ceiling is known.
  Real within_reach(int v, const Real& t0, const Real& t1) {
    const auto judge = [&](const Box& box) { return use_at_vertex(v, t0, t1, box); };
    const Point& corner = outline_.vertex(v);
    const Point &left = outline_.normal(outline_.before(v)), &right = outline_.normal(v);
    middle_ = t0 < 0 && t1 > 0 ? Real(0) : Real((t0 + t1) / 2);
    Sums sums;
    Real coverage = 0;    // winding number of the ring about the vertex, in the middle direction
    bool inside = false;  // whether the ring has a vertex inside the cell or enters it sideways
    each_line(judge, [&](const Point& from, const Point& to) {
      Point p = from - corner, q = to - corner;
      if (!clip(p, q, cross(right, p), cross(right, q))) return;
      if (!clip(p, q, cross(p, left), cross(q, left))) return;
      p = in_frame(p), q = in_frame(q);
      inside = inside || in_cell(p) || in_cell(q);
      beyond_segment(p, q, sums, coverage);
    });
    // Near the vertex, directions consist of round-off, which only the sum from the foot tolerates.
    // A segment that leads straight to the vertex has no width there, so its terms may all be 0,
    // but the winding number of a ring through the vertex does not tell which part it covers.
    if (inside || sums.high_size > 0) return sums.low;
    return coverage * whole_vertex_cell();
  }

  // Volume over all of the present vertex's cell.
  Real whole_vertex_cell() {
    Real whole = 0;
    for (size_t k = 0; k < ceiling_.size(); ++k) {
      if (!ceiling_[k].known) continue;
      start_cuts(ceiling_[k].from, ceiling_.end(k));
      const Reach& reach = reaches_[ceiling_[k].function.id];
      add_cap_cuts(ceiling_[k].function, 1);
      between_cuts([&](const Real& a, const Real& b) { whole += sector(reach, a, b); });
    }
    return whole;
  }

  // Components of a vector along the middle direction and to its left.
  [[nodiscard]] Point in_frame(const Point& p) const { return {dot(axis_, p), cross(axis_, p)}; }
  [[nodiscard]] Point out_of_frame(const Point& p) const {
    return {axis_.x * p.x - axis_.y * p.y, axis_.y * p.x + axis_.x * p.y};
  }

  // The unit vector of a direction.
  [[nodiscard]] Point unit(const Real& t) const {
    const Real size = 1 + t * t;
    return out_of_frame({(1 - t * t) / size, 2 * t / size});
  }

  // t = tan(theta/2) for the direction of p.
  static Real half_tangent(const Point& p) {
    using std::sqrt;
    const Real size = p.x + sqrt(dot(p, p));
    return size > 0 ? Real(p.y / size) : Real(0);
  }

  // Keeps the part of the segment pq with side >= 0; returns false if there is none.
  static bool clip(Point& p, Point& q, const Real& side_p, const Real& side_q) {
    if ((side_p >= 0) == (side_q >= 0)) return side_p >= 0;
    const Point cut = p + (q - p) * (side_p / (side_p - side_q));
    (side_p >= 0 ? q : p) = cut;
    return true;
  }

  // Whether p is nearer to the vertex than the border of its cell in the direction of p.
  [[nodiscard]] bool in_cell(const Point& p) const {
    using std::sqrt;
    const Real t = half_tangent(p);
    for (size_t k = 0; k < ceiling_.size(); ++k) {
      if (!ceiling_[k].known || t < ceiling_[k].from || t > ceiling_.end(k)) continue;
      if (-ceiling_[k].function(t) * sqrt(dot(p, p)) < 1 + t * t) return true;
    }
    return false;
  }

  // A border of a vertex's cell. It is the line u . normal = d / rho, u the unit direction, or a
  // parabola whose focus is the vertex and whose directrix has the distance d. (ec, es) are cosine
  // and sine of half the angle of the direction towards the directrix.
  struct Reach {
    bool parabola;
    Point normal;
    Real d, ec, es;
  };

  // Adds the function -(1 + t^2)/rho of the last element of reaches_ to the ceiling. The sign makes
  // the nearest border the lower envelope.
  bool insert_reach(Quadratic inverse, const Real& t0, const Real& t1, const Real& least) {
    inverse.id = static_cast<int>(reaches_.size()) - 1;
    return ceiling_.add(inverse, t0, t1, least, [&](size_t k) { return reach(k); });
  }
  // The distance of piece k of the ceiling from the vertex.
  [[nodiscard]] Real distance_of_ceiling(size_t k, const Real& t) const {
    const Real inverse = -ceiling_[k].function(t);
    return inverse > 0 ? Real((1 + t * t) / inverse) : std::numeric_limits<Real>::infinity();
  }
  // The largest of them, which is at one of the ends of the piece.
  [[nodiscard]] Real reach(size_t k) const {
    return std::max(distance_of_ceiling(k, ceiling_[k].from),
                    distance_of_ceiling(k, ceiling_.end(k)));
  }

  // Adds the parabola between the vertex v and edge j, where the circle touches j within the edge.
  bool edge_to_vertex(int v, int j, const Real& t0, const Real& t1) {
    if (j == v || j == outline_.before(v)) return false;
    using std::sqrt;
    const Real d = outline_.height(j, v);
    if (!(d > 0)) return false;
    const Point m = in_frame(outline_.normal(j)) * Real(-1);
    Real ec, es;
    if (m.x >= 0) {
      ec = sqrt((1 + m.x) / 2);
      es = m.y / (2 * ec);
    } else {
      es = sqrt((1 - m.x) / 2);
      ec = m.y / (2 * es);
    }
    // On the parabola rho = d / (1 + u . m) = d (1 + y^2) / 2, where y is the tangent of half the
    // angle from m. The circle touches edge j at the distance d y from the foot of the
    // perpendicular from the vertex.
    const Point t = outline_.tangent(j);
    const Real y0 = dot(t, outline_.vertex(j) - outline_.vertex(v)) / d;
    const Real y1 = dot(t, outline_.vertex(outline_.after(j)) - outline_.vertex(v)) / d;
    // t = (es + ec y) / (ec - es y) increases with y, and may pass through infinity once.
    const Real infinite = std::numeric_limits<Real>::infinity();
    if (!(y0 > -infinite && y0 < infinite && y1 > -infinite && y1 < infinite)) return false;
    const Real below0 = ec - es * y0;
    const Real below1 = ec - es * y1;
    const Real from = below0 == 0 ? Real(-infinite) : Real((es + ec * y0) / below0);
    const Real to = below1 == 0 ? infinite : Real((es + ec * y1) / below1);
    reaches_.push_back({true, m, d, ec, es});
    // (1 + t^2)/rho = 2 (ec + es t)^2 / d, with the opposite sign.
    const Quadratic inverse =
        2 * es * es >= ec * ec
            ? Quadratic{-ec / es, {0, 0, -2 * es * es / d}, 0}
            : Quadratic{0, {-2 * ec * ec / d, -4 * ec * es / d, -2 * es * es / d}, 0};
    if (below0 != 0 && below1 != 0 && (below0 > 0) != (below1 > 0)) {
      const bool lower = insert_reach(inverse, std::max(t0, from), t1, d / 2);
      return insert_reach(inverse, t0, std::min(t1, to), d / 2) || lower;
    }
    return insert_reach(inverse, std::max(t0, from), std::min(t1, to), d / 2);
  }

  // The volume between the directions t1 and t2 up to the border: the integral of min(r, rho) rho
  // over rho and theta, or without the minimum if phi is not limited to 1.
  [[nodiscard]] Real sector(const Reach& reach, const Real& t1, const Real& t2) const {
    using std::sqrt;
    const Real half_angle = arc_tangent(Real(t2 - t1), Real(1 + t1 * t2));
    const Real cone = reference_ * reference_ * reference_ / 3;
    const Real& d = reach.d;
    if (reach.parabola) {
      const auto denominator = [&](const Real& t) { return Real(reach.ec + reach.es * t); };
      const auto y = [&](const Real& t) {
        return Real((reach.ec * t - reach.es) / denominator(t));
      };
      if (!(denominator(t1) * denominator(t2) > 0)) return 0;  // narrower than round-off
      const Real y1 = y(t1), y2 = y(t2);
      if (capped_ && d * (1 + mean_square(y1, y2)) > 2 * reference_) {
        return d * d / 4 * reference_ *
                   gauss(y1, y2, [](const Real& s) { return Real(1 + s * s); }) -
               cone * half_angle;
      }
      return d * d * d / 12 *
             gauss(y1, y2, [](const Real& s) { return Real((1 + s * s) * (1 + s * s)); });
    }
    // For a line, w is the coordinate along it from the foot of the perpendicular from the vertex,
    // and D is the distance of the line.
    const Real size = sqrt(dot(reach.normal, reach.normal));
    const Real D = d / size;
    const Point n = reach.normal * (1 / size);
    const auto across = [&](const Real& t, const Real& t_squared) {
      return Real(n.x * (1 - t_squared) + 2 * n.y * t);
    };
    const Real c1 = across(t1, t1 * t1), c2 = across(t2, t2 * t2);
    if (!(c1 > 0 && c2 > 0)) return 0;
    const Real w = D * (n.x * 2 * t1 - n.y * (1 - t1 * t1)) / c1;
    const Real step = 2 * D * (t2 - t1) * (1 + t1 * t2) / (c1 * c2);
    const Real t_squared = mean_square(t1, t2);
    if (capped_ && D * (1 + t_squared) > reference_ * across((t1 + t2) / 2, t_squared)) {
      return D * step / 2 * reference_ - cone * half_angle;
    }
    return D / 3 * root_moments<Real>(D * D, w, step)[0];
  }

  // Adds the cuts at rho = r, where phi reaches its limit.
  void add_cap_cuts(const Quadratic& inverse, const Real& factor) {
    const Real limit = -factor / reference_;
    if (capped_) add_cuts(inverse, {0, {limit, 0, limit}, 0});
  }

  // Adds the volume between the vertex and a segment of the ring inside the cell's directions.
  void beyond_segment(const Point& p, const Point& q, Sums& sums, Real& coverage) {
    Real t1 = half_tangent(p), t2 = half_tangent(q);
    const int sign = t1 < t2 ? 1 : -1;
    if (sign < 0) std::swap(t1, t2);
    if ((t1 < middle_) != (t2 < middle_)) coverage += sign;
    const Point edge = sign > 0 ? q - p : p - q;
    const Point normal{edge.y, -edge.x};
    const Real d = std::max(Real(0), dot(normal, p));
    const Reach own{false, normal, d, 0, 0};
    const Quadratic line{0, {-normal.x, -2 * normal.y, normal.x}, 0};  // equal to -d (1 + t^2)/rho
    for (size_t k = ceiling_.at(t1); k < ceiling_.size() && ceiling_[k].from < t2; ++k) {
      const Real from = std::max(t1, ceiling_[k].from);
      const Real to = std::min(t2, ceiling_.end(k));
      if (!(from < to) || !ceiling_[k].known) continue;
      const Reach& reach = reaches_[ceiling_[k].function.id];
      const Quadratic scaled = ceiling_[k].function.times(d);
      start_cuts(from, to);
      add_cuts(scaled, line);
      add_cap_cuts(scaled, d);
      add_cap_cuts(line, d);
      between_cuts([&](const Real& a, const Real& b) {
        const Real full = sector(reach, a, b);
        const bool missed = line.mean(a, b) >= 0;  // by round-off, if the segment passes the vertex
        const bool nearer = line.below(scaled, a, b);
        sums.add(sign * (missed ? Real(0) : nearer ? sector(own, a, b) : full), sign * full);
      });
    }
  }

  int few_;
  bool capped_ = false;
  Real reference_{};  // the reference length r
  DistanceOutline<Real> outline_;
  std::vector<Point> ring_;
  Box around_;                    // the ring, or what is asked for of its inside
  std::optional<RingTree> tree_;  // of the ring, if it has many edges
  double slack_ = 0;              // round-off of positions in boxes, m
  double depth_ = 0;              // no point that counts is deeper, m
  std::vector<Real> cuts_;
  Ceiling ceiling_;             // far end of the present cell
  std::vector<Reach> reaches_;  // borders of the present vertex's cell
  Point axis_{};                // middle direction of the present vertex's cell
  Real middle_{};               // a direction inside the present part of it
};

}  // namespace apothem
