// Private to edge_integral.cpp and contact_patches.cpp: phi of one polygon along the edges of
// another, and the sums that make a pair of it.
#pragma once

#include <algorithm>
#include <cmath>

#include "apothem/geometry/integrals/edge_integral.hpp"
#include "apothem/geometry/polygon/segment_moments.hpp"

namespace apothem::edge_detail {

// phi is the minimum of the lines a_i + s (b_i - a_i) along an edge, s in [0, 1]; a_i and b_i are
// the heights of its two ends over edge i of the other polygon (1 for the cap phi <= 1).
template <class Real>
struct Row {
  const Real* a;
  const Real* b;
  int size;   // lines that bound the polygon
  int lines;  // size, or size + 1 with the cap
};

// Interval of the edge inside the polygon: one sign per node, half-open, no tolerance. A NaN ends
// up in the interval, never in "outside".
template <class Real>
bool clip(const Row<Real>& row, Real& s0, Real& s1) {
  s0 = 0;
  s1 = 1;
  for (int i = 0; i < row.size; ++i) {
    const Real a = row.a[i];
    const Real b = row.b[i];
    if (a >= 0) {
      if (b >= 0) continue;
      const Real s = a / (a - b);
      if (!(s >= s1)) s1 = s;
    } else {
      if (a < 0 && b < 0) return false;
      const Real s = a / (a - b);
      if (!(s <= s0)) s0 = s;
    }
  }
  return !(s0 >= s1);
}

// Calls piece(s, value, s_next, value_next) along the concave lower envelope from s0 to s1.
template <class Real, class Piece>
void walk_envelope(const Row<Real>& row, Real s0, Real s1, const Piece& piece) {
  const auto value = [&](int i, Real s) { return row.a[i] + s * (row.b[i] - row.a[i]); };
  const auto slope = [&](int i) { return row.b[i] - row.a[i]; };
  int line = 0;
  Real height = value(0, s0);
  for (int i = 1; i < row.lines; ++i) {
    const Real h = value(i, s0);
    if (!(h >= height) || (h == height && slope(i) < slope(line))) {
      line = i;
      height = h;
    }
  }
  for (Real s = s0;;) {
    // The next line to take over falls faster and meets the present one first. Fractions gap/fall
    // are compared by cross-multiplication: one division per piece instead of one per line.
    int next = -1;
    Real gap = s1 - s;
    Real fall = 1;
    for (int i = 0; i < row.lines; ++i) {
      const Real f = slope(line) - slope(i);
      if (!(f > 0)) continue;
      const Real g = std::max(value(i, s) - height, Real(0));
      const Real left = g * fall;
      const Real right = gap * f;
      if (left < right || (left == right && next >= 0 && slope(i) < slope(next))) {
        next = i;
        gap = g;
        fall = f;
      }
    }
    if (next < 0) {
      piece(s, height, s1, value(line, s1));
      return;
    }
    const Real end = std::min(s + gap / fall, s1);
    // By the flatter of the two lines: along a needle the other one may be a million times steeper.
    const bool flatter = std::abs(slope(next)) < std::abs(slope(line));
    const Real end_height = value(flatter ? next : line, end);
    if (end > s) piece(s, height, end, end_height);
    s = end;
    height = end_height;
    line = next;
    if (s >= s1) return;
  }
}

// Heights of a point over the edges of y, and 1 for the cap.
inline void height_row(const PlacedPotential& y, double px, double py, double* row) {
  for (int i = 0; i < y.size; ++i) {
    row[i] = y.gx[i] * (px - y.x[i]) + y.gy[i] * (py - y.y[i]);
  }
  if (y.capped) row[y.size] = 1;
}

// Heights of the points of x over the edges of y: rows of y.size (+ 1 for the cap) entries, one per
// vertex, first row repeated at the end. True when one edge of y has all of x outside.
inline bool heights(const PlacedPotential& x, const PlacedPotential& y, double dx, double dy,
                    double* rows) {
  const int n = y.size;
  const int width = n + (y.capped ? 1 : 0);
  for (int v = 0; v < x.size; ++v) {
    height_row(y, x.x[v] + dx, x.y[v] + dy, rows + v * width);
  }
  for (int i = 0; i < width; ++i) rows[x.size * width + i] = rows[i];
  for (int i = 0; i < n; ++i) {
    int outside = 0;
    for (int v = 0; v < x.size; ++v) outside += rows[v * width + i] < 0;
    if (outside == x.size) return true;
  }
  return false;
}

// Integrals of phi_y along the edges of x, in the frame of y, without the sign of Eq. 7.
struct Half {
  double fx = 0, fy = 0;  // SUM n INT phi ds
  double moment = 0;      // about y's reference point
  double weight = 0, wx = 0, wy = 0;
  double length = 0;
  double largest = 0;

