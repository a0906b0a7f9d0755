#include "lib/contact/rigid/pair_batch.hpp"

#include <algorithm>
#include <limits>

#include "lib/execution/dispatch.hpp"

namespace apothem {
namespace {

// Error of the sum of a patch's normal forces, in units of eps x size / reference length x own
// length: twice the worst of a million pairs (docs/verification.md).
constexpr double kForceError = 1.2;

// A number of each lane; a plain number is that of the first one.
template <class F>
APOTHEM_INLINE void read_lanes(double& number, const F& of) {
  number = of(0);
}
template <int lanes, class F>
APOTHEM_INLINE void read_lanes(PackOf<lanes>& pack, const F& of) {
  pack = pack_of<lanes>(of);
}
// A truth value of each lane, from 1 or 0.
template <class F>
APOTHEM_INLINE void read_lanes(bool& truth, const F& of) {
  truth = of(0) > 0;
}
template <int lanes, class F>
APOTHEM_INLINE void read_lanes(MaskOf<lanes>& mask, const F& of) {
  PackOf<lanes> number;
  read_lanes(number, of);
  mask = number > PackOf<lanes>(0.);
}

// The mass centre of a minus that of b; `lanes` have these numbers.
template <class Real, class Lane>
APOTHEM_INLINE void read_between(const Surfaces& surfaces, const Lane* lanes,
                                 VectorOf<Real>& between) {
  read_lanes(between.x, [&](int k) APOTHEM_LAMBDA {
    return surfaces.pose(lanes[k].a)[0] - surfaces.pose(lanes[k].b)[0];
  });
  read_lanes(between.y, [&](int k) APOTHEM_LAMBDA {
    return surfaces.pose(lanes[k].a)[1] - surfaces.pose(lanes[k].b)[1];
  });
}

template <class Real>
APOTHEM_INLINE void read_law(const PairWork* work, double thickness, PatchStep<Real>& p) {
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

// The integrals of a pair and where its bodies are, which its load needs.
template <class Real>
APOTHEM_INLINE void read_pair(const PairScene& scene, const PairWork* work, PatchStep<Real>& p) {
  const Surfaces& surfaces = scene.surfaces;
  FourOf<Real> four;
  const auto integral = [&](int first) APOTHEM_LAMBDA {
    read_rows([&](int k) APOTHEM_LAMBDA { return integral_numbers(*work[k].integral) + first; },
              four);
  };
  integral(kForceNumbers);
  p.force = {four[0], four[1]};
  p.moment_a = four[2];
  p.moment_b = four[3];
  integral(kCentreNumbers);
  p.weight = four[0];
  p.centre = {four[2], four[3]};
  integral(kLengthNumbers);
  const Real length_a = four[0], length_b = four[1];
  // Inverse masses and slope.
  read_rows([&](int k) APOTHEM_LAMBDA { return surfaces.rigid(work[k].a).inverse_mass.data(); },
            four);
  p.inverse_mass_a = {four[0], four[1], four[2]};
  const Real slope_a = four[3];
  read_rows([&](int k) APOTHEM_LAMBDA { return surfaces.rigid(work[k].b).inverse_mass.data(); },
            four);
  p.inverse_mass_b = {four[0], four[1], four[2]};
  p.slopes = length_a * four[3] + length_b * slope_a;
  read_between(surfaces, work, p.between);
  read_law(work, scene.thickness, p);
  p.find_direction();
}

template <class Real>
APOTHEM_INLINE void read_memory(const PairScene& scene, const PairWork* work, bool damped,
                                PatchStep<Real>& p, DamperOf<Real>& damper) {
  Real radii;
  read_lanes(radii, [&](int k) APOTHEM_LAMBDA {
    return scene.surfaces.rigid(work[k].a).radius + scene.surfaces.rigid(work[k].b).radius;
  });
  p.force_error = Real(kForceError * std::numeric_limits<double>::epsilon()) * radii * p.slopes;
  const auto rate = [&](Real& to, const auto& of) APOTHEM_LAMBDA {
    const double* const all = scene.now->pose_rate.data();
    read_lanes(to, [&](int k) APOTHEM_LAMBDA {
      return of(all + 3 * static_cast<size_t>(work[k].a), all + 3 * static_cast<size_t>(work[k].b));
    });
  };
  rate(p.rate.x, [](const double* a, const double* b) APOTHEM_LAMBDA { return a[0] - b[0]; });
  rate(p.rate.y, [](const double* a, const double* b) APOTHEM_LAMBDA { return a[1] - b[1]; });
  rate(p.rate.a, [](const double* a, const double*) APOTHEM_LAMBDA { return a[2]; });
  rate(p.rate.b, [](const double*, const double* b) APOTHEM_LAMBDA { return b[2]; });
  read_lanes(p.begins, [&](int k) APOTHEM_LAMBDA { return work[k].memory->patches > 0 ? 0. : 1.; });
  read_lanes(p.spring, [&](int k) APOTHEM_LAMBDA { return work[k].memory->spring; });
  gather(p.friction_before,
         [&](int k) APOTHEM_LAMBDA -> const PairForce& { return work[k].memory->force; });
  if (!damped) {  // what only dampers need
    p.rate_before = {};
    p.touched = Real(0.) > Real(0.);
    damper = {};
    return;
  }
  const auto last = [&](int k) APOTHEM_LAMBDA -> const DampingMemory& { return *work[k].damping; };
  gather(p.rate_before, [&](int k) APOTHEM_LAMBDA -> const PairRate& { return last(k).pair.rate; });
  read_lanes(p.touched, [&](int k) APOTHEM_LAMBDA { return work[k].memory->touched() ? 1. : 0.; });
  gather(damper, [&](int k) APOTHEM_LAMBDA -> const PatchDamper& { return last(k).patch; });
  PairVectorOf<Real> damping_before;
  gather(damping_before,
         [&](int k) APOTHEM_LAMBDA -> const PairForce& { return last(k).pair.damping; });
  p.friction_before = p.friction_before - damping_before;
}

template <class Real>
APOTHEM_INLINE void hold(const PairWork* work, const PatchStep<Real>& p, BodyStiffnessOf<Real>& a,
                         BodyStiffnessOf<Real>& b) {
  FourOf<Real> four;
  read_rows([&](int k)
                APOTHEM_LAMBDA { return integral_numbers(*work[k].integral) + kBreadthNumbers; },
            four);
  const ContactStrip<Real> strip{four[0], four[1]};
  strip.hold(p, a, b);
}

// Force and moments of a pair, with those beside the normal force.
template <class Real>
APOTHEM_INLINE PairVectorOf<Real> whole_force(const PatchStep<Real>& p,
                                              const PairVectorOf<Real>& beside) {
  const Real& k = p.normal_stiffness;
  return PairVectorOf<Real>{k * p.force.x, k * p.force.y, k * p.moment_a, k * p.moment_b} + beside;
}

// The numbers of a load stand in a row.
static_assert(offsetof(BodyLoad, held) == 3 * sizeof(double) &&
              sizeof(BodyLoad) == 12 * sizeof(double));
template <int lanes, class F>
APOTHEM_INLINE void write_load(const PackOf<lanes>& x, const PackOf<lanes>& y,
                               const PackOf<lanes>& moment,
                               const BodyStiffnessOf<PackOf<lanes>>& held,
                               const std::array<PackOf<lanes>, 3>& beside, const F& to) {
  write_rows({x, y, moment, held.xx}, [&](int k) APOTHEM_LAMBDA { return &to(k).x; });
  write_rows({held.xy, held.yy, held.xt, held.yt},
             [&](int k) APOTHEM_LAMBDA { return &to(k).held.xy; });
  write_rows({held.tt, beside[0], beside[1], beside[2]},
             [&](int k) APOTHEM_LAMBDA { return &to(k).held.tt; });
}

}  // namespace

void find_patch_forces(const PairScene& scene, std::span<const PairWork> work, Tangential kind,
                       PatchDamper* dampers, PatchForces<double>* forces) {
  using Pack = PackOf<kComparedLanes>;
  std::array<PairWork, kComparedLanes> all;
  std::array<PatchDamper, kComparedLanes> damper_of;
  std::array<PatchForces<double>, kComparedLanes> forces_of;
  std::ranges::copy(work, all.begin());
  std::fill(all.begin() + std::ssize(work), all.end(), work.back());  // for nobody
  with_widest([&](auto /*lanes*/) APOTHEM_LAMBDA {
    PatchStep<Pack> p;
    PatchForces<Pack> found;
    DamperOf<Pack> damper;
    read_pair(scene, all.data(), p);
    read_memory(scene, all.data(), kind.damped, p, damper);
    // What the spring of one patch of several did before is not known: it may have been elsewhere.
    p.friction_before = p.force_at_point(p.spring * p.normal.turned());
    step_patch(p, kind.rough, kind.damped, scene.dt, damper, found);
    scatter(found, [&](int k) APOTHEM_LAMBDA -> PatchForces<double>& { return forces_of[k]; });
    scatter(damper, [&](int k) APOTHEM_LAMBDA -> PatchDamper& { return damper_of[k]; });
    return 0.;
  });
  std::copy_n(damper_of.begin(), work.size(), dampers);
  std::copy_n(forces_of.begin(), work.size(), forces);
}

void load_pair(const PairScene& scene, const PairWork& work, const PairForce& beside,
               const BodyStiffness& held_a, const BodyStiffness& held_b) {
  PatchStep<double> p;
  read_pair(scene, &work, p);
  BodyStiffness a = held_a, b = held_b;
  hold(&work, p, a, b);
  const PairForce f = whole_force(p, beside);
  *work.load = {{f.x, f.y, f.a, a, {beside.x, beside.y, beside.a}},
                {-f.x, -f.y, f.b, b, {-beside.x, -beside.y, beside.b}},
                p.normal_stiffness * p.size,
                work.a,
                work.b};
}

APOTHEM_INLINE void PairBatch::step(const PairScene& scene) {
  using Pack = PackOf<kAtOnce>;
  const PairWork* const work = work_.data();
  PatchStep<Pack> p;
  read_pair(scene, work, p);
  PatchForces<Pack> forces;
  if (kind_.any()) {
    DamperOf<Pack> damper;
    read_memory(scene, work, kind_.damped, p, damper);
    step_patch(p, kind_.rough, kind_.damped, scene.dt, damper, forces);
    const auto memory = [&](int k) APOTHEM_LAMBDA -> PairMemory& { return *work[k].memory; };
    scatter(forces.all, [&](int k) APOTHEM_LAMBDA -> PairForce& { return memory(k).force; });
    if (kind_.damped) {
      const auto damping = [&](int k) APOTHEM_LAMBDA -> DampingMemory& { return *work[k].damping; };
      const auto pair = [&](int k) APOTHEM_LAMBDA -> PairDamping& { return damping(k).pair; };
      PairVectorOf<Pack> before;
      gather(before, [&](int k) APOTHEM_LAMBDA -> const PairForce& { return pair(k).damping; });
      const Pack lost = Pack(-scene.dt / 2) * (forces.damping + before).power(p.rate);
      const PairDampingOf<Pack> now{forces.damping, p.rate};
      scatter(now, [&](int k) APOTHEM_LAMBDA -> PairDamping& { return pair(k); });
      scatter(damper, [&](int k) APOTHEM_LAMBDA -> PatchDamper& { return damping(k).patch; });
      for (int k = 0; k < kAtOnce; ++k) work[k].book->damping_loss = lost.v[k];
    }
    if (kind_.rough) {
      const Pack energy = forces.spring * forces.spring / (Pack(2.) * p.tangential_stiffness);
      for (int k = 0; k < kAtOnce; ++k) {
        memory(k).spring = forces.spring.v[k];
        memory(k).tangent = {forces.tangent.x.v[k], forces.tangent.y.v[k]};
        work[k].book->energy = energy.v[k];
        work[k].book->loss = forces.lost.v[k];
      }
    }
    for (int k = 0; k < kAtOnce; ++k) memory(k).patches = 1;
  }
  hold(work, p, forces.held_a, forces.held_b);
  const PairVectorOf<Pack> f = whole_force(p, forces.all);
  const PairVectorOf<Pack>& beside = forces.all;
  write_load(f.x, f.y, f.a, forces.held_a, {beside.x, beside.y, beside.a},
             [&](int k) APOTHEM_LAMBDA -> BodyLoad& { return work[k].load->on_a; });
  write_load(-f.x, -f.y, f.b, forces.held_b, {-beside.x, -beside.y, beside.b},
             [&](int k) APOTHEM_LAMBDA -> BodyLoad& { return work[k].load->on_b; });
  const Pack normal = p.normal_stiffness * p.size;
  for (int k = 0; k < kAtOnce; ++k) {
    work[k].load->normal = normal.v[k];
    work[k].load->a = work[k].a;
    work[k].load->b = work[k].b;
  }
}

void PairBatch::flush(const PairScene& scene) {
  if (count_ == 0) return;
  // Lanes that are left over do the last pair again, for nobody.
  PairWork again = work_[static_cast<size_t>(count_ - 1)];
  again.load = &spare_.load;
  again.memory = &spare_.memory;
  again.damping = &spare_.damping;
  again.book = &spare_.book;
  std::fill(work_.begin() + count_, work_.end(), again);
  with_widest([&](auto /*lanes*/) APOTHEM_LAMBDA {
    step(scene);
    return 0.;
  });
  count_ = 0;
}

}  // namespace apothem
