#include "geometry/edge_integral.hpp"

#include <cmath>

#include "geometry/lower_envelope.hpp"

namespace apothem {
namespace {

// phi is the minimum of the lines a_i + s (b_i - a_i) along an edge, s in [0, 1]; a_i and b_i are
// the heights of its two ends over edge i of the other polygon (1 for the cap phi <= 1).
struct Row {
  const double* a;
  const double* b;
  int size;   // lines that bound the polygon
  int lines;  // size, or size + 1 with the cap
};

// Interval of the edge inside the polygon: one sign per node, half-open, no tolerance. A NaN ends
// up in the interval, never in "outside".
bool clip(const Row& row, double& s0, double& s1) {
  s0 = 0;
  s1 = 1;
  for (int i = 0; i < row.size; ++i) {
    const double a = row.a[i];
    const double b = row.b[i];
    if (a >= 0) {
      if (b >= 0) continue;
      const double s = a / (a - b);
      if (!(s >= s1)) s1 = s;
    } else {
      if (a < 0 && b < 0) return false;
      const double s = a / (a - b);
      if (!(s <= s0)) s0 = s;
    }
  }
  return !(s0 >= s1);
}

// Calls piece(s, value, s_next, value_next) along the concave lower envelope from s0 to s1.
template <class Piece>
void walk_envelope(const Row& row, double s0, double s1, const Piece& piece) {
  const auto value = [&](int i, double s) { return row.a[i] + s * (row.b[i] - row.a[i]); };
  const auto slope = [&](int i) { return row.b[i] - row.a[i]; };
  int line = 0;
  double height = value(0, s0);
  for (int i = 1; i < row.lines; ++i) {
    const double h = value(i, s0);
    if (!(h >= height) || (h == height && slope(i) < slope(line))) {
      line = i;
      height = h;
    }
  }
  for (double s = s0;;) {
    // The next line to take over falls faster and meets the present one first. Fractions gap/fall
    // are compared by cross-multiplication: one division per piece instead of one per line.
    int next = -1;
    double gap = s1 - s;
    double fall = 1;
    for (int i = 0; i < row.lines; ++i) {
      const double f = slope(line) - slope(i);
      if (!(f > 0)) continue;
      const double g = std::max(value(i, s) - height, 0.0);
      const double left = g * fall;
      const double right = gap * f;
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
    const double end = std::min(s + gap / fall, s1);
    const double end_height = value(next, end);
    if (end > s) piece(s, height, end, end_height);
    s = end;
    height = end_height;
    line = next;
    if (s >= s1) return;
  }
}

// Heights of the points of x over the edges of y: rows of y.size (+ 1 for the cap) entries, one per
// vertex, first row repeated at the end. True when one edge of y has all of x outside.
bool heights(const PlacedPotential& x, const PlacedPotential& y, double dx, double dy,
             double* rows) {
  const int n = y.size;
  const int width = n + (y.capped ? 1 : 0);
  for (int v = 0; v < x.size; ++v) {
    double* row = rows + v * width;
    const double px = x.x[v] + dx;
    const double py = x.y[v] + dy;
    for (int i = 0; i < n; ++i) {
      row[i] = y.gx[i] * (px - y.x[i]) + y.gy[i] * (py - y.y[i]);
    }
    if (y.capped) row[n] = 1;
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
};

Half integrate(const PlacedPotential& x, const PlacedPotential& y, double dx, double dy,
               const double* rows, double*& pieces) {
  const int width = y.size + (y.capped ? 1 : 0);
  Half half;
  for (int e = 0; e < x.size; ++e) {
    const Row row{rows + e * width, rows + (e + 1) * width, y.size, width};
    double s0, s1;
    if (!clip(row, s0, s1)) continue;
    double sum = 0;    // INT phi du
    double first = 0;  // INT phi u du
    double largest = 0;
    walk_envelope(row, s0, s1, [&](double u1, double v1, double u2, double v2) {
      const double h = u2 - u1;
      sum += h * (v1 + v2) / 2;
      first += h * (v1 * (2 * u1 + u2) + v2 * (u1 + 2 * u2)) / 6;
      largest = std::max(largest, std::max(v1, v2));
    });
    const double px = x.x[e] + dx;
    const double py = x.y[e] + dy;
    const double qx = px - y.reference.x();
    const double qy = py - y.reference.y();
    const double ex = x.x[e + 1] - x.x[e];
    const double ey = x.y[e + 1] - x.y[e];
    const double length = std::sqrt(ex * ex + ey * ey);
    half.fx += ey * sum;
    half.fy -= ex * sum;
    half.moment -= (qx * ex + qy * ey) * sum + (ex * ex + ey * ey) * first;
    half.weight += length * sum;
    half.wx += length * (qx * sum + ex * first);
    half.wy += length * (qy * sum + ey * first);
    half.length += length * (s1 - s0);
    half.largest = std::max(half.largest, largest);
    *pieces++ = px + s0 * ex;
    *pieces++ = py + s0 * ey;
    *pieces++ = px + s1 * ex;
    *pieces++ = py + s1 * ey;
  }
  return half;
}

struct Rows {
  double* of_a;
  double* of_b;
  double* pieces;
};

Rows reserve(const PlacedPotential& a, const PlacedPotential& b, EdgeWorkspace& workspace) {
  const size_t rows_a = static_cast<size_t>(a.size + 1) * (b.size + 1);
  const size_t rows_b = static_cast<size_t>(b.size + 1) * (a.size + 1);
  if (workspace.values.size() < rows_a + rows_b) workspace.values.resize(rows_a + rows_b);
  const size_t pieces = 4 * static_cast<size_t>(a.size + b.size);
  if (workspace.pieces.size() < pieces) workspace.pieces.resize(pieces);
  return {workspace.values.data(), workspace.values.data() + rows_a, workspace.pieces.data()};
}

}  // namespace

PairIntegral pair_integral(const PlacedPotential& a, const PlacedPotential& b, const Vec2& offset,
                           EdgeWorkspace& workspace) {
  const Rows rows = reserve(a, b, workspace);
  const double dx = offset.x();
  const double dy = offset.y();
  if (heights(a, b, dx, dy, rows.of_a) || heights(b, a, -dx, -dy, rows.of_b)) return {};

  double* middle = rows.pieces;
  const Half of_a = integrate(a, b, dx, dy, rows.of_a, middle);  // frame of b
  double* end = middle;
  const Half of_b = integrate(b, a, -dx, -dy, rows.of_b, end);  // frame of a

  PairIntegral pair;
  const double fx = of_b.fx - of_a.fx;
  const double fy = of_b.fy - of_a.fy;
  pair.force = {fx, fy};
  // A moment about the owner's reference, moved to the other's by the arm between them.
  const double rx = (a.reference.x() - b.reference.x()) + dx;
  const double ry = (a.reference.y() - b.reference.y()) + dy;
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

  const double size = std::sqrt(fx * fx + fy * fy);
  if (size > 0) {
    const double nx = fx / size;
    const double ny = fy / size;
    double n0 = HUGE_VAL, n1 = -HUGE_VAL, t0 = HUGE_VAL, t1 = -HUGE_VAL;
    const auto project = [&](const double* from, const double* to, double shift_n, double shift_t) {
      for (; from != to; from += 2) {
        const double n = nx * from[0] + ny * from[1] + shift_n;
        const double t = nx * from[1] - ny * from[0] + shift_t;
        n0 = std::min(n0, n), n1 = std::max(n1, n);
        t0 = std::min(t0, t), t1 = std::max(t1, t);
      }
    };
    project(rows.pieces, middle, 0, 0);
    project(middle, end, nx * dx + ny * dy, nx * dy - ny * dx);
    pair.penetration = n1 - n0;
    pair.breadth = t1 - t0;
  }
  return pair;
}

namespace {

std::vector<lower_envelope::Line<double>> lines(const PlacedPotential& p, const Vec2& shift) {
  std::vector<lower_envelope::Line<double>> result;
  for (int i = 0; i < p.size; ++i) {
    const Vec2 g(p.gx[i], p.gy[i]);
    result.push_back({g, -g.dot(Vec2(p.x[i], p.y[i]) + shift)});
  }
  return result;
}

}  // namespace

PairVolume pair_volume(const PlacedPotential& a, const PlacedPotential& b, const Vec2& offset) {
  const auto lines_a = lines(a, offset);
  const auto lines_b = lines(b, Vec2::Zero());
  std::vector<Vec2> overlap;
  for (int v = 0; v < a.size; ++v) overlap.push_back(Vec2(a.x[v], a.y[v]) + offset);
  for (const auto& line : lines_b) overlap = lower_envelope::clip(overlap, line, true);
  PairVolume volume;
  volume.overlap_area = lower_envelope::area_integral(overlap, {Vec2::Zero(), 1});
  volume.energy = lower_envelope::volume_under(lines_a, a.capped, overlap) +
                  lower_envelope::volume_under(lines_b, b.capped, overlap);
  return volume;
}

Vec2 loading_point(const PairIntegral& pair) {
  const double size = pair.force.norm();
  // Equal and opposite tractions have no line of action worth following.
  if (!(size > 1e-12 * pair.weight)) return pair.centre;
  const Vec2 tangent(-pair.force.y() / size, pair.force.x() / size);
  return pair.centre + tangent * ((cross(pair.centre, pair.force) - pair.moment_a) / size);
}

namespace {

// Arrays behind a PlacedPotential, for a polygon that does not move: relative to `origin`, moments
// about vertex 0.
struct Placement {
  Placement(const Polygon& polygon, const Potential& potential, const Vec2& origin) {
    for (int i = 0; i <= polygon.size(); ++i) {
      const Vec2 v = polygon[i == polygon.size() ? 0 : i] - origin;
      x.push_back(v.x());
      y.push_back(v.y());
    }
    for (const Vec2& g : potential.gradients) {
      gx.push_back(g.x());
      gy.push_back(g.y());
    }
    view = {x.data(),       y.data(),           gx.data(),       gy.data(),
            polygon.size(), potential.capped(), Vec2(x[0], y[0])};
  }
  std::vector<double> x, y, gx, gy;
  PlacedPotential view;
};

}  // namespace

PairResult edge_method(const Polygon& a, const Potential& potential_a, const Polygon& b,
                       const Potential& potential_b) {
  Box box = bounding_box(a);
  const Box box_b = bounding_box(b);
  box.include(box_b.x0, box_b.y0);
  box.include(box_b.x1, box_b.y1);
  const Vec2 origin = local_origin(box);
  const Placement placed_a(a, potential_a, origin);
  const Placement placed_b(b, potential_b, origin);
  EdgeWorkspace workspace;
  PairResult result;
  PairIntegral& pair = result.integral;
  pair = pair_integral(placed_a.view, placed_b.view, Vec2::Zero(), workspace);
  const Vec2 centroid_a = area_moments(a).centroid;  // relative to vertex 0
  const Vec2 centroid_b = area_moments(b).centroid;
  pair.moment_a -= cross(centroid_a, pair.force);
  pair.moment_b += cross(centroid_b, pair.force);
  pair.centre -= centroid_a;
  result.volume = pair_volume(placed_a.view, placed_b.view, Vec2::Zero());
  return result;
}

}  // namespace apothem
