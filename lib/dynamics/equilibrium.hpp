// Static scenes and settled starts: the equilibrium of all bodies under the loads of one instant.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "lib/dynamics/departure.hpp"
#include "lib/dynamics/quiet_motion.hpp"
#include "lib/dynamics/results.hpp"
#include "lib/dynamics/term.hpp"
#include "lib/model/model.hpp"
#include "lib/solver/linear_solver.hpp"

namespace apothem {

class ContactTerm;
class FrictionMemory;

/// Newton's method, and dynamic relaxation where a term does not know its tangent, or where bodies
/// of finite elements make the method go round in circles. Friction is followed from load step to
/// load step: within one, it is a function of the displacements since its start, so that the way to
/// the equilibrium leaves no trace. Where bodies settle it follows their way.
class Equilibrium {
 public:
  using Terms = std::vector<std::unique_ptr<Term>>;
  /// `contact`: that of the terms; may be null. All must outlive this object.
  Equilibrium(const Model& model, const DegreesOfFreedom& dofs, const Terms& terms,
              ContactTerm* contact, double tolerance);

  /// Moves loads, supports and prescribed bodies to where they are at `time` and finds the
  /// equilibrium there; books the work of loads and supports (trapezoid rule over the load step).
  /// Not complete, with the state as it was, if `stop`, asked after each step of relaxation, says
  /// so: the next call with the same time goes on where it has stopped, bit for bit. Throws
  /// Unstable if there is no equilibrium in reach; the state is then not to be trusted.
  LoadStep find(State& state, Ledger& ledger, double time, const std::function<bool()>& stop);
  /// The same by Newton's method alone, for an equilibrium near that of `state`: no free body
  /// moves farther than prescribed motion does and a part of its inradius. If there is none,
  /// LoadStep::found is false, the state is as it was, and `motion` is the way that the bodies have
  /// begun to go instead: a change of all coordinates.
  LoadStep find_near(State& state, Ledger& ledger, double time, const std::function<bool()>& stop,
                     std::vector<double>& motion);
  /// The equilibrium at the time of `state`, whose velocities tell friction what slides: there it
  /// is at its limit. Throws as above.
  void settle(State& state, const std::function<bool()>& stop);
  /// A step of h (s) in time, from `before` to state.time: finds the places x with
  /// M (x - base) / h^2 = f(x), from those of `state` on; `base` are the places that forces do not
  /// reach. Driven coordinates stay where they are in `state`. Afterwards contacts remember the
  /// friction of these places as a trial. Returns false if it finds none.
  bool step(State& state, const State& before, const std::vector<double>& base, double h);
  /// Out of balance where the forces were found last, N and N m: of what is free, with its weight.
  [[nodiscard]] const std::vector<double>& forces() const { return rest_; }
  /// Of Newton's method in all steps so far.
  [[nodiscard]] std::int64_t iterations() const { return iterations_; }
  [[nodiscard]] const Model& model() const { return model_; }
  /// How exactly coordinates are known.
  [[nodiscard]] const Lengths& lengths() const { return lengths_; }
  /// The loads of the last evaluation have been there before the first load step.
  void begin_loaded() { outside_ = loads(); }

  void fields(Archive& archive);

