// What changes while a scene runs, and what is recorded of it.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "apothem/fem/stress.hpp"
#include "apothem/geometry/polygon/point.hpp"

namespace apothem {

/// Of rigid bodies the generalised coordinates, three entries per body: x, y, angle of the mass
/// centre.
struct State {
  double time = 0;  ///< s
  std::int64_t step = 0;
  std::vector<double> position;   ///< m, m, rad; relative to the model's origin
  std::vector<double> remainder;  ///< what rounding has kept out of `position` so far
  std::vector<double> velocity;   ///< m/s, m/s, rad/s
  std::vector<double> force;      ///< contact force and moment about the mass centre: N, N, N m
  // Of the nodes of deformable bodies, x and y of each:
  std::vector<double> displacement;   ///< m, from the mesh as given
  std::vector<double> node_velocity;  ///< m/s
  std::vector<double> node_force;     ///< N, of elements, loads and contacts; without gravity
};

/// The energy ledger of the moving bodies and the contacts between them and all others, in J.
/// kinetic + strain + contact + gravity + friction_loss + damping_loss - external_work is constant;
/// total_error is how far it is from its value at time 0.
struct Energies {
  double kinetic = 0;
  double strain = 0;
  double contact = 0;
  double gravity = 0;  ///< zero at time 0
  double friction_loss = 0;
  double damping_loss = 0;
  double external_work = 0;  ///< done by loads, bodies and supports with prescribed motion
  double total_error = 0;
};

/// Momentum of the free bodies (angular about the model's origin) and how far it is from its value
/// at time 0 plus the impulses of gravity and of the bodies that are not free.
struct Momenta {
  double x = 0, y = 0, angular = 0;
  double x_error = 0, y_error = 0, angular_error = 0;
};

/// One connected contact patch of two bodies. Forces are on a.
struct ContactRecord {
  int a, b;            ///< bodies
  Vec2 point;          ///< loading point, relative to the model's origin, m
  Vec2 normal;         ///< elastic normal force, N
  Vec2 tangential;     ///< friction and damping, N
  double penetration;  ///< extent of the overlap along the force, m
  double phi;          ///< largest potential met along the edges
};

/// Contact force on a body, N; `friction` sums the sizes of the friction forces.
struct BodyForce {
  double fx = 0, fy = 0, friction = 0;
};

/// An edge of the boundary of a body in contacts of deformable bodies.
struct SurfaceRecord {
  int body;         ///< rigid ones first
  Vec2 from, to;    ///< relative to the model's origin, m
  double pressure;  ///< mean, Pa
  double traction;  ///< mean of its friction, along the edge, Pa
};

/// A column of a history file: name and unit.
struct Column {
  const char* name;
  const char* unit;
};
inline constexpr std::array kBodyColumns{
    Column{"x", "m"},    Column{"y", "m"},    Column{"angle", "rad"},
    Column{"vx", "m/s"}, Column{"vy", "m/s"}, Column{"spin", "rad/s"},
    Column{"fx", "N"},   Column{"fy", "N"},   Column{"friction", "N"}};
/// Of a point of a deformable body.
inline constexpr std::array kPointColumns{
    Column{"ux", "m"},   Column{"uy", "m"},   Column{"vx", "m/s"},
    Column{"vy", "m/s"}, Column{"sxx", "Pa"}, Column{"syy", "Pa"},
    Column{"sxy", "Pa"}, Column{"s1", "Pa"},  Column{"s2", "Pa"}};
/// Of the contacts of a deformable body.
inline constexpr std::array kSurfaceColumns{Column{"pressure", "Pa"}, Column{"half_width", "m"}};
inline constexpr std::array kEnergyColumns{"kinetic",       "strain",        "contact",
                                           "gravity",       "friction_loss", "damping_loss",
                                           "external_work", "total_error"};
inline constexpr std::array kMomentumColumns{"px",       "py",       "angular",
                                             "px_error", "py_error", "angular_error"};

}  // namespace apothem
