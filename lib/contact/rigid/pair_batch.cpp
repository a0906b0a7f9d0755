#include "lib/contact/rigid/pair_batch.hpp"

#include <algorithm>
#include <limits>

#include "lib/execution/dispatch.hpp"

namespace apothem {
namespace {

// Error of the sum of the normal forces of a patch, in units of eps times size over reference
// length times own length: twice the worst value of a million pairs (docs/verification.md).
constexpr double kForceError = 1.2;
// A contact whose breadth over its depth is smaller than this is a point.
constexpr double kNarrow = 1e-9;

// Reads one number for each lane; a single number is that of the first lane.
template <class F>
APOTHEM_INLINE void read_lanes(double& number, const F& value) {
  number = value(0);
}
template <int lanes, class F>
APOTHEM_INLINE void read_lanes(PackOf<lanes>& pack, const F& value) {
  pack = pack_of<lanes>(value);
}
// Reads one truth value for each lane, from 1 or 0.
template <class F>
APOTHEM_INLINE void read_lanes(bool& truth, const F& value) {
  truth = value(0) > 0;
}
template <int lanes, class F>
APOTHEM_INLINE void read_lanes(MaskOf<lanes>& mask, const F& value) {
  PackOf<lanes> number;
  read_lanes(number, value);
  mask = number > PackOf<lanes>(0.);
}

// Reads the mass centre of a minus that of b for the pairs of `lanes`.
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
  const auto number = [&](Real& result, const auto& value) APOTHEM_LAMBDA {
    if (same) {
      result = Real(value(*work[0].law));
    } else {
      read_lanes(result, [&](int k) APOTHEM_LAMBDA { return value(*work[k].law); });
    }
  };
  number(p.normal_stiffness,
         [&](const PairLaw& l) APOTHEM_LAMBDA { return l.normal_stiffness * thickness; });
  number(p.stiffness_ratio,
         [](const PairLaw& l) APOTHEM_LAMBDA { return l.friction.stiffness_ratio; });
  number(p.constant, [&](const PairLaw& l)
                         APOTHEM_LAMBDA { return l.friction.tangential_stiffness * thickness; });
  p.limit.each_parameter(number);
}

// Reads the integrals of a pair and the positions of its bodies, which its load needs.
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
  // A row of Surfaces::Rigid holds the inverse masses and the slope.
  read_rows([&](int k) APOTHEM_LAMBDA { return surfaces.rigid(work[k].a).inverse_mass.data(); },
            four);
  const Real slope_a = four[3];
  read_rows([&](int k) APOTHEM_LAMBDA { return surfaces.rigid(work[k].b).inverse_mass.data(); },
            four);
  const Real slope_b = four[3];
  p.slopes = length_a * slope_b + length_b * slope_a;
  integral(kBreadthNumbers);
  p.growth = growth_of(four[0], length_a, slope_a, length_b, slope_b);
  read_between(surfaces, work, p.between);
  read_law(work, scene.thickness, p);
  p.find_direction();
}

template <class Real>
APOTHEM_INLINE void read_memory(const PairScene& scene, const PairWork* work, PatchStep<Real>& p) {
  Real radii;
  read_lanes(radii, [&](int k) APOTHEM_LAMBDA {
    return scene.surfaces.rigid(work[k].a).radius + scene.surfaces.rigid(work[k].b).radius;
  });
  p.force_error = Real(kForceError * std::numeric_limits<double>::epsilon()) * radii * p.slopes;
  const auto rate = [&](Real& result, const auto& value) APOTHEM_LAMBDA {
    const double* const all = scene.now->pose_rate.data();
    read_lanes(result, [&](int k) APOTHEM_LAMBDA {
      return value(all + 3 * static_cast<size_t>(work[k].a),
                   all + 3 * static_cast<size_t>(work[k].b));
    });
  };
  rate(p.rate.x, [](const double* a, const double* b) APOTHEM_LAMBDA { return a[0] - b[0]; });
  rate(p.rate.y, [](const double* a, const double* b) APOTHEM_LAMBDA { return a[1] - b[1]; });
  rate(p.rate.a, [](const double* a, const double*) APOTHEM_LAMBDA { return a[2]; });
  rate(p.rate.b, [](const double*, const double* b) APOTHEM_LAMBDA { return b[2]; });
  read_lanes(p.begins, [&](int k) APOTHEM_LAMBDA { return work[k].begins ? 1. : 0.; });
  const auto before = [&](int k) APOTHEM_LAMBDA -> const Spring& { return *work[k].before; };
  read_lanes(p.spring, [&](int k) APOTHEM_LAMBDA { return before(k).force; });
  read_lanes(p.stiffness_before, [&](int k) APOTHEM_LAMBDA { return before(k).stiffness; });
  read_lanes(p.push, [&](int k) APOTHEM_LAMBDA { return before(k).push; });
  gather(p.friction_before,
         [&](int k) APOTHEM_LAMBDA -> const PairForce& { return before(k).on_bodies; });
}

