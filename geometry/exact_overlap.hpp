// Private to overlap.cpp and exact_integral.cpp: the overlap polygon before it is rounded, and Eq.
// 8 on it for any number type.
#pragma once

#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Polygon_2.h>

#include <algorithm>
#include <vector>

#include "geometry/overlap.hpp"

namespace apothem::detail {

using ExactKernel = CGAL::Exact_predicates_exact_constructions_kernel;
using ExactPolygon = CGAL::Polygon_2<ExactKernel>;

struct ExactOverlap {
  ExactPolygon polygon;
  std::vector<OverlapEdge> edges;
};
std::vector<ExactOverlap> exact_overlaps(const Polygon& a, const Polygon& b);

template <class T>
struct Point {
  T x, y;
  Point operator+(const Point& o) const { return {x + o.x, y + o.y}; }
  Point operator-(const Point& o) const { return {x - o.x, y - o.y}; }
  Point operator*(const T& s) const { return {x * s, y * s}; }
};
template <class T>
T dot(const Point<T>& a, const Point<T>& b) {
  return a.x * b.x + a.y * b.y;
}
template <class T>
T cross(const Point<T>& a, const Point<T>& b) {
  return a.x * b.y - a.y * b.x;
}

/// phi = min(1, min_i g_i . (x - p_i)), all in one frame.
template <class T>
struct Lines {
  std::vector<Point<T>> p, g;
  bool capped;

  [[nodiscard]] T value(size_t i, const Point<T>& x) const { return dot(g[i], x - p[i]); }
  [[nodiscard]] T phi(const Point<T>& x) const {
    T least = value(0, x);
    for (size_t i = 1; i < p.size(); ++i) least = std::min<T>(least, value(i, x));
    if (capped) least = std::min<T>(least, T(1));
    return std::max<T>(least, T(0));
  }
};

template <class T>
struct Ring {
  std::vector<Point<T>> vertices;
  std::vector<OverlapEdge> edges;  // empty: owners unknown
};

/// A body of the pair, in the common frame.
template <class T>
struct Side {
  Lines<T> lines;
  Point<T> centroid;
};

template <class T>
class Eq8 {
 public:
  Eq8(const Side<T>& a, const Side<T>& b, const std::vector<Ring<T>>& rings) : a_(a), b_(b) {
    for (const Ring<T>& ring : rings) {
      for (size_t i = 0; i < ring.vertices.size(); ++i) {
        const Point<T>& start = ring.vertices[i];
        const Point<T>& end = ring.vertices[i + 1 == ring.vertices.size() ? 0 : i + 1];
        const bool known = !ring.edges.empty();
        // On a's own boundary phi_a is zero, and what is left is phi_b.
        const bool on_a = known && ring.edges[i].edge_of_a >= 0;
        const bool on_b = known && ring.edges[i].edge_of_b >= 0;
        if (!on_a) add(a_.lines, start, end, T(1));
        if (!on_b) add(b_.lines, start, end, T(-1));
        using std::sqrt;
        const T length = sqrt(dot(end - start, end - start));
        if (on_a) own_a_ += length;
        if (on_b) own_b_ += length;
        area_ += cross(start - ring.vertices[0], end - ring.vertices[0]) / 2;
      }
      energy_ += volume(a_.lines, ring.vertices) + volume(b_.lines, ring.vertices);
    }
    project(rings);
  }

  [[nodiscard]] PairResult result() const {
    const auto d = [](const T& x) { return static_cast<double>(x); };
    PairResult result;
    PairIntegral& pair = result.integral;
    pair.force = {d(force_.x), d(force_.y)};
    // Moments were taken about the frame's origin.
    pair.moment_a = d(moment_ - cross(a_.centroid, force_));
    pair.moment_b = d(cross(b_.centroid, force_) - moment_);
    pair.weight = d(weight_);
    if (weight_ != T(0)) {
      pair.centre = {d(first_.x / weight_ - a_.centroid.x), d(first_.y / weight_ - a_.centroid.y)};
    }
    pair.own_length_a = d(own_a_);
    pair.own_length_b = d(own_b_);
    pair.largest_phi = d(largest_);
    pair.penetration = d(penetration_);
    pair.breadth = d(breadth_);
    result.volume = {d(energy_), d(area_)};
    return result;
  }

