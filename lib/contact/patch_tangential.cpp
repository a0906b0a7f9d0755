#include "apothem/contact/patch_tangential.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace apothem {
namespace {

// Error of the sum of a patch's normal forces, in units of eps x size / reference length x own
// length: twice the worst of a million pairs (docs/verification.md).
constexpr double kForceError = 1.2;

constexpr double kSlideTime = 250;  // of a touching pair, ns

// The force of a spring after a slip in m: never beyond Coulomb's limit in N. What it loses is the
// mean force times the slip that it does not follow.
double follow(double force, double slip, double stiffness, double limit, SpringRange& springs) {
  const double trial = force - stiffness * slip;
  const double next = std::clamp(trial, -limit, limit);
  springs.lose((force + next) * (trial - next) / (2 * stiffness));
  return next;
}

// The part of a long step after which a patch that is new has closed: its mean depth over the
// approach. `slopes`: the sum of its lengths, each times the slope of the other potential.
double closed_share(const PairMotion& motion, const PairIntegral& patch, double slopes, double dt) {
  const double size = patch.force.norm();
  if (!(size > 0)) return 1;
  const double approach = -motion.slip(loading_point(patch)).dot(patch.force) / size * dt;
  const double depth = size / slopes;
  return approach > depth ? depth / approach : 1;
}

}  // namespace

// What matching patches needs of a run; the next step makes the rest anew.
static void describe(Archive& archive, BoundaryRun& run) {
  archive("of_a", run.of_a)("edge", run.edge)("patch", run.patch)("from", run.from)("to", run.to)(
      "length", run.length);
}

PatchTangential::PatchTangential(const Surfaces& surfaces, const ContactLaw& law,
                                 const PairTable& table, double thickness, int threads)
    : surfaces_(surfaces),
      per_edge_(law.friction_law == FrictionLaw::per_edge),
      table_(table),
      thickness_(thickness),
      threads_(threads),
      ranges_(static_cast<size_t>(threads_.count()), Range(*this)) {}

void PatchTangential::slide(const PairIntegrals& pairs, std::span<const int> touching,
                            const Kinematics& now, double dt, FrictionMemory& memory,
                            std::span<PairStiffness> stiffness) {
  stiffness_ = stiffness;
  std::swap(now_, before_);
  std::swap(forces_, forces_before_);
  make_room(pairs, touching);
  memory.make_room(places_.back().spring);
  for (Range& range : ranges_) memory.begin(range.springs, {-1, 0}, 0);
  const int count = static_cast<int>(touching.size());
  threads_.chunks(count, kSlideTime, [&](int first, int end, int worker) {
    if (first == end && count > 0) return;
    Range& range = ranges_[static_cast<size_t>(worker)];
    range.begin({}, 0);
    if (first > 0) {
      const auto [a, b] = pairs.pairs()[static_cast<size_t>(touching[first - 1])];
      memory.begin(range.springs, {a, b}, places_[static_cast<size_t>(first)].spring);
      range.begin(place_behind({a, b}), forces_behind({a, b}));
    }
    for (int i = first; i < end; ++i) {
      range.step_pair(pairs, static_cast<size_t>(touching[i]), places_[static_cast<size_t>(i)], now,
                      dt);
    }
    if (end == count) range.release_until(std::numeric_limits<RigidIndex>::max(), 0, now, dt);
  });
  for (const Range& range : ranges_) memory.add(range.springs);
}

// Every pair has its place in the lists, so that threads do not wait for each other.
void PatchTangential::make_room(const PairIntegrals& pairs, std::span<const int> touching) {
  places_.resize(touching.size() + 1);
  Place place;
  for (size_t i = 0; i < touching.size(); ++i) {
    places_[i] = place;
    const auto pair = static_cast<size_t>(touching[i]);
    const auto [a, b] = pairs.pairs()[pair];
    const PairLaw& law = table_.between(a, b);
    ++place.pair;
    if (!is_rough(law) && !is_damped(law)) continue;
    const size_t patches = pairs.patches(pair).size(), runs = pairs.runs(pair).size();
    place.run += runs;
    if (table_.damped()) place.damper += patches;
    if (is_rough(law)) place.spring += edgewise() ? runs : patches;
  }
  places_.back() = place;
  forces_.resize(place.pair);
  now_.pairs.resize(place.pair);
  now_.runs.resize(place.run);
  now_.dampers.resize(place.damper);
}