template <class Real>
APOTHEM_INLINE void add_strip_stiffness(const PairWork* work, const PatchStep<Real>& p,
                                        BodyStiffnessOf<Real>& a, BodyStiffnessOf<Real>& b) {
  FourOf<Real> four;
  read_rows([&](int k)
                APOTHEM_LAMBDA { return integral_numbers(*work[k].integral) + kBreadthNumbers; },
            four);
  const ContactStrip<Real> strip{four[0], four[1]};
  strip.add_stiffness(p, a, b);
}

// Force and moments of a pair, including those of friction.
template <class Real>
APOTHEM_INLINE PairVectorOf<Real> whole_force(const PatchStep<Real>& p,
                                              const PairVectorOf<Real>& beside) {
  const Real& k = p.normal_stiffness;
  return PairVectorOf<Real>{k * p.force.x, k * p.force.y, k * p.moment_a, k * p.moment_b} + beside;
}

// The numbers of a load are contiguous, so that they can be written as rows.
static_assert(offsetof(BodyLoad, stiffness) == 3 * sizeof(double) &&
              sizeof(BodyLoad) == 12 * sizeof(double));
template <int lanes, class F>
APOTHEM_INLINE void write_load(const PackOf<lanes>& x, const PackOf<lanes>& y,
                               const PackOf<lanes>& moment,
                               const BodyStiffnessOf<PackOf<lanes>>& stiffness,
                               const std::array<PackOf<lanes>, 3>& beside, const F& load) {
  write_rows({x, y, moment, stiffness.xx}, [&](int k) APOTHEM_LAMBDA { return &load(k).x; });
  write_rows({stiffness.xy, stiffness.yy, stiffness.xt, stiffness.yt},
             [&](int k) APOTHEM_LAMBDA { return &load(k).stiffness.xy; });
  write_rows({stiffness.tt, beside[0], beside[1], beside[2]},
             [&](int k) APOTHEM_LAMBDA { return &load(k).stiffness.tt; });
}

}  // namespace

void find_patch_friction(const PairScene& scene, std::span<const PairWork> work,
                         PatchFriction<double>* friction) {
  using Pack = PackOf<kComparedLanes>;
  std::array<PairWork, kComparedLanes> all;
  std::array<PatchFriction<double>, kComparedLanes> friction_of;
  std::ranges::copy(work, all.begin());
  std::fill(all.begin() + std::ssize(work), all.end(), work.back());  // padding
  with_widest([&](auto /*lanes*/) APOTHEM_LAMBDA {
    PatchStep<Pack> p;
    PatchFriction<Pack> found;
    read_pair(scene, all.data(), p);
    read_memory(scene, all.data(), p);
    // The previous force of the spring of one patch among several is not known, because the patch
    // may have been elsewhere.
    p.friction_before = p.force_at_point(p.spring * p.normal.turned());
    rub(p, scene.dt, found);
    scatter(found, [&](int k) APOTHEM_LAMBDA -> PatchFriction<double>& { return friction_of[k]; });
    return 0.;
  });
  std::copy_n(friction_of.begin(), work.size(), friction);
}

