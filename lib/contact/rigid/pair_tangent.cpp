#include "lib/contact/rigid/pair_tangent.hpp"

#include <array>

#include "lib/contact/law/patch_laws.hpp"

namespace apothem {
namespace {

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
  p.limit = FrictionLimit<Moving>::of(law);
  p.stiffness_ratio = law.friction.stiffness_ratio;
  p.constant = law.friction.tangential_stiffness * thickness;
  p.find_direction();
  return p;
}

// What `rub` needs besides.
void set_memory(const TriedFriction& friction, PatchStep<Moving>& p) {
  const PairRate& rate = friction.rate;
  const double dt = friction.dt;
  p.rate = {rate.x, rate.y, rate.a, rate.b};
  p.rate.x.d.v[0] = p.rate.y.d.v[1] = p.rate.a.d.v[2] = p.rate.b.d.v[3] = 1 / dt;
  p.force_error = 0;
  if (friction.sticks) p.limit = FrictionLimit<Moving>::infinite();
  p.begins = friction.begins;
  p.push = friction.now.push;
  if (friction.before) {
    const PairForce& f = friction.before->on_bodies;
    p.spring = friction.before->force;
    p.stiffness_before = friction.before->stiffness;
    p.friction_before = {f.x, f.y, f.a, f.b};
    return;
  }
  // The spring before is one that the slip brings to its present force, or beyond the limit.
  const double k = p.tangential_stiffness().v;
  const Moving slip = p.slip(p.rate).dot(p.normal.turned());
  const double limit = p.limit(p.normal_stiffness * p.size, slip).v;
  double force = friction.now.force + k * slip.v * closed_fraction(p, dt).v * dt;
  if (is_sliding(friction.now.force, limit)) force += friction.now.force;
  p.spring = force;
  p.stiffness_before = k;
  p.friction_before = p.force_at_point(p.spring * p.normal.turned());
}

}  // namespace

PairVectorOf<Moving> patch_force(const Surfaces& surfaces, double thickness, const PairLaw& law,
                                 RigidIndex a, RigidIndex b, const MovingIntegral& patch,
                                 const TriedFriction* friction) {
  PatchStep<Moving> p = step_of(surfaces, thickness, law, a, b, patch);
  const Moving& k = p.normal_stiffness;
  const PairVectorOf<Moving> normal{k * p.force.x, k * p.force.y, k * p.moment_a, k * p.moment_b};
  if (!friction || !p.has_direction) return normal;
  set_memory(*friction, p);
  PatchFriction<Moving> rubbed;
  rub(p, friction->dt, rubbed);
  return normal + rubbed.force;
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