PatchTangential::Place PatchTangential::place_behind(const BoxPair& pair) const {
  Place place;
  for (const PairHistory& p : before_.pairs) {
    if (BoxPair{p.a, p.b} > pair) break;
    place.pass(p);
  }
  return place;
}

size_t PatchTangential::forces_behind(const BoxPair& pair) const {
  const auto behind = std::partition_point(forces_before_.begin(), forces_before_.end(),
                                           [&](const TangentialForce& f) {
                                             return BoxPair{f.a, f.b} <= pair;
                                           });
  return static_cast<size_t>(behind - forces_before_.begin());
}

void PatchTangential::Range::begin(const Place& place, size_t force) {
  place_ = place;
  last_ = force;
}

void PatchTangential::Range::release_until(RigidIndex a, RigidIndex b, const Kinematics& kinematics,
                                           double dt) {
  const std::vector<TangentialForce>& before = all_.forces_before_;
  for (; last_ < before.size() && BoxPair{before[last_].a, before[last_].b} < BoxPair{a, b};
       ++last_) {
    release(before[last_], kinematics, dt);
  }
}

// What damping takes from the bodies in a step. Velocity Verlet sums the work of a force G by the
// trapezoid rule, along a path that bends within the step. With the accelerations of the bodies
// against each other at both ends, the work on them is h^2/12 (G_1 - G_0) (a_0 + a_1) larger,
// summed over a contact. The last one is known a step later, so that this part is of the step
// before.
void PatchTangential::Range::book_damping(const TangentialForce* last, const TangentialForce& force,
                                          const PairRate& rate, double dt) {
  double work = dt / 2 * force.damping.power(rate);
  if (last) {
    work += dt / 2 * last->damping.power(rate);
    work += dt / 12 * (last->change_of_damping.power(rate) - last->power_before);
  }
  springs.damp(-work);
}

// Of a pair that touches no more: in the first half of this step its last force has still acted.
void PatchTangential::Range::release(const TangentialForce& last, const Kinematics& kinematics,
                                     double dt) {
  const PairRate rate = PairMotion(all_.surfaces_, kinematics, last.a, last.b).rate;
  springs.lose(-dt / 2 * (last.all.power(rate) - last.damping.power(rate)));
  TangentialForce gone{last.a, last.b};
  gone.compare_with(&last, rate, dt);
  book_damping(&last, gone, rate, dt);
  book_damping(&gone, {}, rate, dt);
}

void PatchTangential::History::fields(Archive& archive) {
  archive("pairs", pairs)("runs", runs)("dampers", dampers);
}

// Leaves place_ at the pair, if it was there before.
const PatchTangential::PairHistory* PatchTangential::Range::find_before(RigidIndex a,
                                                                        RigidIndex b) {
  while (place_.pair < all_.before_.pairs.size()) {
    const PairHistory& pair = all_.before_.pairs[place_.pair];
    if (BoxPair{pair.a, pair.b} == BoxPair{a, b}) return &pair;
    if (BoxPair{pair.a, pair.b} > BoxPair{a, b}) return nullptr;
    place_.pass(pair);
  }
  return nullptr;
}

