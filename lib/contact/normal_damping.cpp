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

void damp(double ratio, double k, const Surfaces& surfaces, RigidIndex a, RigidIndex b,
          const PairIntegral& patch, const PairMotion& motion, double dt, PatchDamper& damper) {
  const PairForce elastic{k * patch.force, k * patch.moment_a, k * patch.moment_b};
  PairForce rise = elastic;
  rise += -1 * damper.elastic;
  // The moments before were in balance where the bodies were then. What is left over where they are
  // now goes half and half to both, so that the damping keeps the angular momentum.
  const double rest = cross(motion.between, rise.force) + (rise.moment_a + rise.moment_b);
  rise.moment_a -= rest / 2;
  rise.moment_b -= rest / 2;
  damper.elastic = elastic;
  // A first look, perhaps with the memory of another run: as springs do, it keeps its force.
  if (!(dt > 0)) return;
  damper.damping = {};

  const double size = elastic.force.norm();
  if (!(size > kNoResultant * k * patch.weight)) return;
  const Vec2 n = elastic.force / size;
  const PlacedShapes& shapes = surfaces.shapes();
  const double stiffness =
      k * (patch.own_length_a * shapes.slope(b) + patch.own_length_b * shapes.slope(a));
  double rate =
      damping_time(ratio, stiffness, surfaces, a, b, loading_point(patch), n, motion) / dt;
  const double pull = -rise.force.dot(n);
  if (rate * pull > size) rate = size / pull;  // damping takes the whole force and no more
  damper.damping = rate * rise;
}

}  // namespace apothem
