// The energy of outlines in each other or in themselves, by two ways that are not those of the
// kernel: in closed form for any number type, and from the definition of the depth at points.
#pragma once

#include <algorithm>
#include <complex>
#include <vector>

#include "geometry/integrals/collar.hpp"
#include "geometry/polygon/point.hpp"

namespace apothem::test {

using Complex = std::complex<double>;

template <class Number>
struct NumberRing {
  std::vector<Number> x, y;

  explicit NumberRing(const std::vector<Vec2>& ring) {
    for (const Vec2& v : ring) x.emplace_back(v.x()), y.emplace_back(v.y());
  }
  [[nodiscard]] size_t size() const { return x.size(); }
  [[nodiscard]] size_t next(size_t i) const { return i + 1 == x.size() ? 0 : i + 1; }
  [[nodiscard]] std::vector<Vec2> real() const {
    std::vector<Vec2> points;
    for (size_t i = 0; i < x.size(); ++i) points.emplace_back(real_part(x[i]), real_part(y[i]));
    return points;
  }
};

inline int winding_of(const std::vector<Vec2>& ring, const Vec2& p) {
  int sum = 0;
  for (size_t i = 0; i < ring.size(); ++i) {
    const Vec2 a = ring[i] - p, b = ring[i + 1 == ring.size() ? 0 : i + 1] - p;
    if ((a.y() > 0) == (b.y() > 0)) continue;
    const double side = cross(a, b);
    if (b.y() > 0 && side > 0) ++sum;
    if (b.y() <= 0 && side < 0) --sum;
  }
  return sum;
}

/// INT over c of the depth below t, in the closed forms of collar.hpp; winding numbers by looking
/// at every vertex on its own. `self`: c is t, and only where it lies more than once counts.
template <class Number>
Number closed_form(const NumberRing<Number>& c, const NumberRing<Number>& t, double depth,
                   bool self = false) {
  const size_t n = t.size();
  std::vector<Number> tx(n), ty(n), length(n), mx(n), my(n);
  for (size_t i = 0; i < n; ++i) {
    const Number dx = t.x[t.next(i)] - t.x[i], dy = t.y[t.next(i)] - t.y[i];
    length[i] = std::sqrt(dx * dx + dy * dy);
    tx[i] = dx / length[i], ty[i] = dy / length[i];
  }
  NumberRing<Number> top = t;
  for (size_t i = 0; i < n; ++i) {
    const size_t j = t.next(i);
    const Mitre<Number> m(tx[i], ty[i], tx[j], ty[j]);
    mx[j] = m.x, my[j] = m.y;
    top.x[j] += depth * m.x, top.y[j] += depth * m.y;
  }
  const std::vector<Vec2> real_top = top.real(), real_c = c.real();
  const auto swept = [](const Number& ax, const Number& ay, const Number& bx, const Number& by) {
    return (ax * by - ay * bx) / 2.;
  };
  Number sum = 0;
  for (size_t e = 0; e < c.size(); ++e) {
    const size_t g = c.next(e);
    sum += depth * static_cast<double>(winding_of(real_top, real_c[e])) *
           swept(c.x[e], c.y[e], c.x[g], c.y[g]);
  }
  for (size_t i = 0; i < n; ++i) {
    const size_t q = t.next(i);
    const CollarFace<Number> face =
        CollarFace<Number>{t.x[i], t.y[i], t.x[q], t.y[q], tx[i], ty[i], length[i],
                           mx[i],  my[i],  mx[q],  my[q],  depth, 0}
            .with_regular_depth();
    const double around = winding_of(real_c, real_top[i]) - (self ? 1 : 0);
    sum +=
        around * (collar_cell(face).height + depth * swept(top.x[i], top.y[i], top.x[q], top.y[q]));
    for (size_t e = 0; e < c.size(); ++e) {
      CollarPiece<Number> piece;
      CollarCrossings<Number> crossings;
      const size_t g = c.next(e);
      if (self && e == i) continue;
      if (!collar_piece(face, c.x[e], c.y[e], c.x[g], c.y[g], piece, crossings)) continue;
      sum += piece.height;
      for (int k = 0; k < crossings.count; ++k) {
        const auto& [u, tau, sign] = crossings.list[static_cast<size_t>(k)];
        const double s = sign;
        const Number x = c.x[e] + u * (c.x[g] - c.x[e]), y = c.y[e] + u * (c.y[g] - c.y[e]);
        sum -= s * (collar_rest(face, tau).height + depth * swept(x, y, top.x[q], top.y[q]));
        sum += s * depth * swept(x, y, c.x[g], c.y[g]);
      }
    }
  }
  return sum;
}

/// The depth below an outline at a point, by its definition.
struct DepthField {
  std::vector<Vec2> ring, top;
  double depth;