bool add_dashpot(const PairScene& scene, const std::pair<RigidIndex, RigidIndex>& bodies,
                 const PairIntegral& patch, const PairLaw& law, double spring, Dashpots& dashpots) {
  const RigidIndex a = bodies.first, b = bodies.second;
  PatchStep<double> p;
  const PairWork work{.a = a, .b = b, .integral = &patch, .law = &law, .load = nullptr};
  read_pair(scene, &work, p);
  const double stiffness = p.stiffness();
  if (!p.has_direction || !(stiffness > 0)) return false;
  const Vec2 point(p.point.x, p.point.y), behind = point + Vec2(p.between.x, p.between.y);
  const auto rate = [&](double value, double k, const Vec2& along) {
    const double mobility = mobility_at(scene.surfaces.rigid(a).inverse_mass, point, along) +
                            mobility_at(scene.surfaces.rigid(b).inverse_mass, behind, along);
    return k * dashpot_time(value, law.damping.are_times, k, mobility);
  };
  const Vec2 normal(p.normal.x, p.normal.y), across(-p.normal.y, p.normal.x);
  const double pressed = p.normal_stiffness * p.size;
  const double normal_rate = rate(law.damping.normal, stiffness, normal);
  Dashpot dashpot{.a = a, .b = b, .normal = normal, .across = {}};
  if (law.rough()) {
    dashpot.tangential_rate = rate(law.damping.tangential, p.tangential_stiffness(), across);
    dashpot.spring = spring;
    dashpot.limit = FrictionLimit<double>::of(law);
  }
  // The strip of the contact is represented by two dashpots that resist its rotation as a uniformly
  // distributed one does.
  const double apart = patch.breadth / std::sqrt(12.), off = point.dot(across) - patch.middle;
  const bool both = apart > kNarrow * pressed / stiffness;
  const double weight = both ? std::clamp((1 + off / apart) / 2, 0., 1.) : 0;
  const std::array<double, 2> along{both ? -off - apart : 0, both ? apart - off : 0};
  const std::array<double, 2> weights{1 - weight, weight};
  // The mean depths of both halves say how much deeper it gets from one end to the other one. What
  // the largest depth has beyond is because the boundary rises towards both ends.
  const double mean = pressed / stiffness;
  const double spread = both ? std::sqrt(3.) / 2 * mean * std::abs(weights[1] - weights[0]) : 0;
  const double arch = std::max(0., patch.depth - mean - 2 * spread);
  const double plateau = arch > 0 ? arch / (arch + spread) : 0;
  for (const size_t k : {0, 1}) {
    const double part = both ? .5 : weights[k];  // fraction of the stiffness
    const double own = both ? 2 * weights[k] * mean : mean;
    dashpot.across[k] = Dashpot::Normal::of(part * normal_rate, weights[k] * pressed,
                                            part * stiffness, own + spread + arch, plateau);
  }
  dashpots.add(dashpot);
  dashpots.add_rigid(a, 1, {point + along[0] * across, point + along[1] * across}, point);
  dashpots.add_rigid(b, -1, {behind + along[0] * across, behind + along[1] * across}, behind);
  return true;
}

void load_pair(const PairScene& scene, const PairWork& work, const PairForce& friction,
               const BodyStiffness& body_stiffness_a, const BodyStiffness& body_stiffness_b) {
  PatchStep<double> p;
  read_pair(scene, &work, p);
  BodyStiffness a = body_stiffness_a, b = body_stiffness_b;
  add_strip_stiffness(&work, p, a, b);
  const PairForce f = whole_force(p, friction);
  *work.load = {{f.x, f.y, f.a, a, {friction.x, friction.y, friction.a}},
                {-f.x, -f.y, f.b, b, {-friction.x, -friction.y, friction.b}},
                p.normal_stiffness * p.size,
                work.a,
                work.b};
}

APOTHEM_INLINE void PairBatch::step(const PairScene& scene) {
  using Pack = PackOf<kAtOnce>;
  const PairWork* const work = work_.data();
  PatchStep<Pack> p;
  read_pair(scene, work, p);
  PatchFriction<Pack> friction;
  if (rough_) {
    read_memory(scene, work, p);
    rub(p, scene.dt, friction);
    const auto now = [&](int k) APOTHEM_LAMBDA -> Spring& { return *work[k].now; };
    scatter(friction.force, [&](int k) APOTHEM_LAMBDA -> PairForce& { return now(k).on_bodies; });
    const Pack energy = spring_energy(friction.spring, friction.stiffness);
    for (int k = 0; k < kAtOnce; ++k) {
      now(k).force = friction.spring.v[k];
      now(k).stiffness = friction.stiffness.v[k];
      now(k).tangent = {friction.tangent.x.v[k], friction.tangent.y.v[k]};
      now(k).push = p.push.v[k];
      work[k].ledger->energy = energy.v[k];
      work[k].ledger->loss = friction.lost.v[k];
    }
  }
  add_strip_stiffness(work, p, friction.body_stiffness_a, friction.body_stiffness_b);
  const PairVectorOf<Pack>& beside = friction.force;
  const PairVectorOf<Pack> f = whole_force(p, beside);
  write_load(f.x, f.y, f.a, friction.body_stiffness_a, {beside.x, beside.y, beside.a},
             [&](int k) APOTHEM_LAMBDA -> BodyLoad& { return work[k].load->on_a; });
  write_load(-f.x, -f.y, f.b, friction.body_stiffness_b, {-beside.x, -beside.y, beside.b},
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
  // The remaining lanes are padding: they repeat the last pair, and their results are not used.
  PairWork padding = work_[static_cast<size_t>(count_ - 1)];
  padding.load = &padding_.load;
  padding.now = &padding_.now;
  padding.ledger = &padding_.ledger;
  std::fill(work_.begin() + count_, work_.end(), padding);
  with_widest([&](auto /*lanes*/) APOTHEM_LAMBDA {
    step(scene);
    return 0.;
  });
  count_ = 0;
}

}  // namespace apothem