void PatchTangential::Range::step_pair(const PairIntegrals& pairs, size_t pair, const Place& to,
                                       const Kinematics& kinematics, double dt) {
  const auto [a, b] = pairs.pairs()[pair];
  const Surfaces& surfaces = all_.surfaces_;
  const double thickness = all_.thickness_;
  release_until(a, b, kinematics, dt);
  const TangentialForce* last = nullptr;
  if (last_ < all_.forces_before_.size()) {
    const TangentialForce& next = all_.forces_before_[last_];
    if (next.a == a && next.b == b) last = &next, ++last_;
  }
  // Also of pairs without friction: what has ended before them is booked by this range.
  const std::span<const Spring> springs_before = springs.before(polygon_kernel, a, b);
  TangentialForce& total = all_.forces_[to.pair] = TangentialForce{a, b};
  total_ = &total;
  *(stiffness_ = &all_.stiffness_[to.pair]) = {};
  PairHistory& history = all_.now_.pairs[to.pair] = {a, b, 0, 0};
  const PairLaw& law = all_.table_.between(a, b);
  const bool rough = all_.is_rough(law);
  const bool damped = all_.is_damped(law);
  if (!rough && !damped) return;
  const PlacedShapes& shapes = surfaces.shapes();
  const PairMotion motion(surfaces, kinematics, a, b);
  runs_ = pairs.runs(pair);
  patches_ = pairs.patches(pair);
  const PairHistory* const before = find_before(a, b);
  find_shares(before);
  if (damped) {
    const std::span<const PatchDamper> dampers(all_.before_.dampers);
    inherit(dampers.subspan(before ? place_.damper : 0, ancestors_), dampers_,
            [](PatchDamper& heir, double share, const PatchDamper& old, const PairIntegral&) {
              heir.add(share, old);
            });
  }
  if (rough && !all_.edgewise()) {
    inherit(springs_before, patch_springs_,
            [](Spring& heir, double share, const Spring& old, const PairIntegral& patch) {
              Vec2 tangent = tangent_of(patch.force);
              if (tangent == Vec2::Zero()) tangent = old.tangent;
              heir.force += share * old.force * tangent.dot(old.tangent);
            });
  }
  springs.begin_pair();
  for (size_t j = 0; j < patches_.size(); ++j) {
    const PairIntegral& patch = patches_[j];
    if (damped) {
      PatchDamper& d = dampers_[j];
      damp(law.damping.normal, law.normal_stiffness * thickness, surfaces, a, b, patch, motion,
           last ? &last->rate : nullptr, dt, d);
      total.add_damping(d.damping);
    }
    if (!rough || all_.edgewise()) continue;
    const double slopes =
        patch.own_length_a * shapes.slope(b) + patch.own_length_b * shapes.slope(a);
    const double error = kForceError * std::numeric_limits<double>::epsilon() *
                         (shapes.radius(a) + shapes.radius(b)) * slopes;
    const double closed =
        kinematics.finite && ancestors_ == 0 ? closed_share(motion, patch, slopes, dt) : 1;
    resultant(motion, closed * dt, law, {polygon_kernel, a, b, static_cast<int>(j)}, patch, error,
              patch_springs_[j], damped ? &dampers_[j] : nullptr);
  }
  if (rough && !all_.edgewise() && !inherit_whole()) {
    const double known = springs.lost();
    springs.lose(lost_by_balance(springs_before, last, total, motion.rate, dt) - known);
  }
  if (rough && all_.edgewise()) {
    per_edge(motion, dt, law, {polygon_kernel, a, b, 0}, springs_before);
  }
  if (damped) {
    total.compare_with(last, motion.rate, dt);
    book_damping(last, total, motion.rate, dt);
  } else {
    dampers_.assign(patches_.size(), {});
  }
  const auto put = [](const auto& list, auto& all, size_t first) {
    std::copy(list.begin(), list.end(), all.begin() + static_cast<std::ptrdiff_t>(first));
  };
  if (all_.table_.damped()) put(dampers_, all_.now_.dampers, to.damper);
  put(runs_, all_.now_.runs, to.run);
  history.patches = static_cast<int>(patches_.size());
  history.runs = static_cast<int>(runs_.size());
}

