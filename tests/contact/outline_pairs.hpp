// Outlines for the tests of deformable contact: a body of one polygonal element per outline.
#pragma once

#include <numeric>
#include <optional>

#include "apothem/contact/deformable_contact.hpp"
#include "support.hpp"

namespace apothem::test {

inline Mesh one_element(const std::vector<Vec2>& ring) {
  Mesh mesh;
  mesh.nodes = ring;
  std::vector<int> corners(ring.size());
  std::iota(corners.begin(), corners.end(), 0);
  mesh.add_element(corners);
  return mesh;
}

inline int add_ring(DeformableContact& contact, const std::vector<Vec2>& ring, int first_node,
                    double reference) {
  const Mesh mesh = one_element(ring);
  return contact.add_deformable(mesh, boundary(mesh), first_node, reference);
}

/// Every edge in `parts` equal ones.
inline std::vector<Vec2> split(const std::vector<Vec2>& ring, int parts) {
  std::vector<Vec2> result;
  for (size_t i = 0; i < ring.size(); ++i) {
    const Vec2 step = (ring[(i + 1) % ring.size()] - ring[i]) / parts;
    for (int k = 0; k < parts; ++k) result.emplace_back(ring[i] + k * step);
  }
  return result;
}

/// Two bodies in contact, evaluated.
struct OutlinePair {
  std::vector<Vec2> a, b;
  double reference_a, reference_b;
  DeformableContact contact;
  std::vector<double> displacement, force;

  OutlinePair(std::vector<Vec2> ring_a, std::vector<Vec2> ring_b, double r_a, double r_b,
              double stiffness = 1)
      : a(std::move(ring_a)),
        b(std::move(ring_b)),
        reference_a(r_a),
        reference_b(r_b),
        contact(stiffness, 1, .05, 1),
        displacement(2 * (a.size() + b.size())),
        force(displacement.size()) {
    add_ring(contact, a, 0, r_a);
    add_ring(contact, b, static_cast<int>(a.size()), r_b);
    evaluate();
  }
  void evaluate() {
    contact.update(displacement, {});
    contact.evaluate();
    std::fill(force.begin(), force.end(), 0.);
    contact.add_forces(force);
  }
  [[nodiscard]] double largest_force() const {
    double largest = 0;
    for (const double f : force) largest = std::max(largest, std::abs(f));
    return largest;
  }
};

/// Outlines with reflex corners, pushed together until they overlap within their collars.
inline std::optional<OutlinePair> random_pair(samples::Random& random, int n, double inner) {
  const auto outline = [&] {
    return inner < 1 ? samples::random_star_shaped(random, n, inner).vertices()
                     : samples::random_convex(random, n).vertices();
  };
  const std::vector<Vec2> a = outline(), b = outline();
  const double r_a = random.uniform(.2, .5), r_b = random.uniform(.2, .5);
  const double angle = random.uniform(0, 2 * M_PI);
  const Vec2 direction(std::cos(angle), std::sin(angle));
  for (double apart = 2.2; apart > 0; apart -= random.uniform(.01, .04)) {
    std::vector<Vec2> moved = b;
    for (Vec2& v : moved) v += apart * direction;
    OutlinePair pair(a, moved, r_a, r_b);
    if (pair.contact.depth().ratio > .95) return {};
    if (pair.contact.depth().ratio > .05) return pair;
  }
  return {};
}

}  // namespace apothem::test