 private:
  // sign * n INT phi ds with the trapezoid rule between all points where phi may have a kink.
  void add(const Lines<T>& lines, const Point<T>& start, const Point<T>& end, const T& sign) {
    const size_t n = lines.p.size();
    std::vector<T> from(n), rise(n), kinks{T(0), T(1)};
    for (size_t i = 0; i < n; ++i) {
      from[i] = lines.value(i, start);
      rise[i] = lines.value(i, end) - from[i];
    }
    const auto crossing = [&](const T& numerator, const T& denominator) {
      if (denominator == T(0)) return;
      const T s = numerator / denominator;
      if (s > T(0) && s < T(1)) kinks.push_back(s);
    };
    for (size_t i = 0; i < n; ++i) {
      for (size_t j = 0; j < i; ++j) crossing(from[i] - from[j], rise[j] - rise[i]);
      crossing(from[i], -rise[i]);
      if (lines.capped) crossing(T(1) - from[i], rise[i]);
    }
    std::sort(kinks.begin(), kinks.end());
    const Point<T> edge = end - start;
    const auto phi = [&](const T& s) { return lines.phi(start + edge * s); };
    T sum(0), first(0);  // INT phi ds, INT phi s ds over s in [0, 1]
    T u1 = kinks[0];
    T v1 = phi(u1);
    for (size_t k = 1; k < kinks.size(); ++k) {
      const T u2 = kinks[k];
      const T v2 = phi(u2);
      sum += (u2 - u1) * (v1 + v2) / 2;
      first += (u2 - u1) * (v1 * (2 * u1 + u2) + v2 * (u1 + 2 * u2)) / 6;
      largest_ = std::max<T>(largest_, v1);
      u1 = u2;
      v1 = v2;
    }
    largest_ = std::max<T>(largest_, v1);
    using std::sqrt;
    const T length = sqrt(dot(edge, edge));
    const Point<T> normal{edge.y, -edge.x};  // outward, times the length
    force_ = force_ + normal * (sign * sum);
    moment_ -= sign * (dot(start, edge) * sum + dot(edge, edge) * first);
    weight_ += length * sum;
    first_ = first_ + (start * sum + edge * first) * length;
  }

  // INT phi dA over a ring: the ring cut by every face {L_e <= L_k for all k}.
  static T volume(const Lines<T>& lines, const std::vector<Point<T>>& ring) {
    T sum(0);
    for (size_t e = 0; e < lines.p.size(); ++e) {
      std::vector<Point<T>> face = ring;
      bool repeated = false;
      for (size_t k = 0; k < lines.p.size() && !repeated; ++k) {
        if (k == e) continue;
        // Edges on one line share one face: the first of them has it.
        const Point<T> jump = lines.g[k] - lines.g[e];
        if (dot(jump, jump) <= T(1e-28) * dot(lines.g[e], lines.g[e])) {
          repeated = k < e;
          continue;
        }
        face =
            cut(face, [&](const Point<T>& x) { return T(lines.value(k, x) - lines.value(e, x)); });
      }
      if (repeated) continue;
      const auto height = [&](const Point<T>& x) { return T(lines.value(e, x)); };
      if (!lines.capped) {
        sum += integral(face, height);
        continue;
      }
      sum += integral(cut(face, [&](const Point<T>& x) { return T(1 - height(x)); }), height);
      sum += integral(cut(face, [&](const Point<T>& x) { return T(height(x) - 1); }),
                      [](const Point<T>&) { return T(1); });
    }
    return sum;
  }

  // Part of a polygon where a linear function is not negative (Sutherland-Hodgman: for a polygon
  // that is not convex the pieces hang together by edges that cancel in every integral).
  template <class Function>
  static std::vector<Point<T>> cut(const std::vector<Point<T>>& ring, const Function& f) {
    std::vector<Point<T>> kept;
    for (size_t i = 0; i < ring.size(); ++i) {
      const Point<T>& p = ring[i];
      const Point<T>& q = ring[i + 1 == ring.size() ? 0 : i + 1];
      const T fp = f(p);
      const T fq = f(q);
      if (fp >= T(0)) kept.push_back(p);
      if ((fp >= T(0)) != (fq >= T(0))) kept.push_back(p + (q - p) * T(fp / (fp - fq)));
    }
    return kept;
  }

  template <class Function>
  static T integral(const std::vector<Point<T>>& ring, const Function& f) {
    T sum(0);
    for (size_t i = 1; i + 1 < ring.size(); ++i) {
      sum += cross(ring[i] - ring[0], ring[i + 1] - ring[0]) *
             (f(ring[0]) + f(ring[i]) + f(ring[i + 1])) / 6;
    }
    return sum;
  }

  void project(const std::vector<Ring<T>>& rings) {
    using std::sqrt;
    const T size = sqrt(dot(force_, force_));
    if (!(size > T(0))) return;
    const Point<T> n = force_ * T(1 / size);
    bool any = false;
    T n0(0), n1(0), t0(0), t1(0);
    for (const Ring<T>& ring : rings) {
      for (const Point<T>& v : ring.vertices) {
        const T along = dot(n, v);
        const T across = cross(n, v);
        n0 = any ? std::min<T>(n0, along) : along;
        n1 = any ? std::max<T>(n1, along) : along;
        t0 = any ? std::min<T>(t0, across) : across;
        t1 = any ? std::max<T>(t1, across) : across;
        any = true;
      }
    }
    penetration_ = n1 - n0;
    breadth_ = t1 - t0;
  }

  const Side<T>& a_;
  const Side<T>& b_;
  Point<T> force_{T(0), T(0)}, first_{T(0), T(0)};
  T moment_{0}, weight_{0}, own_a_{0}, own_b_{0}, largest_{0}, area_{0}, energy_{0};
  T penetration_{0}, breadth_{0};
};

}  // namespace apothem::detail
