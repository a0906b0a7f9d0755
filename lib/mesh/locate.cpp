#include "lib/mesh/locate.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/polygon/predicates.hpp"
#include "geometry/polygon/segment.hpp"
#include "lib/mesh/measure.hpp"

namespace apothem {
namespace {

constexpr double kOutside = 1e-9;  // times the mesh's size

// Barycentric coordinates of the origin.
std::array<double, 3> barycentric(const Vec2& a, const Vec2& b, const Vec2& c) {
  const std::array<double, 3> areas{cross(b, c), cross(c, a), cross(a, b)};
  const double sum = areas[0] + areas[1] + areas[2];
  return {areas[0] / sum, areas[1] / sum, areas[2] / sum};
}

// The coordinates (u, v) of the origin in the bilinear map of the unit square to the quadrilateral
// a, b, c, d.
std::array<double, 2> inverse_bilinear(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  const Vec2 e = b - a;
  const Vec2 f = d - a;
  const Vec2 g = (a - b) + (c - d);
  // a + u e + v f + u v g = 0; its cross product with e + v g is a quadratic equation for v.
  const double k2 = cross(f, g);
  const double k1 = cross(f, e) + cross(a, g);
  const double k0 = cross(a, e);
  const double root = std::sqrt(std::max(0., k1 * k1 - 4 * k2 * k0));
  // k1 < 0 in a counter-clockwise element, so that this form has no cancellation and includes the
  // linear case k2 = 0.
  double v = 2 * k0 / (-k1 + root);
  const Vec2 h = e + v * g;
  double u = -h.dot(a + v * f) / h.squaredNorm();
  for (int i = 0; i < 2; ++i) {  // Newton's method removes the round-off of the closed form
    const Vec2 miss = a + u * e + v * f + u * v * g;
    const Vec2 by_u = e + v * g;
    const Vec2 by_v = f + u * g;
    const double jacobian = cross(by_u, by_v);
    u -= cross(miss, by_v) / jacobian;
    v -= cross(by_u, miss) / jacobian;
  }
  return {u, v};
}

// Mean-value coordinates of the origin.
void mean_value(std::span<const Vec2> ring, std::span<double> weights) {
  const size_t n = ring.size();
  std::ranges::fill(weights, 0.);
  double sum = 0;
  for (size_t i = 0; i < n; ++i) {
    const size_t j = i + 1 == n ? 0 : i + 1;
    const Vec2& p = ring[i];
    const Vec2& q = ring[j];
    const double p_length = p.norm();
    const double q_length = q.norm();
    const double sine = cross(p, q);
    const double cosine = p.dot(q);
    const bool on_corner = p.isZero(0);
    if (on_corner || (sine == 0 && cosine < 0)) {  // at the corner, or on the edge
      std::ranges::fill(weights, 0.);
      weights[i] = on_corner ? 1 : q_length / (p_length + q_length);
      if (!on_corner) weights[j] = p_length / (p_length + q_length);
      return;
    }
    // Tangent of half the angle between corner i and the next one.
    const double lengths = p_length * q_length;
    const double half_tangent = cosine > 0 ? sine / (lengths + cosine) : (lengths - cosine) / sine;
    weights[i] += half_tangent / p_length;
    weights[j] += half_tangent / q_length;
  }
  for (const double w : weights) sum += w;
  for (double& w : weights) w /= sum;
}

std::vector<Vec2> ring_about(const Mesh& mesh, int element, const Vec2& p) {
  std::vector<Vec2> ring;
  for (const int c : mesh.element(element)) ring.emplace_back(mesh.nodes[c] - p);
  return ring;
}

}  // namespace

void interpolation_weights(std::span<const Vec2> ring, std::span<double> weights) {
  if (ring.size() == 3) {
    const std::array<double, 3> w = barycentric(ring[0], ring[1], ring[2]);
    std::ranges::copy(w, weights.begin());
  } else if (ring.size() == 4 && smallest_turn(ring) > 0) {
    const auto [u, v] = inverse_bilinear(ring[0], ring[1], ring[2], ring[3]);
    weights[0] = (1 - u) * (1 - v);
    weights[1] = u * (1 - v);
    weights[2] = u * v;
    weights[3] = (1 - u) * v;
  } else {
    mean_value(ring, weights);
  }
}

std::vector<double> interpolation_weights(const Mesh& mesh, int element, const Vec2& p) {
  const std::vector<Vec2> ring = ring_about(mesh, element, p);
  std::vector<double> weights(ring.size());
  interpolation_weights(ring, weights);
  return weights;
}

std::optional<MeshPoint> find_point(const Mesh& mesh, const Vec2& p) {
  const double reach = kOutside * mesh_size(mesh);
  int nearest = -1;
  double least = HUGE_VAL;
  for (int e = 0; e < mesh.element_count() && least > 0; ++e) {
    const std::vector<Vec2> ring = mesh.places(mesh.element(e));
    if (apart(box_of(ring).grown(reach), {p.x(), p.y(), p.x(), p.y()})) continue;
    const double distance =
        strictly_inside(ring, p) ? 0 : distance_to_ring(ring_about(mesh, e, p), Vec2::Zero());
    if (distance >= least || distance > reach) continue;
    least = distance;
    nearest = e;
  }
  if (nearest < 0) return std::nullopt;
  return MeshPoint{nearest, interpolation_weights(mesh, nearest, p)};
}

}  // namespace apothem
