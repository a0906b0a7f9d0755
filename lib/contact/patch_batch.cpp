#include "apothem/contact/patch_batch.hpp"

#include <algorithm>
#include <limits>

#include "apothem/contact/pair_lanes.hpp"
#include "apothem/execution/dispatch.hpp"

namespace apothem {
namespace {

// Error of the sum of a patch's normal forces, in units of eps x size / reference length x own
// length: twice the worst of a million pairs (docs/verification.md).
constexpr double kForceError = 1.2;

const TangentialForce kNoForce;
const PatchDamper kNoDamper;

template <class Real>
APOTHEM_INLINE void read_law(const PatchWork* work, double thickness, PatchStep<Real>& p) {
  bool same = true;
  for (int k = 1; k < lanes_of<Real>; ++k) same = same && work[k].law == work[0].law;
  const auto number = [&](Real& to, const auto& of) APOTHEM_LAMBDA {
    if (same) {
      to = Real(of(*work[0].law));
    } else {
      read_lanes(to, [&](int k) APOTHEM_LAMBDA { return of(*work[k].law); });
    }
  };
  number(p.normal_stiffness,
         [&](const PairLaw& l) APOTHEM_LAMBDA { return l.normal_stiffness * thickness; });
  number(p.tangential_stiffness, [&](const PairLaw& l) APOTHEM_LAMBDA {
    return l.friction.tangential_stiffness * thickness;
  });
  number(p.coefficient, [](const PairLaw& l) APOTHEM_LAMBDA { return l.friction.coefficient; });
  number(p.normal_ratio, [](const PairLaw& l) APOTHEM_LAMBDA { return l.damping.normal; });
  number(p.tangential_ratio, [](const PairLaw& l) APOTHEM_LAMBDA { return l.damping.tangential; });
}

template <class Real>
APOTHEM_INLINE void read_step(const PatchScene& scene, const PatchWork* work, PatchStep<Real>& p,
                              DamperOf<Real>& damper) {
  const Surfaces& surfaces = scene.surfaces;
  const PlacedShapes& shapes = surfaces.shapes();
  FourOf<Real> four;
  const auto integral = [&](int first) APOTHEM_LAMBDA {
    read_rows([&](int k) APOTHEM_LAMBDA { return integral_numbers(*work[k].patch) + first; }, four);
  };
  integral(kForceNumbers);
  p.force = {four[0], four[1]};
  p.moment_a = four[2];
  p.moment_b = four[3];
  integral(kCentreNumbers);
  p.weight = four[0];
  p.centre = {four[2], four[3]};
  integral(kLengthNumbers);
  Real slope_a, slope_b, radii;
  read_lanes(slope_a, [&](int k) APOTHEM_LAMBDA { return shapes.slope(work[k].a); });
  read_lanes(slope_b, [&](int k) APOTHEM_LAMBDA { return shapes.slope(work[k].b); });
  read_lanes(radii, [&](int k) APOTHEM_LAMBDA {
    return shapes.radius(work[k].a) + shapes.radius(work[k].b);
  });
  p.slopes = four[0] * slope_b + four[1] * slope_a;
  p.force_error = Real(kForceError * std::numeric_limits<double>::epsilon()) * radii * p.slopes;
  read_between(surfaces, work, p.between);
  read_rows([&](int k) APOTHEM_LAMBDA { return surfaces.rigid(work[k].a).inverse_mass.data(); },
            four);
  p.inverse_mass_a = {four[0], four[1], four[2]};
  read_rows([&](int k) APOTHEM_LAMBDA { return surfaces.rigid(work[k].b).inverse_mass.data(); },
            four);
  p.inverse_mass_b = {four[0], four[1], four[2]};
  const auto rate = [&](Real& to, const auto& of) APOTHEM_LAMBDA {
    const double* const all = scene.now.pose_rate.data();
    read_lanes(to, [&](int k) APOTHEM_LAMBDA {
      return of(all + 3 * static_cast<size_t>(work[k].a), all + 3 * static_cast<size_t>(work[k].b));
    });
  };
  rate(p.rate.x, [](const double* a, const double* b) APOTHEM_LAMBDA { return a[0] - b[0]; });
  rate(p.rate.y, [](const double* a, const double* b) APOTHEM_LAMBDA { return a[1] - b[1]; });
  rate(p.rate.a, [](const double* a, const double*) APOTHEM_LAMBDA { return a[2]; });
  rate(p.rate.b, [](const double*, const double* b) APOTHEM_LAMBDA { return b[2]; });
  read_lanes(p.rate_before,
             [&](int k) APOTHEM_LAMBDA -> const PairRate& { return work[k].last->rate; });
  read_lanes(p.touched, [&](int k) APOTHEM_LAMBDA { return work[k].touched; });
  read_lanes(p.begins, [&](int k) APOTHEM_LAMBDA { return work[k].begins; });
  read_lanes(p.spring, [&](int k) APOTHEM_LAMBDA { return work[k].spring; });
  read_lanes(damper.elastic,
             [&](int k) APOTHEM_LAMBDA -> const PairForce& { return work[k].damper->elastic; });
  read_lanes(damper.damping,
             [&](int k) APOTHEM_LAMBDA -> const PairForce& { return work[k].damper->damping; });
  read_lanes(damper.tangential, [&](int k) APOTHEM_LAMBDA { return work[k].damper->tangential; });
  read_law(work, scene.thickness, p);
  p.find_direction();
}

}  // namespace

PatchWork::PatchWork(RigidIndex a_, RigidIndex b_, const PairIntegral* patch_, const PairLaw* law_,
                     const TangentialForce* last_, bool begins_, double spring_,
                     const PatchDamper* damper_)
    : a(a_),
      b(b_),
      patch(patch_),
      law(law_),
      last(last_ ? last_ : &kNoForce),
      damper(damper_ ? damper_ : &kNoDamper),
      touched(last_ ? 1 : 0),
      begins(begins_ ? 1 : 0),
      spring(spring_) {}

PatchForces<double> step_one(const PatchScene& scene, const PatchWork& work, bool rough,
                             bool damped, PatchDamper& damper) {
  PatchStep<double> p;
  read_step(scene, &work, p, damper);
  return step_patch(p, rough, damped, scene.dt, scene.now.finite, damper);
}

APOTHEM_INLINE void PatchBatch::step(const PatchScene& scene) {
  using Pack = PackOf<kAtOnce>;
  const PatchWork* const work = work_.data();
  const PatchTarget* const to = targets_.data();
  PatchStep<Pack> p;
  DamperOf<Pack> damper;
  read_step(scene, work, p, damper);
  const PatchForces<Pack> forces =
      step_patch(p, rough_, damped_, scene.dt, scene.now.finite, damper);
  write_lanes(forces.all, [&](int k) APOTHEM_LAMBDA -> PairForce& { return to[k].force->all; });
  if (damped_) {
    TangentialForceOf<Pack> before, now;
    now.damping = forces.damping;
    now.rate = p.rate;
    const auto last = [&](int k) APOTHEM_LAMBDA -> const TangentialForce& { return *work[k].last; };
    read_lanes(before.damping,
               [&](int k) APOTHEM_LAMBDA -> const PairForce& { return last(k).damping; });
    read_lanes(before.change_of_damping,
               [&](int k) APOTHEM_LAMBDA -> const PairForce& { return last(k).change_of_damping; });
    read_lanes(before.power_before, [&](int k) APOTHEM_LAMBDA { return last(k).power_before; });
    before.rate = {
        select(p.touched, p.rate_before.x, p.rate.x), select(p.touched, p.rate_before.y, p.rate.y),
        select(p.touched, p.rate_before.a, p.rate.a), select(p.touched, p.rate_before.b, p.rate.b)};
    const Pack lost = close_damping(before, scene.dt, now);
    write_lanes(now.damping,
                [&](int k) APOTHEM_LAMBDA -> PairForce& { return to[k].force->damping; });
    write_lanes(now.change_of_damping,
                [&](int k) APOTHEM_LAMBDA -> PairForce& { return to[k].force->change_of_damping; });
    write_lanes(now.rate, [&](int k) APOTHEM_LAMBDA -> PairForce& { return to[k].force->rate; });
    write_lanes(damper.elastic,
                [&](int k) APOTHEM_LAMBDA -> PairForce& { return to[k].damper->elastic; });
    write_lanes(damper.damping,
                [&](int k) APOTHEM_LAMBDA -> PairForce& { return to[k].damper->damping; });
    for (int k = 0; k < kAtOnce; ++k) {
      to[k].force->power_before = now.power_before.v[k];
      to[k].damper->tangential = damper.tangential.v[k];
      to[k].book->damping_loss = lost.v[k];
    }
  }
  if (!rough_) return;
  write_held(forces.held_a, [&](int k) APOTHEM_LAMBDA -> BodyStiffness& { return to[k].held->a; });
  write_held(forces.held_b, [&](int k) APOTHEM_LAMBDA -> BodyStiffness& { return to[k].held->b; });
  const Pack energy = forces.spring * forces.spring / (Pack(2.) * p.tangential_stiffness);
  write_rows({forces.spring, p.tangential_stiffness, forces.tangent.x, forces.tangent.y},
             [&](int k) APOTHEM_LAMBDA { return &to[k].spring->force; });
  for (int k = 0; k < kAtOnce; ++k) {
    to[k].book->energy = energy.v[k];
    to[k].book->loss = forces.lost.v[k];
  }
}

void PatchBatch::flush(const PatchScene& scene) {
  if (count_ == 0) return;
  // Lanes that are left over do the last patch again, for nobody.
  const PatchTarget nobody{&spare_.force, &spare_.held, &spare_.spring, &spare_.damper,
                           &spare_.book};
  std::fill(work_.begin() + count_, work_.end(), work_[static_cast<size_t>(count_ - 1)]);
  std::fill(targets_.begin() + count_, targets_.end(), nobody);
  with_widest([&](auto /*lanes*/) APOTHEM_LAMBDA {
    step(scene);
    return 0.;
  });
  count_ = 0;
}

}  // namespace apothem