// What the patches before hand down to those of now: everything to the only heir, otherwise in
// proportion to the normal forces of those that share boundary with it. Forces are neither invented
// nor lost.
void PatchTangential::Range::find_shares(const PairHistory* before) {
  const size_t heirs = patches_.size();
  ancestors_ = before ? static_cast<size_t>(before->patches) : 0;
  if (ancestors_ == 0 || (ancestors_ == 1 && heirs == 1)) return;
  shared_length({all_.before_.runs.data() + place_.run, static_cast<size_t>(before->runs)},
                before->patches, runs_, static_cast<int>(heirs), shares_);
  for (size_t i = 0; i < ancestors_; ++i) {
    double* const share = &shares_[i * heirs];
    double sum = 0;
    for (size_t j = 0; j < heirs; ++j) {
      share[j] = share[j] > 0 ? patches_[j].force.norm() : 0;
      sum += share[j];
    }
    for (size_t j = 0; j < heirs; ++j) share[j] = sum > 0 ? share[j] / sum : 0;
  }
}

// True if every patch goes on alone, or there were none.
bool PatchTangential::Range::inherit_whole() const {
  const size_t heirs = patches_.size();
  if (ancestors_ == 0 || (ancestors_ == 1 && heirs == 1)) return true;
  if (ancestors_ != heirs) return false;
  for (size_t i = 0; i < heirs; ++i) {
    if (shares_[i * heirs + i] != 1) return false;
  }
  return true;
}

template <class T, class Add>
void PatchTangential::Range::inherit(std::span<const T> before, std::vector<T>& heirs,
                                     Add&& add) const {
  heirs.assign(patches_.size(), {});
  if (before.size() == 1 && heirs.size() == 1) {
    heirs[0] = before[0];
    return;
  }
  for (size_t i = 0; i < before.size(); ++i) {
    for (size_t j = 0; j < heirs.size(); ++j) {
      const double share = shares_[i * heirs.size() + j];
      if (share > 0) add(heirs[j], share, before[i], patches_[j]);
    }
  }
}

// Where patches come, go, split or merge, springs do not know what they lose: what friction has
// taken from the bodies and the springs do not store.
double PatchTangential::Range::lost_by_balance(std::span<const Spring> before,
                                               const TangentialForce* last,
                                               const TangentialForce& force, const PairRate& rate,
                                               double dt) const {
  const auto power = [&](const TangentialForce& f) {
    return f.all.power(rate) - f.damping.power(rate);
  };
  double lost = -dt / 2 * ((last ? power(*last) : 0) + power(force));
  for (const Spring& spring : before) lost += spring.energy();
  for (const Spring& spring : patch_springs_) lost -= spring.energy();
  return lost;
}

// Adds the force of a spring at a point relative to the mass centre of a. `between`: mass centre of
// a minus that of b, m.
void PatchTangential::Range::add_spring(double size, double stiffness, const Vec2& tangent,
                                        const Vec2& point, const Vec2& between) {
  const double arm_a = cross(point, tangent), arm_b = -cross(point + between, tangent);
  total_->all += {size * tangent, size * arm_a, size * arm_b};
  stiffness_->a.add(stiffness, tangent, arm_a);
  stiffness_->b.add(stiffness, tangent, -arm_b);
}

