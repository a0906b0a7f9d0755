#include "lib/contact/rigid/pair_tangent.hpp"

#include <array>
#include <cmath>

#include "lib/contact/law/patch_laws.hpp"

namespace apothem {
namespace {

// A spring whose force is this near to Coulomb's limit slides.
constexpr double kAtLimit = 1e-12;

PatchStep<Moving> step_of(const Surfaces& surfaces, double thickness, const PairLaw& law,
                          RigidIndex a, RigidIndex b, const MovingIntegral& patch) {
  PatchStep<Moving> p;
  p.force = {patch.force_x, patch.force_y};
  p.moment_a = patch.moment_a, p.moment_b = patch.moment_b;
  p.weight = patch.weight;
  p.centre = {patch.centre_x, patch.centre_y};
  const Vec2 between = surfaces.between(a, b);
  p.between = {Moving::variable(between.x(), 0), Moving::variable(between.y(), 1)};
  const double slope_a = surfaces.rigid(a).slope, slope_b = surfaces.rigid(b).slope;
  p.slopes = patch.own_length_a * slope_b + patch.own_length_b * slope_a;
  p.growth =
      growth_of<Moving>(patch.breadth, patch.own_length_a, slope_a, patch.own_length_b, slope_b);
  p.normal_stiffness = law.normal_stiffness * thickness;
  p.coefficient = law.friction.coefficient;
  p.stiffness_ratio = law.friction.stiffness_ratio;
  p.constant = law.friction.tangential_stiffness * thickness;
  p.find_direction();
  return p;
}

// The force of a friction spring. The slip is that of the material at the loading point.
Moving friction(const PatchStep<Moving>& p, const TriedSpring& spring) {
  const Spring &now = spring.now, &before = spring.before;
  const Moving limit = friction_limit(p.coefficient, Moving(p.normal_stiffness * p.size));
  if (std::abs(now.force) >= (1 - kAtLimit) * limit.v) return now.force < 0 ? -limit : limit;
  Moving slip(0.);
  const double tx = -p.normal.y.v, ty = p.normal.x.v;
  const double px = p.point.x.v, py = p.point.y.v;
  const double qx = px + p.between.x.v, qy = py + p.between.y.v;
  slip.d.v[0] = tx, slip.d.v[1] = ty;
  slip.d.v[2] = px * ty - py * tx, slip.d.v[3] = -(qx * ty - qy * tx);
  const Moving k = p.tangential_stiffness();
  if (!(k.v > 0)) return now.force;
  // The trial force is kept - k times the slip so far.
  const Moving kept =
      k.v < before.stiffness ? k / Moving(before.stiffness) * before.force : Moving(before.force);
  const double so_far = (kept.v - now.force) / k.v;
  return kept - k * (slip + Moving(so_far));
}

}  // namespace

PairVectorOf<Moving> patch_force(const Surfaces& surfaces, double thickness, const PairLaw& law,
                                 RigidIndex a, RigidIndex b, const MovingIntegral& patch,
                                 const TriedSpring* spring) {
  const PatchStep<Moving> p = step_of(surfaces, thickness, law, a, b, patch);
  const Moving& k = p.normal_stiffness;
  const PairVectorOf<Moving> normal{k * p.force.x, k * p.force.y, k * p.moment_a, k * p.moment_b};
  if (!spring || !p.has_direction) return normal;
  return normal + p.force_at_point(friction(p, *spring) * p.normal.turned());
}

void add_pair_tangent(RigidIndex a, RigidIndex b, const PairVectorOf<Moving>& force,
                      Tangent& tangent) {
  const size_t at_a = 3 * static_cast<size_t>(a), at_b = 3 * static_cast<size_t>(b);
  const std::array<size_t, 6> coordinates{at_a, at_a + 1, at_a + 2, at_b, at_b + 1, at_b + 2};
  const std::array<Moving, 6> on{force.x, force.y, force.a, -force.x, -force.y, force.b};
  for (size_t row = 0; row < 6; ++row) {
    const PackOf<4>& d = on[row].d;
    const std::array<double, 6> by{d.v[0], d.v[1], d.v[2], -d.v[0], -d.v[1], d.v[3]};
    for (size_t column = 0; column < 6; ++column) {
      tangent.add(coordinates[row], coordinates[column], -by[column]);
    }
  }
}

}  // namespace apothem