  void add(const Half& other) {
    fx += other.fx, fy += other.fy;
    moment += other.moment;
    weight += other.weight, wx += other.wx, wy += other.wy;
    length += other.length;
    largest = std::max(largest, other.largest);
  }
};

// A linear piece of phi below the cap.
inline void add_capped(double u1, double v1, double u2, double v2,
                       SegmentMoments<double>& moments) {
  if ((v1 > 1) == (v2 > 1)) {
    moments.add(u1, std::min(v1, 1.0), u2, std::min(v2, 1.0));
    return;
  }
  const double u = u1 + (1 - v1) / (v2 - v1) * (u2 - u1);
  moments.add(u1, std::min(v1, 1.0), u, 1);
  moments.add(u, 1, u2, std::min(v2, 1.0));
}

// An edge of x in the frame of y, its start also relative to y's reference point.
template <class Real>
struct BasicEdge {
  BasicEdge(const PlacedPotential& x, const PlacedPotential& y, int e, double dx, double dy)
      : px(Real(x.x[e]) + dx),
        py(Real(x.y[e]) + dy),
        qx(px - y.reference.x()),
        qy(py - y.reference.y()),
        ex(Real(x.x[e + 1]) - x.x[e]),
        ey(Real(x.y[e + 1]) - x.y[e]) {
    shorten(y);
  }
  Real px, py, qx, qy, ex, ey;
  Real first = 0, last = 1;  // the part of the edge that this is
  bool shortened = false;

  /// Where s of this part is on the whole edge, 0 ... 1.
  [[nodiscard]] Real share(Real s) const { return first + s * (last - first); }