// The paper's law (Eqs. 10-14): one spring per patch, at right angles to its normal force. As a
// number along the tangent it turns with the contact by itself (Eq. 13). Friction on a opposes a's
// slip against b: the sign of Eq. 12 is a misprint.
void PatchTangential::Range::resultant(const PairMotion& motion, double dt, const PairLaw& law,
                                       SpringKey key, const PairIntegral& patch, double force_error,
                                       Spring& spring, PatchDamper* damper) {
  spring.key = key;
  spring.stiffness = law.friction.tangential_stiffness * all_.thickness_;
  spring.accounted = true;
  const double size = patch.force.norm();
  if (!(size > kNoResultant * patch.weight)) {
    springs.lose(spring.energy());
    spring.force = 0;
    if (damper) damper->tangential = 0;
    springs.keep(spring);
    return;
  }
  const Vec2 tangent = tangent_of(patch.force);
  const Vec2 point = loading_point(patch);
  Vec2 normal = law.normal_stiffness * all_.thickness_ * patch.force;
  if (damper) normal += damper->damping.force;
  const Vec2 velocity = motion.slip(point);
  double slip = velocity.dot(tangent);
  // The tangent is only as exact as the force: what it makes of an approach is no slip.
  if (std::abs(slip) <= velocity.norm() * force_error / size) slip = 0;
  const double limit = law.friction.coefficient * normal.norm();
  spring.force = follow(spring.force, slip * dt, spring.stiffness, limit, springs);
  spring.tangent = tangent;
  springs.keep(spring);
  add_spring(spring.force, spring.stiffness, tangent, point, motion.between);
  if (damper == nullptr || !(law.damping.tangential > 0)) return;
  // A first look, perhaps with the memory of another run, keeps the force.
  if (dt > 0) {
    const double time = damping_time(law.damping.tangential, spring.stiffness, all_.surfaces_,
                                     key.a, key.b, point, tangent, motion);
    const double both = spring.force - time * spring.stiffness * slip;
    damper->tangential = std::clamp(both, -limit, limit) - spring.force;
  }
  total_->add_damping({damper->tangential * tangent, damper->tangential * cross(point, tangent),
                       -damper->tangential * cross(point + motion.between, tangent)});
}

// The older law, for comparison (Eq. 9): a spring along every edge of the overlap. Edges that slope
// against the motion meet a false tangential force.
void PatchTangential::Range::per_edge(const PairMotion& motion, double dt, const PairLaw& law,
                                      SpringKey key, std::span<const Spring> before) {
  const double stiffness = law.friction.tangential_stiffness * all_.thickness_;
  const int edges_of_a = all_.surfaces_.shapes().view(key.a).size;
  auto old = before.begin();
  const auto lost = [&] { springs.lose((old++)->energy()); };  // of an edge that is free again
  for (const BoundaryRun& run : runs_) {
    key.part = run.of_a ? run.edge : edges_of_a + run.edge;
    while (old != before.end() && old->key < key) lost();
    double spring = 0;
    if (old != before.end() && old->key == key) spring = (old++)->force;
    const Vec2 tangent = tangent_of(run.force);
    spring =
        follow(spring, motion.slip(run.centre).dot(tangent) * dt, stiffness,
               law.friction.coefficient * law.normal_stiffness * all_.thickness_ * run.force.norm(),
               springs);
    springs.keep({key, spring, stiffness, tangent, true});
    add_spring(spring, stiffness, tangent, run.centre, motion.between);
  }
  while (old != before.end()) lost();
}

void PatchTangential::add_to(std::span<ContactRecord> patches, std::span<const BoundaryRun> runs,
                             std::span<const Spring> springs, Cursor& cursor) const {
  const std::pair pair(patches[0].a, patches[0].b);
  const auto order = [&] {
    const PairHistory& p = now_.pairs[cursor.pair];
    return std::pair(p.a, p.b);
  };
  while (cursor.pair < now_.pairs.size() && order() < pair) {
    cursor.damper += static_cast<size_t>(now_.pairs[cursor.pair++].patches);
  }
  if (cursor.pair == now_.pairs.size() || order() != pair) return;
  if (now_.pairs[cursor.pair].patches == 0) return;
  for (size_t j = 0; table_.damped() && j < patches.size(); ++j) {
    const PatchDamper& damper = now_.dampers[cursor.damper + j];
    patches[j].damping += damper.damping.force;
    if (damper.tangential != 0) {
      patches[j].tangential += damper.tangential * tangent_of(patches[j].normal);
    }
  }
  for (size_t i = 0; i < springs.size(); ++i) {
    const int patch = edgewise() ? runs[i].patch : springs[i].key.part;
    patches[static_cast<size_t>(patch)].tangential += springs[i].force * springs[i].tangent;
  }
}

}  // namespace apothem