  DepthField(const std::vector<Vec2>& of, double h) : ring(of), top(of), depth(h) {
    const size_t n = ring.size();
    for (size_t i = 0; i < n; ++i) {
      const Vec2 p = (ring[i] - ring[(i + n - 1) % n]).normalized();
      const Vec2 q = (ring[(i + 1) % n] - ring[i]).normalized();
      const Vec2 normals(-p.y() - q.y(), p.x() + q.x());
      top[i] += h * normals / (1 + p.dot(q));
    }
  }
  [[nodiscard]] double at(const Vec2& x) const {
    double sum = depth * winding_of(top, x);
    const size_t n = ring.size();
    for (size_t i = 0; i < n; ++i) {
      const Vec2 a = ring[i], t = (ring[(i + 1) % n] - a).normalized();
      const double h = cross(t, x - a);
      if (h < 0 || h > depth) continue;
      const double tau = t.dot(x - a);
      const double from = t.dot(top[i] - a) * h / depth;
      const double base = (ring[(i + 1) % n] - a).norm();
      const double to = base + (t.dot(top[(i + 1) % n] - a) - base) * h / depth;
      if (tau >= from && tau < to) sum += h;
      if (tau < from && tau >= to) sum -= h;
    }
    return sum;
  }
};

/// INT over c of the depth below t, or over where t lies more than once, by points: between the
/// heights y of all ends and crossings of lines, and between their places x at a height, the depth
/// is linear, so that Gauss points are exact.
inline double by_points(const std::vector<Vec2>& c, const std::vector<Vec2>& t, double depth,
                        bool self = false) {
  const DepthField field(t, depth);
  std::vector<std::pair<Vec2, Vec2>> lines;
  const size_t n = t.size();
  for (size_t i = 0; i < c.size(); ++i) lines.emplace_back(c[i], c[(i + 1) % c.size()]);
  for (size_t i = 0; i < n; ++i) {
    const size_t j = (i + 1) % n;
    lines.emplace_back(t[i], t[j]);
    lines.emplace_back(field.top[i], field.top[j]);
    lines.emplace_back(t[i], field.top[i]);
  }
  std::vector<double> heights;
  for (size_t i = 0; i < lines.size(); ++i) {
    const auto& [a, b] = lines[i];
    heights.push_back(a.y()), heights.push_back(b.y());
    for (size_t j = 0; j < i; ++j) {
      const auto& [p, q] = lines[j];
      const double u = cross(p - a, q - p) / cross(b - a, q - p);
      if (u > 0 && u < 1) heights.push_back((a + u * (b - a)).y());
    }
  }
  std::ranges::sort(heights);
  double sum = 0;
  for (size_t i = 1; i < heights.size(); ++i) {
    const double low = heights[i - 1], width = heights[i] - low;
    if (!(width > 0)) continue;
    for (const double g : {.5 - std::sqrt(1. / 12), .5 + std::sqrt(1. / 12)}) {
      const double y = low + g * width;
      std::vector<double> places;
      for (const auto& [a, b] : lines) {
        if ((a.y() > y) != (b.y() > y)) {
          places.push_back(a.x() + (b.x() - a.x()) * (y - a.y()) / (b.y() - a.y()));
        }
      }
      std::ranges::sort(places);
      for (size_t k = 1; k < places.size(); ++k) {
        const Vec2 middle((places[k - 1] + places[k]) / 2, y);
        const int inside = winding_of(c, middle) - (self ? 1 : 0);
        if (inside != 0) sum += width / 2 * (places[k] - places[k - 1]) * inside * field.at(middle);
      }
    }
  }
  return sum;
}

}  // namespace apothem::test
