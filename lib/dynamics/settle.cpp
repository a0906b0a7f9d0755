// Dynamic relaxation with kinetic damping: explicit steps, and all bodies stop whenever the kinetic
// energy has passed a maximum (Cundall 1982; Barnes 1988). A little drag ends the cycles in which a
// stiff mode can escape this.
#include "lib/dynamics/settle.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lib/dynamics/unstable.hpp"
#include "lib/execution/elementary.hpp"

namespace apothem {
namespace {

constexpr double kDrag = 0.05;       // of the velocity, per step
constexpr double kStep = 0.5;        // of the stability limit
constexpr double kResidual = 1e-12;  // of gravity and contact forces
constexpr double kNoise = 0x1p-47;   // of a position; its contacts answer with their stiffness
constexpr int kCalm = 20;            // so many steps in a row
constexpr std::int64_t kMostSteps = 2'000'000;
constexpr double kSlide = 1;  // s; of the given velocity, saturates every spring

class Relaxation {
 public:
  explicit Relaxation(const SettledStart& start)
      : model_(start.model),
        dofs_(start.dofs),
        state_(start.state),
        lambda_(start.lambda),
        limit_(start.stability_limit),
        given_(start.state.v),
        slip_(given_.size()) {
    std::ranges::fill(state_.v, 0.0);
    for (RigidIndex i = 0; i < state_.layout.rigid_bodies; ++i) {
      if (model_.bodies[i].motion == Motion::free || model_.bodies[i].servo) free_.push_back(i);
      const double* const rate = &given_[state_.layout.rigid(i)];
      const bool moves = rate[0] != 0 || rate[1] != 0 || rate[2] != 0;
      drags_ = drags_ || (moves && model_.bodies[i].motion == Motion::prescribed);
      double& radius = radius_.emplace_back(0);
      for (const Vec2& v : model_.bodies[i].potential.vertices) {
        radius = std::max(radius, v.norm());
      }
    }
  }

  void run(const std::function<void(std::span<const double>, double)>& find_forces,
           const std::function<bool()>& stop) {
    double last = 0;  // kinetic energy of the step before
    int calm = 0;
    for (std::int64_t step = 0; calm < kCalm; ++step) {
      if (step == kMostSteps) refuse();
      if (stop && stop()) throw Stopped();
      const double stiffest = lambda_.empty() ? 0 : *std::ranges::max_element(lambda_);
      const double dt = kStep * std::min(limit_, stiffest > 0 ? 2 / std::sqrt(stiffest) : HUGE_VAL);
      double kinetic = accelerate(dt);
      calm = worst_share_ <= 1 ? calm + 1 : 0;
      if (kinetic < last) {
        std::ranges::fill(state_.v, 0.0);
        kinetic = 0;
      }
      last = kinetic;
      for (const RigidIndex i : free_) state_.pose(i) += dt * state_.pose_rate(i);
      for (size_t k = 0; k < slip_.size(); ++k) {
        slip_[k] = state_.v[k] + given_[k] * (kSlide / dt);
      }
      find_forces(slip_, dt);
    }
    state_.v = given_;
  }

 private:
  // Velocities across the given ones; returns the kinetic energy and finds the largest residual.
  double accelerate(double dt) {
    double kinetic = 0;
    worst_share_ = 0;
    worst_ = -1;
    for (const RigidIndex i : free_) {
      const RigidBody& body = model_.bodies[i];
      const size_t at = state_.layout.rigid(i);
      const Eigen::Vector3d a = residual(i);
      const double off =
          body.mass * hypotenuse(a[0], a[1]) + std::abs(body.inertia * a[2]) / radius_[i];
      const double place = std::abs(state_.x[at]) + std::abs(state_.x[at + 1]) + radius_[i];
      const double own = body.servo
                             ? std::abs(body.servo->force * body.servo->history.at(state_.time))
                             : body.mass * model_.strongest_gravity();
      const double may = kResidual * (own + std::abs(state_.f[at]) + std::abs(state_.f[at + 1])) +
                         kNoise * place * lambda_[i] * body.mass;
      if (!(off <= worst_share_ * may)) {
        worst_share_ = off / may;
        worst_ = i;
      }
      for (size_t k = 0; k < 3; ++k) {
        double& v = state_.v[at + k];
        v += dt * a[static_cast<Eigen::Index>(k)] - kDrag * v;
        kinetic += v * v * (k < 2 ? body.mass : body.inertia);
      }
    }
    return kinetic;
  }

  // Acceleration without the part along the given velocity; of a servo wall that along its
  // direction.
  [[nodiscard]] Eigen::Vector3d residual(RigidIndex i) const {
    const size_t at = state_.layout.rigid(i);
    Eigen::Vector3d a;
    if (model_.bodies[i].servo) {
      const Servo& servo = *model_.bodies[i].servo;
      const double push = servo.excess(state_.time, Vec2(&state_.f[at])) / model_.bodies[i].mass;
      a << push * servo.direction, 0;
      return a;
    }
    for (size_t k = 0; k < 3; ++k) {
      const double gravity = dofs_.acceleration().empty() ? 0 : dofs_.acceleration()[at + k];
      a[static_cast<Eigen::Index>(k)] = dofs_.inverse_mass()[at + k] * state_.f[at + k] + gravity;
    }
    const Vec2 way(given_[at], given_[at + 1]);
    if (way != Vec2::Zero()) {
      const Vec2 u = way.normalized();
      const double along = a[0] * u.x() + a[1] * u.y();
      a[0] -= along * u.x();
      a[1] -= along * u.y();
    }
    if (given_[at + 2] != 0) a[2] = 0;
    return a;
  }

  [[noreturn]] void refuse() const {
    const std::string name = worst_ < 0 ? "" : model_.bodies[worst_].name;
    if (worst_ >= 0 && model_.bodies[worst_].servo) {
      throw Unrunnable(
          fmt::format("the servo wall \"{}\" does not come to rest in {} steps: what it "
                      "presses on does not bear its force; put something in its way, "
                      "let its history begin at 0, or leave out time.start",
                      name, kMostSteps),
          "time/start", -1);
    }
    throw Unrunnable(
        fmt::format(
            "body \"{}\" does not come to rest in {} steps: it falls, slides{} or tips over; "
            "support it,{} or leave out time.start",
            name, kMostSteps, drags_ ? ", is dragged along by a body that moves at time 0," : "",
            drags_ ? " let prescribed velocities begin at 0," : ""),
        "time/start", -1);
  }

  const Model& model_;
  const DegreesOfFreedom& dofs_;
  State& state_;
  const std::vector<double>& lambda_;
  double limit_;
  const std::vector<double> given_;
  std::vector<double> slip_;
  std::vector<RigidIndex> free_;  // and servo walls
  bool drags_ = false;            // a body of prescribed motion moves
  std::vector<double> radius_;    // of each body, m
  double worst_share_ = 0;        // of what the residual force of a body may be
  RigidIndex worst_ = -1;
};

}  // namespace

void settle(const SettledStart& start,
            const std::function<void(std::span<const double>, double)>& find_forces,
            const std::function<bool()>& stop) {
  if (!std::isfinite(start.stability_limit)) {
    throw Unrunnable("nothing can touch anything: no body comes to rest; leave out time.start",
                     "time/start", -1);
  }
  Relaxation(start).run(find_forces, stop);
}

}  // namespace apothem
