#include "geometry/edge_integral.hpp"

#include <cmath>

#include "geometry/distance_volume.hpp"
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
    // By the flatter of the two lines: along a needle the other one may be a million times steeper.
    const bool flatter = std::abs(slope(next)) < std::abs(slope(line));
    const double end_height = value(flatter ? next : line, end);
    if (end > s) piece(s, height, end, end_height);
    s = end;
    height = end_height;
    line = next;
    if (s >= s1) return;
  }
}

// Heights of a point over the edges of y, and 1 for the cap.
void height_row(const PlacedPotential& y, double px, double py, double* row) {
  for (int i = 0; i < y.size; ++i) {
    row[i] = y.gx[i] * (px - y.x[i]) + y.gy[i] * (py - y.y[i]);
  }
  if (y.capped) row[y.size] = 1;
}

// Heights of the points of x over the edges of y: rows of y.size (+ 1 for the cap) entries, one per
// vertex, first row repeated at the end. True when one edge of y has all of x outside.
bool heights(const PlacedPotential& x, const PlacedPotential& y, double dx, double dy,
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
};

// End points of the clipped edges, in a buffer that only grows.
class Pieces {
 public:
  explicit Pieces(std::vector<double>& buffer) : buffer_(buffer) {}
  void reserve(int more) {
    const size_t size = used_ + 4 * static_cast<size_t>(more);
    if (buffer_.size() < size) buffer_.resize(size);
  }
  void add(double x0, double y0, double x1, double y1) {
    double* const end = buffer_.data() + used_;
    end[0] = x0, end[1] = y0, end[2] = x1, end[3] = y1;
    used_ += 4;
  }
  [[nodiscard]] size_t used() const { return used_; }
  [[nodiscard]] const double* data() const { return buffer_.data(); }

 private:
  std::vector<double>& buffer_;
  size_t used_ = 0;
};

// A linear piece of phi below the cap.
void add_capped(double u1, double v1, double u2, double v2, SegmentMoments<double>& moments) {
  if ((v1 > 1) == (v2 > 1)) {
    moments.add(u1, std::min(v1, 1.0), u2, std::min(v2, 1.0));
    return;
  }
  const double u = u1 + (1 - v1) / (v2 - v1) * (u2 - u1);
  moments.add(u1, std::min(v1, 1.0), u, 1);
  moments.add(u, 1, u2, std::min(v2, 1.0));
}

// An edge of x in the frame of y, its start also relative to y's reference point.
struct PlacedEdge {
  PlacedEdge(const PlacedPotential& x, const PlacedPotential& y, int e, double dx, double dy)
      : px(x.x[e] + dx),
        py(x.y[e] + dy),
        qx(px - y.reference.x()),
        qy(py - y.reference.y()),
        ex(x.x[e + 1] - x.x[e]),
        ey(x.y[e + 1] - x.y[e]) {
    shorten(y);
  }
  double px, py, qx, qy, ex, ey;
  bool shortened = false;

  void add_piece(double s0, double s1, Pieces& pieces) const {
    pieces.add(qx + s0 * ex, qy + s0 * ey, qx + s1 * ex, qy + s1 * ey);
  }

 private:
  // Of an edge that is long against y only the part around the foot of y's reference point counts:
  // a fraction of the whole length could not place the few millimetres inside y on a floor of a
  // kilometre.
  void shorten(const PlacedPotential& y) {
    constexpr double kLong = 8;
    const double length2 = ex * ex + ey * ey;
    if (!(length2 > kLong * kLong * y.radius * y.radius) || y.radius == 0) return;
    const double length = std::sqrt(length2);
    const double tx = ex / length;
    const double ty = ey / length;
    const double foot = -(tx * qx + ty * qy);  // along the edge, from its start
    const double height = tx * qy - ty * qx;   // of the edge's line over the reference point
    const double from = foot - 2 * y.radius;
    const double until = foot + 2 * y.radius;
    if (until <= 0 || from >= length) return;
    const Vec2 start =
        from <= 0 ? Vec2(qx, qy)
                  : Vec2(-ty * height - 2 * y.radius * tx, tx * height - 2 * y.radius * ty);
    const Vec2 end = until >= length
                         ? Vec2(qx + ex, qy + ey)
                         : Vec2(-ty * height + 2 * y.radius * tx, tx * height + 2 * y.radius * ty);
    qx = start.x();
    qy = start.y();
    px = qx + y.reference.x();
    py = qy + y.reference.y();
    ex = end.x() - start.x();
    ey = end.y() - start.y();
    shortened = true;
  }
};

