// Where a scene that starts settled begins: at rest under its loads, contacts pressed and friction
// springs loaded. Bodies that are given a velocity slide in equilibrium: their friction is at its
// limit against that velocity, and only what it leaves free (the other directions, and the
// rotation) comes to rest.
//
// Dynamic relaxation with kinetic damping: explicit steps, and all bodies stop whenever the kinetic
// energy has passed a maximum (Cundall 1982; Barnes 1988). A little drag ends the cycles in which a
// stiff mode can escape this.

#include <fmt/format.h>

#include <cmath>

#include "apothem/dynamics/simulation.hpp"

namespace apothem {
namespace {

constexpr double kDrag = 0.05;       // of the velocity, per step
constexpr double kStep = 0.5;        // of the stability limit
constexpr double kResidual = 1e-12;  // of gravity and contact forces
constexpr double kNoise = 0x1p-47;   // of a position; its contacts answer with their stiffness
constexpr int kCalm = 20;            // so many steps in a row
constexpr std::int64_t kMostSteps = 2'000'000;
constexpr double kSlide = 1;  // s; of the given velocity, saturates every spring

}  // namespace

void Simulation::settle() {
  const std::vector<double> given = state_.velocity;
  std::fill(state_.velocity.begin(), state_.velocity.end(), 0.0);
  if (!std::isfinite(stability_limit_)) {
    throw Unrunnable("nothing can touch anything: no body finds a rest; leave out time.start",
                     "time/start", -1);
  }
  std::vector<double> slip(given.size());
  double last = 0;  // kinetic energy of the step before
  int calm = 0;
  int worst = -1;
  for (std::int64_t step = 0; calm < kCalm; ++step) {
    if (step == kMostSteps) {
      throw Unrunnable(
          fmt::format("body \"{}\" finds no rest in {} steps: it falls, slides or tips over; "
                      "support it, or leave out time.start",
                      worst < 0 ? "" : name(worst), kMostSteps),
          "time/start", -1);
    }
    const double dt =
        kStep * std::min(stability_limit_,
                         worst_stiffness_ > 0 ? 2 / std::sqrt(worst_stiffness_) : HUGE_VAL);
    // Motion, and residual forces, across the given velocity.
    double kinetic = 0;
    double worst_share = 0;  // of what the residual force may be
    worst = -1;
    for (const int i : moving_) {
      const RigidBody& body = model_.bodies[i];
      if (body.motion != Motion::free) continue;
      const size_t at = 3 * static_cast<size_t>(i);
      std::array<double, 3> a{};
      for (size_t k = 0; k < 3; ++k) {
        a[k] = inverse_mass_[at + k] * state_.force[at + k] + acceleration_[at + k];
      }
      const Vec2 way(given[at], given[at + 1]);
      if (way != Vec2::Zero()) {
        const Vec2 u = way.normalized();
        const double along = a[0] * u.x() + a[1] * u.y();
        a[0] -= along * u.x();
        a[1] -= along * u.y();
      }
      if (given[at + 2] != 0) a[2] = 0;
      const double off =
          body.mass * std::hypot(a[0], a[1]) + std::abs(body.inertia * a[2]) / shapes_.radius(i);
      const double place =
          std::abs(state_.position[at]) + std::abs(state_.position[at + 1]) + shapes_.radius(i);
      const double may = kResidual * (body.mass * model_.gravity.norm() +
                                      std::abs(state_.force[at]) + std::abs(state_.force[at + 1])) +
                         kNoise * place * stiffness_[i] * body.mass;
      if (!(off <= worst_share * may)) {
        worst_share = off / may;
        worst = i;
      }
      for (size_t k = 0; k < 3; ++k) {
        state_.velocity[at + k] += dt * a[k] - kDrag * state_.velocity[at + k];
        kinetic +=
            state_.velocity[at + k] * state_.velocity[at + k] * (k < 2 ? body.mass : body.inertia);
      }
    }
    calm = worst_share <= 1 ? calm + 1 : 0;
    if (kinetic < last) {
      std::fill(state_.velocity.begin(), state_.velocity.end(), 0.0);
      kinetic = 0;
    }
    last = kinetic;
    for (const int i : moving_) {
      if (model_.bodies[i].motion != Motion::free) continue;
      for (size_t k = 3 * static_cast<size_t>(i), end = k + 3; k < end; ++k) {
        state_.position[k] += dt * state_.velocity[k];
      }
    }
    for (size_t k = 0; k < slip.size(); ++k) {
      slip[k] = state_.velocity[k] + given[k] * (kSlide / dt);
    }
    find_forces(false, slip, dt);
  }
  state_.velocity = given;
  if (tangential_) tangential_->start_ledger();
  extremes_ = {};
  counts_ = {};
}

}  // namespace apothem
