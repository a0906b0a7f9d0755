#include "apothem/contact/normal_damping.hpp"

#include <cmath>

namespace apothem {

double damp(double ratio, double k, const Surfaces& surfaces, RigidIndex a, RigidIndex b,
            const PairIntegral& patch, const PairMotion& motion, double dt, PatchDamper& damper) {
  const auto work = [&] {  // over half a step, by the damping force as it is
    return dt / 2 * motion.power(damper.damping, damper.damping_a, damper.damping_b);
  };
  double loss = -work();
  const Vec2 normal = k * patch.force;
  const double moment_a = k * patch.moment_a;
  const double moment_b = k * patch.moment_b;
  const Vec2 rise = normal - damper.normal;
  double rise_a = moment_a - damper.moment_a;
  double rise_b = moment_b - damper.moment_b;
  // The moments before were in balance where the bodies were then. What is left over where they are
  // now goes half and half to both, so that the damping keeps the angular momentum.
  const double rest = cross(motion.between, rise) + (rise_a + rise_b);
  rise_a -= rest / 2;
  rise_b -= rest / 2;
  const PatchDamper before = damper;
  damper = {normal, moment_a, moment_b};
  if (!(dt > 0)) {  // a first look, perhaps with the memory of another run: as springs do, it stays
    damper.damping = before.damping;
    damper.damping_a = before.damping_a;
    damper.damping_b = before.damping_b;
    return loss;
  }

  const double size = normal.norm();
  if (!(size > kNoResultant * k * patch.weight)) return loss;
  const Vec2 n = normal / size;
  const Vec2 point = loading_point(patch);
  const auto mobility = [&](RigidIndex body, const Vec2& arm) {
    const std::array<double, 3>& w = surfaces.rigid(body).inverse_mass;
    const double lever = cross(arm, n);
    return w[0] * n.x() * n.x() + w[1] * n.y() * n.y() + w[2] * lever * lever;
  };
  const PlacedShapes& shapes = surfaces.shapes();
  const double omega2 =
      k * (patch.own_length_a * shapes.slope(b) + patch.own_length_b * shapes.slope(a)) *
      (mobility(a, point) + mobility(b, point + motion.between));
  if (!(omega2 > 0)) return loss;
  double rate = 2 * ratio / std::sqrt(omega2) / dt;
  const double pull = -rise.dot(n);
  if (rate * pull > size) rate = size / pull;  // damping takes the whole force and no more
  damper.damping = rate * rise;
  damper.damping_a = rate * rise_a;
  damper.damping_b = rate * rise_b;
  loss -= work();
  return loss;
}

}  // namespace apothem
