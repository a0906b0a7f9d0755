// Bodies put together by hand for the tests of contact: their surfaces, their contact, where they
// are, how they move, and the forces on them.
#pragma once

#include <array>
#include <catch2/catch.hpp>
#include <deque>
#include <memory>
#include <numeric>
#include <optional>
#include <vector>

#include "lib/contact/contacts.hpp"
#include "lib/mesh/mesh.hpp"
#include "tests/support.hpp"

namespace apothem::test {

/// A mesh of one polygonal element.
inline Mesh one_element(const std::vector<Vec2>& ring) {
  Mesh mesh;
  mesh.nodes = ring;
  std::vector<int> corners(ring.size());
  std::iota(corners.begin(), corners.end(), 0);
  mesh.add_element(corners);
  return mesh;
}

/// The potential of a polygon about its mass centre.
inline Potential about_centre(const Polygon& polygon, const PotentialChoice& choice = {}) {
  return translated(make_potential(polygon, choice), area_moments(polygon).centroid);
}
/// The potential of a polygon about the origin of its coordinates, with its very vertices.
inline Potential about_origin(const Polygon& polygon, const PotentialChoice& choice = {}) {
  Potential potential = translated(make_potential(polygon, choice), -polygon.origin());
  potential.vertices = polygon.vertices();
  return potential;
}

/// A contact law with no more than a stiffness.
inline ContactLaw law_of(double stiffness, const Friction& friction = {}) {
  ContactLaw law;
  law.normal_stiffness = stiffness;
  law.friction = friction;
  return law;
}
inline ContactLaw element_law(double stiffness, ForceDistribution distribution,
                              const Friction& friction = {}) {
  ContactLaw law = law_of(stiffness, friction);
  law.surface = ContactSurface::element;
  law.distribution = distribution;
  return law;
}

struct Bodies {
  ContactLaw law;
  double thickness;
  int threads;
  std::vector<MaterialIndex> materials;  ///< of each body
  std::deque<Potential> potentials;
  std::optional<Surfaces> surfaces;  ///< until they are joined
  std::unique_ptr<Contacts> contacts;
  int nodes = 0;
  bool placed = false;
  std::vector<double> pose, displacement, pose_rate, node_velocity;
  std::vector<double> rigid_force, node_force, lambda;  ///< of the last call of find_forces

  explicit Bodies(const ContactLaw& of, double skin = .1, double depth = 1, int workers = 1)
      : law(of),
        thickness(depth),
        threads(workers),
        surfaces(std::in_place, skin, skin, of.surface == ContactSurface::body) {}

  /// Rigid bodies come first. Without inverse masses forces do not move the body.
  BodyIndex add_rigid(const Potential& potential, const std::array<double, 3>& place = {},
                      const std::array<double, 3>& inverse_mass = {}, MaterialIndex material = 0) {
    potentials.push_back(potential);
    surfaces->add_polygon(
        potentials.back(),
        {.inverse_mass = inverse_mass, .inradius = 1 / potential.steepest, .moves = true});
    pose.insert(pose.end(), place.begin(), place.end());
    return add(material);
  }
  /// A polygon in world coordinates.
  BodyIndex add_polygon(const Polygon& polygon, const std::array<double, 3>& inverse_mass = {}) {
    const Vec2 centre = samples::world_centroid(polygon);
    return add_rigid(about_centre(polygon), {centre.x(), centre.y(), 0}, inverse_mass);
  }
  /// With outlines or elements, as the law says. `unused` nodes come before those of the mesh.
  BodyIndex add_mesh(const Mesh& mesh, std::optional<double> reference = {},
                     MaterialIndex material = 0, int unused = 0) {
    nodes += unused;
    if (law.surface == ContactSurface::body) {
      surfaces->add_outline(mesh, nodes, reference);
    } else {
      surfaces->add_elements(mesh, nodes, law.potential);
    }
    nodes += static_cast<int>(mesh.nodes.size());
    return add(material);
  }
  BodyIndex add_ring(const std::vector<Vec2>& ring, double reference, MaterialIndex material = 0) {
    return add_mesh(one_element(ring), reference, material);
  }

