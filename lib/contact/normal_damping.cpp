#include "apothem/contact/normal_damping.hpp"

#include <cmath>

namespace apothem {

double damping_time(double ratio, double k, const Surfaces& surfaces, RigidIndex a, RigidIndex b,
                    const Vec2& point, const Vec2& n, const PairMotion& motion) {
  const auto mobility = [&](RigidIndex body, const Vec2& arm) {
    const std::array<double, 3>& w = surfaces.rigid(body).inverse_mass;
    const double lever = cross(arm, n);
    return w[0] * n.x() * n.x() + w[1] * n.y() * n.y() + w[2] * lever * lever;
  };
  const double omega2 = k * (mobility(a, point) + mobility(b, point + motion.between));
  return omega2 > 0 ? 2 * ratio / std::sqrt(omega2) : 0;
}

namespace {

PairForce force_at(const Vec2& point, const PairMotion& motion, const Vec2& force) {
  return {force, cross(point, force), -cross(point + motion.between, force)};
}

}  // namespace

void damp(double ratio, double k, const Surfaces& surfaces, RigidIndex a, RigidIndex b,
          const PairIntegral& patch, const PairMotion& motion, const PairRate* rate_before,
          double dt, PatchDamper& damper) {
  const PairForce elastic{k * patch.force, k * patch.moment_a, k * patch.moment_b};
  PairForce rise = elastic;
  rise += -1 * damper.elastic;
  // The moments before were in balance where the bodies were then. What is left over where they are
  // now goes half and half to both, so that the damping keeps the angular momentum.
  const double rest = cross(motion.between, rise.force) + (rise.moment_a + rise.moment_b);
  rise.moment_a -= rest / 2;
  rise.moment_b -= rest / 2;
  // The pair may touch already with another patch, or have touched in the run before.
  const bool is_new = damper.elastic.force == Vec2(0, 0);
  PairForce before = damper.elastic;
  before += damper.damping;
  damper.elastic = elastic;
  // A first look, perhaps with the memory of another run: as springs do, it keeps its force.
  if (!(dt > 0)) return;
  damper.damping = {};

  const double size = elastic.force.norm();
  if (!(size > kNoResultant * k * patch.weight)) return;
  const Vec2 n = elastic.force / size;
  const Vec2 point = loading_point(patch);
  const PlacedShapes& shapes = surfaces.shapes();
  const double stiffness =
      k * (patch.own_length_a * shapes.slope(b) + patch.own_length_b * shapes.slope(a));
  const double time = damping_time(ratio, stiffness, surfaces, a, b, point, n, motion);
  if (!(time > 0)) return;
  // A patch that is new has risen from nothing since its bodies have met, not in the whole step.
  const double approach = -motion.slip(point).dot(n);
  const double since =
      !is_new || !(approach * dt * stiffness > size) ? dt : size / (stiffness * approach);
  damper.damping = time / since * rise;
  // This is the rate half a step ago. Until now the bodies have been accelerated as before, and by
  // the change of this force, with the damping itself.
  double gained = 0;  // half a step of the acceleration before, m/s
  if (rate_before) {
    PairMotion change = motion;
    change.rate = motion.rate - *rate_before;
    gained = -change.slip(point).dot(n) / 2;
  }
  const double half = ratio * 2 * ratio / time * dt;  // half a step of the damping's own rate
  const double early = damper.damping.force.dot(n);
  const double now =
      (early + time * stiffness * gained - half * (size - before.force.dot(n))) / (1 + half);
  damper.damping += force_at(point, motion, (now - early) * n);
  // The first force acts for the step to come and has to make up for the time since the bodies met,
  // where Verlet gives it half a step.
  if (is_new) damper.damping = (.5 + since / dt) * damper.damping;
  // Damping takes the whole force and no more.
  if (-now > size) damper.damping = size / -now * damper.damping;
}

}  // namespace apothem
