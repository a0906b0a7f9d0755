// Outlines for the tests of deformable contact: a body of one polygonal element per outline.
#pragma once

#include "geometry/skeleton/skeleton.hpp"
#include "tests/contact/bodies.hpp"

namespace apothem::test {

/// Every edge in `parts` equal ones.
inline std::vector<Vec2> split(const std::vector<Vec2>& ring, int parts) {
  std::vector<Vec2> result;
  for (size_t i = 0; i < ring.size(); ++i) {
    const Vec2 step = (ring[(i + 1) % ring.size()] - ring[i]) / parts;
    for (int k = 0; k < parts; ++k) result.emplace_back(ring[i] + k * step);
  }
  return result;
}

/// Two bodies in contact, evaluated: body 0 has the outline a, body 1 the outline b. Springs of
/// friction have no force yet.
struct OutlinePair : Bodies {
  std::vector<Vec2> a, b;
  double reference_a, reference_b;

  /// `materials`: of both bodies.
  OutlinePair(std::vector<Vec2> ring_a, std::vector<Vec2> ring_b, double r_a, double r_b,
              const ContactLaw& of = law_of(1), const std::array<MaterialIndex, 2>& material = {})
      : Bodies(of, .05),
        a(std::move(ring_a)),
        b(std::move(ring_b)),
        reference_a(r_a),
        reference_b(r_b) {
    add_ring(a, r_a, material[0]);
    add_ring(b, r_b, material[1]);
    join();
    evaluate();
    update_friction(0);
  }
  /// Force on a body and moment about the origin, by its nodes.
  [[nodiscard]] Resultant on(BodyIndex body) const {
    const OutlineSurfaces& o = contacts->surfaces().outlines();
    Resultant sum;
    for (int i = o.bodies[body].first; i < o.bodies[body].end; ++i) {
      const Vec2 force = on_node(o.node[i]);
      sum.force += force;
      sum.moment += cross(o.point(i), force);
    }
    return sum;
  }
  [[nodiscard]] double largest_force() const {
    double largest = 0;
    for (const double f : node_force) largest = std::max(largest, std::abs(f));
    return largest;
  }
};

/// Lowest node of CGAL's skeleton over each edge of a ring, m: up to there the collar is the roof.
inline std::vector<double> first_nodes(const std::vector<Vec2>& ring) {
  const Polygon polygon(ring);
  const Skeleton skeleton = straight_skeleton(polygon);
  std::vector<double> first(ring.size(), HUGE_VAL);
  for (int e = 0; e < polygon.size(); ++e) {
    for (const int node : skeleton.faces[e]) {
      if (node >= polygon.size()) first[e] = std::min(first[e], skeleton.nodes[node].height);
    }
  }
  return first;
}

/// The largest ratio to the depth up to which the collar of a face is the roof; less than 1 where
/// all contact is of this kind. `first`: of both outlines.
inline double roof_ratio(const OutlinePair& pair, const std::vector<double>& first) {
  const OutlineSurfaces& o = pair.contacts->surfaces().outlines();
  double ratio = 0;
  for (const Contact& c : pair.contacts->contacts()) {
    const double depth = c.relative_depth * o.depth[c.b];
    ratio = std::max(ratio, depth / std::min(o.depth[c.b], first[c.b]));
  }
  return ratio;
}

/// Of two outlines; empty if there is no skeleton.
inline std::vector<double> first_nodes(const std::vector<Vec2>& a, const std::vector<Vec2>& b) {
  try {
    std::vector<double> first = first_nodes(a);
    for (const double h : first_nodes(b)) first.push_back(h);
    return first;
  } catch (const SkeletonFailure&) {
    return {};
  }
}
inline double roof_ratio(const OutlinePair& pair) {
  const std::vector<double> first = first_nodes(pair.a, pair.b);
  return first.empty() ? HUGE_VAL : roof_ratio(pair, first);
}

/// Outlines with reflex corners, pushed together until they overlap where their
/// collars are their roofs.
inline std::optional<OutlinePair> random_pair(samples::Random& random, int n, double inner,
                                              const ContactLaw& law = law_of(1),
                                              const std::array<MaterialIndex, 2>& material = {}) {
  const auto outline = [&] {
    return inner < 1 ? samples::random_star_shaped(random, n, inner).vertices()
                     : samples::random_convex(random, n).vertices();
  };
  const std::vector<Vec2> a = outline(), b = outline();
  const double r_a = random.uniform(.2, .5), r_b = random.uniform(.2, .5);
  const std::vector<double> first = first_nodes(a, b);
  if (first.empty()) return {};
  const double angle = random.uniform(0, 2 * M_PI);
  const Vec2 direction(std::cos(angle), std::sin(angle));
  for (double apart = 2.2; apart > 0; apart -= random.uniform(.01, .04)) {
    std::vector<Vec2> moved = b;
    for (Vec2& v : moved) v += apart * direction;
    OutlinePair pair(a, moved, r_a, r_b, law, material);
    const double share = roof_ratio(pair, first);
    if (share > .95) return {};
    if (share > .05) return pair;
  }
  return {};
}

}  // namespace apothem::test