  /// Closes the list of bodies; all nodes are where the meshes have them, and nothing moves.
  void join() {
    int count = 0;
    for (const MaterialIndex m : materials) count = std::max(count, m + 1);
    contacts = std::make_unique<Contacts>(law, thickness, std::move(*surfaces),
                                          PairTable(law, materials, count), threads);
    surfaces.reset();
    displacement.resize(2 * static_cast<size_t>(nodes));
    node_velocity.resize(displacement.size());
    pose_rate.resize(pose.size());
  }

  [[nodiscard]] Kinematics kinematics() const {
    return {pose, displacement, pose_rate, node_velocity};
  }
  /// Surfaces to where the bodies are, with a search where it is needed.
  void place() {
    if (placed) {
      contacts->place(kinematics());
    } else {
      contacts->place_all(kinematics());
    }
    placed = true;
    contacts->search_if_stale();
  }
  void evaluate() {
    place();
    contacts->evaluate();
  }
  /// Needs a call of update_friction() since the last evaluation if there is friction.
  void find_forces() {
    rigid_force.assign(pose.size(), 0);
    node_force.assign(displacement.size(), 0);
    lambda.assign(pose.size() / 3, 0);
    contacts->add_forces({rigid_force, node_force, lambda});
  }
  void update_friction(double dt) {
    contacts->update_friction(kinematics(), dt);
    find_forces();
    if (contacts->damped() && dt > 0) add_dashpots(dt);
  }
  /// All inertias are 1.
  void add_dashpots(double dt) {
    const auto both = [](std::vector<double> all, const std::vector<double>& of_nodes) {
      all.insert(all.end(), of_nodes.begin(), of_nodes.end());
      return all;
    };
    const std::vector<double> velocity = both(pose_rate, node_velocity);
    const std::vector<double> force = both(rigid_force, node_force), weight;
    const std::vector<double> inverse_mass(velocity.size(), 1);
    std::vector<double> whole = force;
    contacts->add_dashpots(kinematics(), {inverse_mass, velocity, force, force, weight}, dt, false,
                           whole);
    std::copy_n(whole.begin(), rigid_force.size(), rigid_force.begin());
    std::copy(whole.begin() + std::ssize(rigid_force), whole.end(), node_force.begin());
  }

  /// On a rigid body; the moment is about its mass centre.
  [[nodiscard]] Resultant on_rigid(RigidIndex i) const {
    const double* f = &rigid_force[3 * static_cast<size_t>(i)];
    return {{f[0], f[1]}, f[2]};
  }
  [[nodiscard]] Vec2 on_node(NodeIndex n) const {
    return {node_force[2 * static_cast<size_t>(n)], node_force[2 * static_cast<size_t>(n) + 1]};
  }

 private:
  BodyIndex add(MaterialIndex material) {
    materials.push_back(material);
    return static_cast<BodyIndex>(materials.size()) - 1;
  }
};

/// The largest relative depth of all contacts; a potential ends at 1.
inline double largest_relative_depth(const Contacts& contacts) {
  double largest = 0;
  for (const Contact& c : contacts.contacts()) largest = std::max(largest, c.relative_depth);
  return largest;
}

/// The largest penetration of a pair of bodies, m.
inline double largest_penetration(const Contacts& contacts) {
  const std::vector<double> ones(static_cast<size_t>(contacts.surfaces().body_count()), 1.);
  const Penetrations found = contacts.penetrations(ones);
  CHECK(found.relative.value == found.largest.value);
  return found.largest.value;
}

/// The part of a contact's normal or tangential forces that acts on a body.
inline Vec2 on_body(const std::vector<ContactRecord>& records, BodyIndex body,
                    Vec2 ContactRecord::*part) {
  Vec2 sum = Vec2::Zero();
  for (const ContactRecord& r : records) {
    if (r.a == body) sum += r.*part;
    if (r.b == body) sum -= r.*part;
  }
  return sum;
}

/// The sizes of the forces of all springs, N.
inline double spring_sum(const Contacts& contacts) {
  double sum = 0;
  for (const Spring& s : contacts.springs()) sum += std::abs(s.force);
  return sum;
}

}  // namespace apothem::test