 private:
  // Where a relaxation was stopped.
  struct Pause {
    double time = 0, until = 0;  // that it had come to, and was on the way to, s
    std::int64_t steps = 0;      // taken so far
    std::vector<double> x, v;    // of the state that was tried
  };
  // How far Newton's method has come in a load step (newton.cpp).
  struct NewtonPath {
    double until = 0;                     // end of the load step, s
    double done = 0;                      // share of the load step that is in equilibrium
    double step = 1;                      // to the share that is sought
    bool damped = false;                  // whether the way is one of implicit steps
    bool growing = false;                 // whether weight grows with the shares
    double shift = 0;                     // 1/h^2 of the present one, 1/s^2
    std::int64_t iteration = 0, all = 0;  // in this share; in this load step
    std::int64_t in_step = 0;             // in this implicit step
    std::int64_t shortened = 0;           // implicit steps that were too long, one after the other
    double residual = 0, at_start = 0;    // before the last iteration; at the start of the step
    double looked_at = 0;                 // some iterations before
    bool in_vain = false;                 // whether it has hardly fallen since
    bool polishing = false;               // whether it goes on from an equilibrium to round-off
    bool setting_out = false;             // whether this is the first implicit step of the share
    std::vector<double> x_done, base, x;  // of the last equilibrium; at the start of the implicit
                                          // step; of the state that is tried
    // Whether the next iteration is the first from where the share began.
    [[nodiscard]] bool sets_out() const { return setting_out && in_step == 0; }
    void fields(Archive& archive);
  };
  static constexpr double kNear = 0.25;  // of a body's inradius: it is still where it was
  enum class Verdict { found, failed, stopped };
  Verdict newton(State& state, const State& before, double time, const std::function<bool()>& stop,
                 LoadStep& result);
  Verdict find_share(State& state, const State& before, double time, NewtonPath& path,
                     const std::function<bool()>& stop, LoadStep& result);
  Verdict finish_polishing(State& state, LoadStep& result, const NewtonPath& path);
  void begin_share(const State& state, NewtonPath& path);
  static void begin_polishing(const State& state, NewtonPath& path);
  void note_residual(double residual, NewtonPath& path) const;
  [[nodiscard]] bool is_stuck(const NewtonPath& path) const;
  [[nodiscard]] bool is_step_found(const State& state, const NewtonPath& path, double now) const;
  [[nodiscard]] double growth_after(const NewtonPath& path) const;
  [[nodiscard]] bool is_sound(const State& state) const;
  bool note_departure(const State& state, const State& before);
  [[nodiscard]] BodyIndex farthest_mover(const State& state, const State& before) const;
  void note_move(const State& state, const State& before, LoadStep& result) const;
  [[nodiscard]] Departure departure_of(BodyIndex body, const State& state,
                                       const State& before) const;
  void note_end(State& state, const State& before, const NewtonPath& path, const LoadStep& result);
  bool stays(const State& state, const State& before, const NewtonPath& path);
  Verdict search(State& state, const State& before, double time, const std::function<bool()>& stop,
                 LoadStep& result);
  [[nodiscard]] bool begins_unpressed(State& state, const State& before);
  void begin_again(State& state, const State& before, const FrictionMemory& friction);
  bool try_forces(State& state);
  bool find_tangent(const State& state);
  bool find_step(State& state, const NewtonPath& path, bool first);
  void put_on_rails();
  bool go(State& state, const NewtonPath& path);
  void keep_slips(const State& state);
  void begin_longer_step(const State& state, NewtonPath& path);
  bool begin_shorter_step(State& state, NewtonPath& path);
  double shifted_residual(const State& state, const NewtonPath& path);
  [[nodiscard]] double rounded_residual(const State& state) const;
  [[nodiscard]] double shortened(const std::vector<double>& step) const;
  [[nodiscard]] double reach(size_t coordinate) const;
  [[nodiscard]] double first_shift() const;
  int negative_pivots(const State& state);
  [[nodiscard]] bool is_round_off(const State& state, const std::vector<double>& step) const;
  [[nodiscard]] double size_of_forces() const;
  void keep(bool complete, LoadStep& result);
  [[nodiscard]] bool strays(const State& state, const std::vector<double>& from) const;
  [[nodiscard]] double driven_way(double from, double until) const;
  void go_back(State& state, const State& before);
  void book(const State& before, const State& state, Ledger& ledger);
  LoadStep solve(State& state, const State& before, double time, const std::function<bool()>& stop);
  LoadStep relax(State& state, const State& before, double time, const std::function<bool()>& stop);
  [[nodiscard]] double ramp(double from, double until) const;
  void find_forces(State& state);
  void push_walls(const State& state);
  void let_slide(const State& state);
  void begin_settling(const State& state);
  void find_slip(const State& state);
  void find_masses(const State& state);
  void raise_masses();
  [[nodiscard]] std::int64_t searches() const;
  void check_shapes(const State& state) const;
  [[nodiscard]] std::vector<double> loads() const;
  [[nodiscard]] std::vector<double> given_forces(const State& state) const;
  [[nodiscard]] bool reached(const State& state, LoadStep& result);
  [[nodiscard]] bool body_balanced(const State& state, DeformableIndex body,
                                   const std::vector<double>& outside, LoadStep& result);
  [[nodiscard]] bool rigid_balanced(const State& state, RigidIndex body, double contact,
                                    LoadStep& result);
  bool note_balance(BodyIndex body, double off, double loads, double residual, double noise,
                    LoadStep& result);
  [[noreturn]] void refuse_diverged(const State& state, const std::string& body) const;
  [[noreturn]] void refuse(const State& state, const LoadStep& result) const;
  [[nodiscard]] std::string advice() const;
  [[noreturn]] void refuse_relaxation(const State& state, const LoadStep& result) const;
  void move(State& state, bool first);
  [[nodiscard]] double speed(size_t coordinate) const;
  [[nodiscard]] bool held(size_t coordinate) const {
    return (!dofs_.can_move(coordinate) && !pushed_[coordinate]) || spins_[coordinate];
  }
  [[nodiscard]] const std::vector<double>& radius() const { return lengths_.radius(); }
  [[nodiscard]] double weight(size_t coordinate) const {
    return dofs_.weight().empty() ? 0 : share_of_weight_ * dofs_.weight()[coordinate];
  }

