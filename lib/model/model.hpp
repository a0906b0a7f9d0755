// The model: everything about a scene that stays fixed while it runs. SI units; coordinates are
// relative to `origin`, so that a scene far from the world's zero loses no digit.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "geometry/potential/potential.hpp"
#include "lib/contact/law/law.hpp"
#include "lib/model/deformable.hpp"
#include "lib/model/population.hpp"

namespace apothem {

struct Material {
  std::string name;
  double density;                ///< kg/m^3
  Elastic elastic = {};          ///< of deformable bodies
  double mass_damping = 0;       ///< Rayleigh's alpha, 1/s
  double stiffness_damping = 0;  ///< Rayleigh's beta, s
};

enum class Motion { free, fixed, prescribed };

/// A rigid body. Its shape is kept in the body frame: relative to the mass centre, at angle 0.
struct RigidBody {
  std::string name;
  MaterialIndex material = 0;
  Potential potential;  ///< body frame
  double area = 0;      ///< m^2
  double mass = 0;      ///< kg, with the model's thickness
  double inertia = 0;   ///< about the mass centre, kg m^2
  double inradius = 0;  ///< m; of a body that is not convex: the largest depth of its field
  Motion motion = Motion::free;
  std::array<bool, 3> held{};    ///< x, y, angle that a free body may not change
  MotionHistory history;         ///< if prescribed
  Rare<Servo> servo;             ///< if prescribed: instead of the history
  Vec2 pivot = Vec2::Zero();     ///< body frame: the point that `history` moves, and turns about
  Vec2 position = Vec2::Zero();  ///< of the mass centre at time 0
  double angle = 0;
  Vec2 velocity = Vec2::Zero();
  double spin = 0;

  [[nodiscard]] bool can_move() const { return motion != Motion::fixed; }
  /// The outer ring, counter-clockwise, and the holes, clockwise, in the body frame, m.
  [[nodiscard]] Rings rings() const { return potential.rings(); }
  /// The largest distance of a vertex from the pivot, m.
  [[nodiscard]] double reach() const;
  /// 1/m, 1/m, 1/I for the degrees of freedom that forces can change, 0 for the others. Contact
  /// forces move a servo wall along its direction; if that is not along an axis, these are bounds.
  [[nodiscard]] std::array<double, 3> inverse_mass() const;
};

/// An acceleration of all bodies: gravity, or that of the ground with the opposite sign.
struct GravityPart {
  Vec2 value = Vec2::Zero();  ///< m/s^2, at factor 1
  LoadHistory history;        ///< of its factor
  /// Of the angle (rad) by which the table that carries the scene has turned counter-clockwise:
  /// gravity turns the other way about the scene. May be empty: 0.
  LoadHistory tilt;

  [[nodiscard]] Vec2 at(double time) const;
};

struct Model {
  std::string name;
  Vec2 origin = Vec2::Zero();   ///< world coordinates = model coordinates + origin
  Vec2 gravity = Vec2::Zero();  ///< m/s^2, at factor 1; where it has parts, that of time 0
  LoadHistory gravity_history;  ///< of its factor
  /// What gravity is the sum of, where its direction changes; else empty.
  std::vector<GravityPart> gravity_parts;
  double thickness = 1;  ///< m
  std::vector<Material> materials;
  ContactLaw contact;
  std::vector<RigidBody> bodies;
  std::vector<DeformableBody> deformables;
  std::vector<Inflow> inflows;
  std::vector<BodyIndex> left;  ///< bodies that have left the world before the start
  World world;
  std::vector<Region> regions;

  // All bodies are numbered rigid ones first.
  [[nodiscard]] const std::string& name_of(BodyIndex body) const;
  [[nodiscard]] MaterialIndex material_of(BodyIndex body) const;

  [[nodiscard]] bool has_gravity() const {
    return gravity != Vec2::Zero() || !gravity_parts.empty();
  }
  /// m/s^2
  [[nodiscard]] Vec2 gravity_at(double time) const;
  /// Of all times, m/s^2; of parts, the sum of their largest sizes.
  [[nodiscard]] double strongest_gravity() const;

  /// Of all deformable bodies.
  [[nodiscard]] int node_count() const;

  /// Contact stiffness of a slice of the model's thickness, N/m per m of boundary.
  [[nodiscard]] double stiffness() const { return contact.normal_stiffness * thickness; }
};

/// Fills shape, mass, inertia and position of a body from a polygon in world coordinates.
/// Throws InvalidPolygon if the contact law cannot take the polygon.
void set_shape(RigidBody& body, const Polygon& polygon, const Model& model);
/// The same with the potential of the polygon in its local coordinates.
void set_shape(RigidBody& body, const Polygon& polygon, Potential potential, const Model& model);

}  // namespace apothem
