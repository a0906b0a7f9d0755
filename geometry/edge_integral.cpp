#include "geometry/edge_integral.hpp"

#include <cmath>

#include "geometry/distance_volume.hpp"
#include "geometry/edge_trace.hpp"
#include "geometry/lower_envelope.hpp"
#include "geometry/placement.hpp"

namespace apothem {

using namespace edge_detail;

namespace {

// End points of the clipped edges, in a buffer that only grows.
class Pieces {
 public:
  explicit Pieces(std::vector<double>& buffer) : buffer_(buffer) {}
  void reserve(int more) {
    const size_t size = used_ + 4 * static_cast<size_t>(more);
    if (buffer_.size() < size) buffer_.resize(size);
  }
  void add(const PlacedEdge& e, double s0, double s1) {
    double* const end = buffer_.data() + used_;
    end[0] = e.qx + s0 * e.ex, end[1] = e.qy + s0 * e.ey;
    end[2] = e.qx + s1 * e.ex, end[3] = e.qy + s1 * e.ey;
    used_ += 4;
  }
  [[nodiscard]] size_t used() const { return used_; }
  [[nodiscard]] const double* data() const { return buffer_.data(); }

 private:
  std::vector<double>& buffer_;
  size_t used_ = 0;
};

// y convex: its envelope on the part of each edge of x that clipping leaves.
Half integrate_envelope(const PlacedPotential& x, const PlacedPotential& y, double dx, double dy,
                        const double* rows, double* spare, Pieces& pieces) {
  Half half;
  pieces.reserve(x.size);
  for (int e = 0; e < x.size; ++e) {
    const PlacedEdge edge(x, y, e, dx, dy);
    const Row row = row_of(edge, e, y, rows, spare);
    double s0, s1;
    if (!clip(row, s0, s1)) continue;
    SegmentMoments<double> moments;
    walk_envelope(row, s0, s1,
                  [&](double u1, double v1, double u2, double v2) { moments.add(u1, v1, u2, v2); });
    accumulate(edge, moments, s1 - s0, half);
    pieces.add(edge, s0, s1);
  }
  return half;
}

// y not convex: calls along(edge, pieces), which returns phi's moments and adds the parts inside y
// to `inside`, for the edges of x that may enter y, perhaps several times.
template <class Along>
Half integrate_edges(const PlacedPotential& x, const PlacedPotential& y, double dx, double dy,
                     const Along& along) {
  Half half;
  half.weight += edges_near(x, y, dx, dy, [&](int, const PlacedEdge& edge) {
    double inside = 0;
    const SegmentMoments<double> moments = along(edge, inside);
    accumulate(edge, moments, inside, half);
  });  // NaN never passes as "no contact"
  return half;
}

Half integrate_roof(const PlacedPotential& x, const PlacedPotential& y, double dx, double dy,
                    RoofTrace<double>& trace, Pieces& pieces) {
  const PlacedRoof<double> roof = placed_roof(y);
  return integrate_edges(x, y, dx, dy, [&](const PlacedEdge& edge, double& inside) {
    trace.cross(roof, edge.px, edge.py, edge.ex, edge.ey);
    SegmentMoments<double> moments;
    trace.pieces([&](double u1, double v1, double u2, double v2) {
      add_piece(y, u1, v1, u2, v2, moments);
      inside += u2 - u1;
      pieces.reserve(1);
      pieces.add(edge, u1, u2);
    });
    return moments;
  });
}

Half integrate_distance(const PlacedPotential& x, const PlacedPotential& y, double dx, double dy,
                        DistanceTrace<double>& trace, Pieces& pieces) {
  const PlacedDistance<double> field = placed_distance(y);
  return integrate_edges(x, y, dx, dy, [&](const PlacedEdge& edge, double& inside) {
    return trace.integrate(field, edge.px, edge.py, edge.ex, edge.ey, [&](double u1, double u2) {
      inside += u2 - u1;
      pieces.reserve(1);
      pieces.add(edge, u1, u2);
    });
  });
}

}  // namespace

PairIntegral pair_integral(const PlacedPotential& a, const PlacedPotential& b, const Vec2& offset,
                           EdgeWorkspace& workspace) {
  const HeightRows height = height_rows(a, b, workspace.values);
  const double dx = offset.x();
  const double dy = offset.y();
  if (b.convex() && heights(a, b, dx, dy, height.of_a)) return {};
  if (a.convex() && heights(b, a, -dx, -dy, height.of_b)) return {};

  Pieces pieces(workspace.pieces);
  const auto half = [&](const PlacedPotential& x, const PlacedPotential& y, double x0, double y0,
                        const double* rows) {
    if (y.roof) return integrate_roof(x, y, x0, y0, workspace.roof, pieces);
    if (y.distance) return integrate_distance(x, y, x0, y0, workspace.distance, pieces);
    return integrate_envelope(x, y, x0, y0, rows, height.spare, pieces);
  };
  const Half of_a = half(a, b, dx, dy, height.of_a);  // frame of b
  const size_t middle = pieces.used();
  const Half of_b = half(b, a, -dx, -dy, height.of_b);  // frame of a

  const Vec2 r = arm(a, b, offset);
  PairIntegral pair = combine(of_a, of_b, r);
  const double size = std::sqrt(pair.force.x() * pair.force.x() + pair.force.y() * pair.force.y());
  if (size > 0) {
    const double nx = pair.force.x() / size;
    const double ny = pair.force.y() / size;
    Extent extent;
    const auto project = [&](size_t from, size_t to, double shift_n, double shift_t) {
      for (const double* p = pieces.data() + from; p != pieces.data() + to; p += 2) {
        extent.include(nx * p[0] + ny * p[1] + shift_n, nx * p[1] - ny * p[0] + shift_t);
      }
    };
    project(0, middle, 0, 0);
    project(middle, pieces.used(), nx * r.x() + ny * r.y(), nx * r.y() - ny * r.x());
    pair.penetration = extent.n1 - extent.n0;
    pair.breadth = extent.t1 - extent.t0;
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

PairResult edge_method(const Polygon& a, const Potential& potential_a, const Polygon& b,
                       const Potential& potential_b) {
  const PlacedPair placed(a, potential_a, b, potential_b);
  EdgeWorkspace workspace;
  PairResult result;
  PairIntegral& pair = result.integral;
  pair = pair_integral(placed.a.view, placed.b.view, Vec2::Zero(), workspace);
  placed.about_centroids(pair);
  result.volume = pair_volume(placed.a.view, placed.b.view, Vec2::Zero());
  return result;
}

}  // namespace apothem