  const Model& model_;
  const DegreesOfFreedom& dofs_;
  const Terms& terms_;
  ContactTerm* contact_;
  double tolerance_;
  bool settling_ = false;
  bool near_ = false;           // only an equilibrium near the last one is sought
  bool weight_grows_ = false;   // with the shares of a load step, as if it had never acted
  double share_of_weight_ = 1;  // that acts
  double driven_way_ = 0;       // of prescribed motion in this load step, m
  size_t first_;                // coordinate of the nodes
  // A rigid body that moves along one direction: a wall that holds a force, or, in a settled start,
  // a body that slides, across its velocity.
  struct Rail {
    RigidIndex body;
    Vec2 along;
  };
  std::vector<RigidIndex> walls_;     // that hold a force
  std::vector<Rail> rails_;           // of these, then of bodies that slide
  std::vector<std::uint8_t> spins_;   // 1: angles that turn as given, and are not sought
  std::vector<std::uint8_t> pushed_;  // 1: coordinates of their places
  Lengths lengths_;
  NodeStiffness stiffness_;
  std::vector<double> mass_, inverse_;    // scaled; inverse 0 where held
  std::vector<double> rest_, last_;       // forces out of balance, and a step before, N
  std::vector<double> drive_, velocity_;  // what accelerates, N; velocity
  std::vector<double> slips_from_;        // the places from which friction counts
  std::vector<double> displacement_;      // since these
  double span_ = 0;                       // of a step in time, s
  std::vector<double> moved_;             // in it: velocities of all coordinates
  std::vector<double> slip_;     // what counts as displacement in contacts besides; or none
  std::vector<double> outside_;  // loads on nodes at the last equilibrium, N
  std::optional<Pause> pause_;
  Tangent tangent_;
  LinearSolver solver_;
  std::vector<double> step_, moves_, shift_;  // of an iteration; of prescribed motion; added to K
  std::vector<std::uint8_t> free_;
  std::optional<NewtonPath> newton_pause_;
  std::int64_t iterations_ = 0;
  std::vector<double> lambda_;    // of rigid bodies: stiffness / inertia, 1/s^2
  std::vector<double> flat_;      // of rigid bodies: stiffness if they lay flat on each other, N/m
  std::vector<double> inradius_;  // of free bodies; of others 0, m
  double extent_ = 0;             // of the scene, m
  bool after_newton_ = false;     // whether it is relaxed because Newton's method has found nothing
  bool tangent_known_ = true;     // false if a term does not know its tangent
  Departure departure_;           // what the first body does that leaves its place
  BodyIndex departed_ = -1;       // this body
  Departure at_end_;              // where the search has ended: the body that had moved farthest
  double loads_ = 0;              // largest norm in an equilibrium so far, N
  std::vector<double> body_loads_;      // largest sum of sizes in one, of all bodies, N
  double loads_now_ = 0;                // the same with the state that is tried
  std::vector<double> body_loads_now_;  // likewise
  double sum_loads_ = 0, sum_residual_ = 0, sum_noise_ = 0, most_ = 0;  // in a look: see reached
  double kinetic_ = 0;                                                  // at the step before
  std::int64_t searches_ = -1;  // when masses were found last
};

}  // namespace apothem