void accumulate(const PlacedEdge& edge, const SegmentMoments<double>& m, double inside,
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

// y convex: its envelope on the part of each edge of x that clipping leaves.
Half integrate_envelope(const PlacedPotential& x, const PlacedPotential& y, double dx, double dy,
                        const double* rows, double* spare, Pieces& pieces) {
  const int width = y.size + (y.capped ? 1 : 0);
  Half half;
  pieces.reserve(x.size);
  for (int e = 0; e < x.size; ++e) {
    const PlacedEdge edge(x, y, e, dx, dy);
    Row row{rows + e * width, rows + (e + 1) * width, y.size, width};
    if (edge.shortened) {
      height_row(y, edge.px, edge.py, spare);
      height_row(y, edge.px + edge.ex, edge.py + edge.ey, spare + width);
      row.a = spare;
      row.b = spare + width;
    }
    double s0, s1;
    if (!clip(row, s0, s1)) continue;
    SegmentMoments<double> moments;
    walk_envelope(row, s0, s1,
                  [&](double u1, double v1, double u2, double v2) { moments.add(u1, v1, u2, v2); });
    accumulate(edge, moments, s1 - s0, half);
    edge.add_piece(s0, s1, pieces);
  }
  return half;
}

// y not convex: calls along(edge, pieces), which returns phi's moments and adds the parts inside y
// to `inside`, for the edges of x that may enter y, perhaps several times.
template <class Along>
Half integrate_edges(const PlacedPotential& x, const PlacedPotential& y, double dx, double dy,
                     const Along& along) {
  Half half;
  Box box;
  double finite = 0;  // 0 * coordinate: a NaN or an infinity shows
  for (int i = 0; i < y.size; ++i) {
    box.include(y.x[i], y.y[i]);
    finite += 0 * y.x[i] + 0 * y.y[i];
  }
  for (int i = 0; i < x.size; ++i) finite += 0 * (x.x[i] + dx) + 0 * (x.y[i] + dy);
  half.weight = finite;  // NaN never passes as "no contact"
  if (!(finite == 0)) return half;
  for (int e = 0; e < x.size; ++e) {
    const PlacedEdge edge(x, y, e, dx, dy);
    Box own;
    own.include(edge.px, edge.py);
    own.include(edge.px + edge.ex, edge.py + edge.ey);
    if (apart(own, box)) continue;
    double inside = 0;
    const SegmentMoments<double> moments = along(edge, inside);
    accumulate(edge, moments, inside, half);
  }
  return half;
}

Half integrate_roof(const PlacedPotential& x, const PlacedPotential& y, double dx, double dy,
                    RoofTrace<double>& trace, Pieces& pieces) {
  const PlacedRoof<double> roof{&y.roof->arcs, y.size,   static_cast<int>(y.roof->values.size()),
                                y.node_x,      y.node_y, y.roof->values.data()};
  return integrate_edges(x, y, dx, dy, [&](const PlacedEdge& edge, double& inside) {
    trace.cross(roof, edge.px, edge.py, edge.ex, edge.ey);
    SegmentMoments<double> moments;
    trace.pieces([&](double u1, double v1, double u2, double v2) {
      if (y.capped) {
        add_capped(u1, v1, u2, v2, moments);
      } else {
        moments.add(u1, v1, u2, v2);
      }
      inside += u2 - u1;
      pieces.reserve(1);
      edge.add_piece(u1, u2, pieces);
    });
    return moments;
  });
}

PlacedDistance<double> placed_distance(const PlacedPotential& y) {
  return {y.size, y.x, y.y, y.gx, y.gy, y.distance->slope, &y.distance->corners, y.capped};
}

Half integrate_distance(const PlacedPotential& x, const PlacedPotential& y, double dx, double dy,
                        DistanceTrace<double>& trace, Pieces& pieces) {
  const PlacedDistance<double> field = placed_distance(y);
  return integrate_edges(x, y, dx, dy, [&](const PlacedEdge& edge, double& inside) {
    return trace.integrate(field, edge.px, edge.py, edge.ex, edge.ey, [&](double u1, double u2) {
      inside += u2 - u1;
      pieces.reserve(1);
      edge.add_piece(u1, u2, pieces);
    });
  });
}

}  // namespace