 private:
  // Of an edge that is long against y only the part around the foot of y's reference point counts:
  // a fraction of the whole length could not place the few millimetres inside y on a floor of a
  // kilometre.
  void shorten(const PlacedPotential& y) {
    constexpr double kLong = 8;
    const Real length2 = ex * ex + ey * ey;
    if (!(length2 > kLong * kLong * y.radius * y.radius) || y.radius == 0) return;
    const Real length = std::sqrt(length2);
    const Real tx = ex / length;
    const Real ty = ey / length;
    const Real foot = -(tx * qx + ty * qy);  // along the edge, from its start
    const Real height = tx * qy - ty * qx;   // of the edge's line over the reference point
    const Real from = foot - 2 * y.radius;
    const Real until = foot + 2 * y.radius;
    if (until <= 0 || from >= length) return;
    const Real end_x = until >= length ? qx + ex : -ty * height + 2 * y.radius * tx;
    const Real end_y = until >= length ? qy + ey : tx * height + 2 * y.radius * ty;
    if (from > 0) {
      qx = -ty * height - 2 * y.radius * tx;
      qy = tx * height - 2 * y.radius * ty;
    }
    px = qx + y.reference.x();
    py = qy + y.reference.y();
    ex = end_x - qx;
    ey = end_y - qy;
    first = std::max(Real(0), from / length);
    last = std::min(Real(1), until / length);
    shortened = true;
  }
};
using PlacedEdge = BasicEdge<double>;

inline void accumulate(const PlacedEdge& edge, const SegmentMoments<double>& m, double inside,
                       Half& half) {
  const double qx = edge.qx, qy = edge.qy, ex = edge.ex, ey = edge.ey;
  const double length = std::sqrt(ex * ex + ey * ey);
  half.fx += ey * m.sum;
  half.fy -= ex * m.sum;
  half.moment -= (qx * ex + qy * ey) * m.sum + (ex * ex + ey * ey) * m.first;
  half.weight += length * m.sum;
  half.wx += length * (qx * m.sum + ex * m.first);
  half.wy += length * (qy * m.sum + ey * m.first);
  half.length += length * inside;
  half.largest = std::max(half.largest, m.largest);
}

/// Calls along(e, edge) for the edges of x that may enter y, which is not convex. Returns 0, or NaN
/// (and calls nothing) if a coordinate is not finite.
template <class Along>
double edges_near(const PlacedPotential& x, const PlacedPotential& y, double dx, double dy,
                  const Along& along) {
  Box box;
  double finite = 0;  // 0 * coordinate: a NaN or an infinity shows
  for (int i = 0; i < y.size; ++i) {
    box.include(y.x[i], y.y[i]);
    finite += 0 * y.x[i] + 0 * y.y[i];
  }
  for (int i = 0; i < x.size; ++i) finite += 0 * (x.x[i] + dx) + 0 * (x.y[i] + dy);
  if (!(finite == 0)) return finite;
  for (int e = 0; e < x.size; ++e) {
    const PlacedEdge edge(x, y, e, dx, dy);
    Box own;
    own.include(edge.px, edge.py);
    own.include(edge.px + edge.ex, edge.py + edge.ey);
    if (!apart(own, box)) along(e, edge);
  }
  return 0;
}

/// Heights of edge e of x (from `heights`) over the edges of y; `spare` has room for two rows.
inline Row<double> row_of(const PlacedEdge& edge, int e, const PlacedPotential& y,
                          const double* rows, double* spare) {
  const int width = y.size + (y.capped ? 1 : 0);
  if (!edge.shortened) return {rows + e * width, rows + (e + 1) * width, y.size, width};
  height_row(y, edge.px, edge.py, spare);
  height_row(y, edge.px + edge.ex, edge.py + edge.ey, spare + width);
  return {spare, spare + width, y.size, width};
}

/// Memory for the heights of both polygons.
struct HeightRows {
  double* of_a;
  double* of_b;
  double* spare;
};
inline HeightRows height_rows(const PlacedPotential& a, const PlacedPotential& b,
                              std::vector<double>& buffer) {
  const size_t rows_a = static_cast<size_t>(a.size + 1) * (b.size + 1);
  const size_t rows_b = static_cast<size_t>(b.size + 1) * (a.size + 1);
  const size_t spare = 2 * (static_cast<size_t>(std::max(a.size, b.size)) + 1);
  if (buffer.size() < rows_a + rows_b + spare) buffer.resize(rows_a + rows_b + spare);
  return {buffer.data(), buffer.data() + rows_a, buffer.data() + rows_a + rows_b};
}

inline PlacedRoof<double> placed_roof(const PlacedPotential& y) {
  return {&y.roof->arcs, y.size,   static_cast<int>(y.roof->values.size()),
          y.node_x,      y.node_y, y.roof->values.data()};
}

inline PlacedDistance<double> placed_distance(const PlacedPotential& y) {
  return {y.size, y.x, y.y, y.gx, y.gy, y.distance->slope, &y.distance->corners, y.capped};
}

/// A linear piece of phi, below the cap if there is one.
inline void add_piece(const PlacedPotential& y, double u1, double v1, double u2, double v2,
                      SegmentMoments<double>& moments) {
  if (y.capped) {
    add_capped(u1, v1, u2, v2, moments);
  } else {
    moments.add(u1, v1, u2, v2);
  }
}

/// a's reference point seen from b's.
inline Vec2 arm(const PlacedPotential& a, const PlacedPotential& b, const Vec2& offset) {
  return {(a.reference.x() - b.reference.x()) + offset.x(),
          (a.reference.y() - b.reference.y()) + offset.y()};
}

/// Both halves together, all but the extent.
inline PairIntegral combine(const Half& of_a, const Half& of_b, const Vec2& arm) {
  PairIntegral pair;
  pair.force = {of_b.fx - of_a.fx, of_b.fy - of_a.fy};
  // A moment about the owner's reference, moved to the other's by the arm between them.
  const double rx = arm.x();
  const double ry = arm.y();
  pair.moment_a = of_b.moment - (of_a.moment - (rx * of_a.fy - ry * of_a.fx));
  pair.moment_b = of_a.moment - (of_b.moment + (rx * of_b.fy - ry * of_b.fx));
  pair.weight = of_a.weight + of_b.weight;
  if (pair.weight != 0) {
    pair.centre = {(of_b.wx + (of_a.wx - rx * of_a.weight)) / pair.weight,
                   (of_b.wy + (of_a.wy - ry * of_a.weight)) / pair.weight};
  }
  pair.own_length_a = of_a.length;
  pair.own_length_b = of_b.length;
  pair.largest_phi = std::max(of_a.largest, of_b.largest);
  return pair;
}

/// Extent of points along and across a force.
struct Extent {
  double n0 = HUGE_VAL, n1 = -HUGE_VAL, t0 = HUGE_VAL, t1 = -HUGE_VAL;
  void include(double n, double t) {
    n0 = std::min(n0, n), n1 = std::max(n1, n);
    t0 = std::min(t0, t), t1 = std::max(t1, t);
  }
};

}  // namespace apothem::edge_detail
