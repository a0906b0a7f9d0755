// What the equations of motion are written in: the coordinates of rigid bodies and nodes, which of
// them forces can move, and how they move in a step.
//
// Velocity Verlet in kick-drift-kick form (Eqs. 16-20): symplectic, so energy oscillates with order
// dt^2 and does not drift, and momenta are kept to round-off.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "lib/execution/parallel.hpp"
#include "lib/model/model.hpp"
#include "lib/model/state.hpp"

namespace apothem {

/// Momentum, or the time integral of a force: N s, and N m s about the model's origin.
struct Impulse {
  double x = 0, y = 0, angular = 0;
  void add(const Impulse& other) { x += other.x, y += other.y, angular += other.angular; }
  void fields(Archive& archive) { archive("x", x)("y", y)("angular", angular); }
};

class DegreesOfFreedom {
 public:
  /// `node_mass` in kg.
  DegreesOfFreedom(const Model& model, std::span<const double> node_mass, int threads = 1);

  /// Where all bodies are, and how they move, at time 0.
  [[nodiscard]] State start() const;

  /// v += h (f/m + g).
  void kick(State& state, double h) const;
  /// Gives coordinates with prescribed motion the velocity that leads them to where they are at
  /// `state.time`, dt later.
  void steer(State& state, double dt);
  /// x += dt v.
  void drift(State& state, double dt) const;
  /// Gives coordinates with prescribed motion their velocity at `state.time`.
  void follow(State& state) const;
  /// Puts coordinates with prescribed motion where they are at `state.time`.
  void place_driven(State& state) const;

  /// A coordinate with prescribed motion.
  struct Driven {
    size_t coordinate;
    int axis;  ///< of the motion: x, y, angle
    const MotionHistory* motion;
    double start;                  ///< at time 0
    Vec2 arm;                      ///< of its point from the pivot of the motion, at time 0
    const Servo* servo = nullptr;  ///< that moves it instead
    double move = 0;               ///< in this step

    [[nodiscard]] double displacement(double time) const {
      return motion->displacement(time, arm)[static_cast<size_t>(axis)];
    }
    [[nodiscard]] double rate(double time) const {
      return motion->rate(time, arm)[static_cast<size_t>(axis)];
    }
  };
  [[nodiscard]] const std::vector<Driven>& driven() const { return driven_; }
  /// Sets the moves of a whole load step, from state.time until `time`.
  void plan_moves(const State& state, double time);

  /// Bodies that are absent (see State) cannot move and weigh nothing.
  void set_absent(const std::vector<std::uint8_t>& absent);

  [[nodiscard]] const Layout& layout() const { return layout_; }
  /// Rigid bodies with a nonzero entry stay where they are in `state`, as if they were held there,
  /// and weigh nothing. Their energy in gravity counts. Gravity must be that of the model.
  void set_resting(const std::vector<std::uint8_t>& resting, const State& state);

  /// The coordinates of a body: the first one, and one behind the last.
  [[nodiscard]] std::pair<size_t, size_t> coordinates(BodyIndex body) const;
  /// 1/kg and 1/(kg m^2); 0 where forces cannot move the coordinate.
  [[nodiscard]] const std::vector<double>& inverse_mass() const { return inverse_mass_; }
  [[nodiscard]] bool can_move(size_t coordinate) const { return inverse_mass_[coordinate] > 0; }
  /// The same of bodies that are absent as if they were there.
  [[nodiscard]] bool is_held(size_t coordinate) const {
    return !((given_inverse_mass_.empty() ? inverse_mass_ : given_inverse_mass_)[coordinate] > 0);
  }
  /// kg and kg m^2 of every coordinate.
  [[nodiscard]] double mass(size_t coordinate) const { return mass_[coordinate]; }
  /// Gravity becomes `factor` times that of the model.
  void scale_gravity(double factor);
  /// Gravity becomes `value` (m/s^2); not for models whose gravity is scaled.
  void set_gravity(const Vec2& value);
  /// Sum of mass times displacement since time 0 of what gravity moves, kg m.
  [[nodiscard]] Vec2 mass_moved(const State& state) const;
  /// Of gravity on coordinates that can move, m/s^2; empty without gravity.
  [[nodiscard]] const std::vector<double>& acceleration() const { return acceleration_; }
  /// The same as forces, N; empty without gravity.
  [[nodiscard]] const std::vector<double>& weight() const { return weight_; }
  /// Adds the impulses that what holds a coordinate takes from the forces on it over h (s).
  void add_reactions(const State& state, double h, Impulse& sum) const;
  /// Of each node, kg; 0 where both coordinates are held.
  [[nodiscard]] std::vector<double> free_node_mass() const;

  /// Kinetic energy of what forces can move, J.
  [[nodiscard]] double kinetic(const State& state) const;
  /// Potential energy in gravity as it is now, zero where the bodies were at time 0, J.
  [[nodiscard]] double gravity_energy(const State& state) const {
    return gravity_factor_ * full_gravity_energy(state);
  }
  /// The same in the gravity of the model, at factor 1.
  [[nodiscard]] double full_gravity_energy(const State& state) const;
  [[nodiscard]] Impulse momentum(const State& state) const;
  /// Of an impulse J on one coordinate (N s, or N m s).
  [[nodiscard]] Impulse impulse(const State& state, size_t coordinate, double j) const;
  /// What bodies lose that are slowed down.
  struct Braked {
    double energy = 0;  ///< J
    Impulse impulse;    ///< on them
  };
  /// Leaves the part `rest` of the velocities of the coordinates from `first` to `end` that forces
  /// can change. They are whole rigid bodies or whole nodes.
  Braked brake(State& state, size_t first, size_t end, double rest) const;
  /// Force and torque of gravity on what it moves, N and N m.
  [[nodiscard]] Impulse weight_sum(const State& state) const;

 private:
  void add_rigid(const RigidBody& body);
  void add_nodes(const DeformableBody& body, std::span<const double> mass);
  void add_supports(const DeformableBody& body);

  const Model& model_;
  Threads threads_;
  Layout layout_;
  std::vector<double> inverse_mass_, mass_, acceleration_, weight_;
  std::vector<double> start_;  // x, y, angle of rigid bodies; places of nodes in the mesh as given
  std::vector<double> displaced_;  // displacements of nodes at time 0, in their places; or empty
  /// A coordinate that forces cannot move.
  struct Held {
    size_t coordinate, across;  // itself, and the other one of its point
    double start;               // of the other one, m; 0 for rigid bodies, whose x is the place
  };
  std::array<std::vector<Held>, 3> held_;  // along x, along y, angles
  std::vector<Driven> driven_;
  Impulse weight_at_start_;  // of gravity; its torque of nodes only, in the meshes as given
  double gravity_factor_ = 1;
  /// At factor 1; empty while gravity has never been scaled.
  std::vector<double> full_acceleration_, full_weight_;
  Impulse full_weight_at_start_;
  /// Of all bodies, at factor 1; empty while none has been taken out.
  std::vector<double> given_inverse_mass_, given_acceleration_;
  std::vector<std::uint8_t> absent_, resting_;  // of each body; empty, or shorter: 0
  std::vector<std::uint8_t> out_;               // whether it is one of these
  std::array<size_t, 3> held_at_start_{};       // how many of `held_` do not rest
  double resting_energy_ = 0;                   // in gravity, J

  void take_out();
  void set_present(BodyIndex body, bool present);
  void push_servo(const Servo& servo, State& state, size_t first, double dt) const;
  [[nodiscard]] Impulse weight_at_start(const std::vector<double>& weight) const;
};

}  // namespace apothem