PairIntegral pair_integral(const PlacedPotential& a, const PlacedPotential& b, const Vec2& offset,
                           EdgeWorkspace& workspace) {
  const size_t rows_a = static_cast<size_t>(a.size + 1) * (b.size + 1);
  const size_t rows_b = static_cast<size_t>(b.size + 1) * (a.size + 1);
  const size_t spare = 2 * (static_cast<size_t>(std::max(a.size, b.size)) + 1);
  if (workspace.values.size() < rows_a + rows_b + spare) {
    workspace.values.resize(rows_a + rows_b + spare);
  }
  double* const of_a_rows = workspace.values.data();
  double* const of_b_rows = of_a_rows + rows_a;
  double* const spare_rows = of_b_rows + rows_b;
  const double dx = offset.x();
  const double dy = offset.y();
  if (b.convex() && heights(a, b, dx, dy, of_a_rows)) return {};
  if (a.convex() && heights(b, a, -dx, -dy, of_b_rows)) return {};

  Pieces pieces(workspace.pieces);
  const auto half = [&](const PlacedPotential& x, const PlacedPotential& y, double x0, double y0,
                        const double* rows) {
    if (y.roof) return integrate_roof(x, y, x0, y0, workspace.roof, pieces);
    if (y.distance) return integrate_distance(x, y, x0, y0, workspace.distance, pieces);
    return integrate_envelope(x, y, x0, y0, rows, spare_rows, pieces);
  };
  const Half of_a = half(a, b, dx, dy, of_a_rows);  // frame of b
  const size_t middle = pieces.used();
  const Half of_b = half(b, a, -dx, -dy, of_b_rows);  // frame of a

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
    const auto project = [&](size_t from, size_t to, double shift_n, double shift_t) {
      for (const double* p = pieces.data() + from; p != pieces.data() + to; p += 2) {
        const double n = nx * p[0] + ny * p[1] + shift_n;
        const double t = nx * p[1] - ny * p[0] + shift_t;
        n0 = std::min(n0, n), n1 = std::max(n1, n);
        t0 = std::min(t0, t), t1 = std::max(t1, t);
      }
    };
    project(0, middle, 0, 0);
    project(middle, pieces.used(), nx * rx + ny * ry, nx * ry - ny * rx);
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

namespace {

using Ring = std::vector<Vec2>;
using Parts = std::vector<lower_envelope::SignedRing<double>>;

Ring ring(const PlacedPotential& p, const Vec2& shift) {
  Ring result;
  for (int v = 0; v < p.size; ++v) result.push_back(Vec2(p.x[v], p.y[v]) + shift);
  return result;
}

Parts convex_parts(const PlacedPotential& p, const Vec2& shift) {
  if (p.convex()) return {{ring(p, shift), 1}};
  return lower_envelope::fan(ring(p, shift));
}

// INT phi_p dA over the overlap with the parts of the other polygon.
double volume_under(const PlacedPotential& p, const Vec2& shift, const Parts& others) {
  const auto planes = lines(p, shift);
  if (p.roof) {
    std::vector<Ring> faces;
    for (const std::vector<int>& nodes : p.roof->faces) {
      Ring& face = faces.emplace_back();
      for (const int i : nodes) face.push_back(Vec2(p.node_x[i], p.node_y[i]) + shift);
    }
    return lower_envelope::volume_under_faces(faces, planes, p.capped, others);
  }
  const Ring outline = ring(p, shift);
  double volume = 0;
  for (const auto& part : others) {
    volume += part.sign * lower_envelope::volume_under(planes, p.capped,
                                                       lower_envelope::inside(part.ring, outline));
  }
  return volume;
}

// The same for a distance field and the whole other polygon, which stands at `shift` seen from p.
double volume_under_distance(const PlacedPotential& p, const PlacedPotential& other,
                             const Vec2& shift) {
  std::vector<double> x, y;
  for (const Vec2& v : ring(other, shift)) {
    x.push_back(v.x());
    y.push_back(v.y());
  }
  return DistanceVolume<double>().over(placed_distance(p), x, y);
}

}  // namespace

PairVolume pair_volume(const PlacedPotential& a, const PlacedPotential& b, const Vec2& offset) {
  const Parts parts_a = convex_parts(a, offset);
  const Parts parts_b = convex_parts(b, Vec2::Zero());
  PairVolume volume;
  volume.energy =
      (a.distance ? volume_under_distance(a, b, -offset) : volume_under(a, offset, parts_b)) +
      (b.distance ? volume_under_distance(b, a, offset) : volume_under(b, Vec2::Zero(), parts_a));
  const lower_envelope::Line<double> one{Vec2::Zero(), 1};
  for (const auto& part_a : parts_a) {
    for (const auto& part_b : parts_b) {
      volume.overlap_area +=
          part_a.sign * part_b.sign *
          lower_envelope::area_integral(lower_envelope::inside(part_a.ring, part_b.ring), one);
    }
  }
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
      // The boundary exactly as given, the inner nodes by their place in the polygon.
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
            radius};
  }
  std::vector<double> x, y, gx, gy, node_x, node_y;
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
