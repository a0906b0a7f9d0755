#include "apothem/contact/patch_tangential.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace apothem {
namespace {

constexpr double kSlideTime = 150;  // of a touching pair, ns

// The force of a spring after a slip in m: never beyond Coulomb's limit in N. What it loses is the
// mean force times the slip that it does not follow.
double follow(double force, double slip, double stiffness, double limit, PairBook& book) {
  const double trial = force - stiffness * slip;
  const double next = std::clamp(trial, -limit, limit);
  book.loss += (force + next) * (trial - next) / (2 * stiffness);
  return next;
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

void PatchTangential::slide(const PairIntegrals& pairs, const Kinematics& now, double dt,
                            FrictionMemory& memory, std::span<PairStiffness> stiffness) {
  const std::vector<PairInTouch>& touching = pairs.touching();
  stiffness_ = stiffness;
  std::swap(now_, before_);
  std::swap(forces_, forces_before_);
  make_room(touching);
  springs_ = memory.make_room(places_.back().spring);
  for (Range& range : ranges_) memory.begin(range.springs, {-1, 0});
  const int count = static_cast<int>(touching.size());
  const PatchScene scene{surfaces_, now, dt, thickness_};
  threads_.chunks(count, kSlideTime, [&](int first, int end, int worker) {
    if (first == end && count > 0) return;
    Range& range = ranges_[static_cast<size_t>(worker)];
    range.begin({}, 0);
    if (first > 0) {
      const PairInTouch& last = touching[static_cast<size_t>(first - 1)];
      memory.begin(range.springs, {last.a, last.b});
      range.begin(place_behind({last.a, last.b}), forces_behind({last.a, last.b}));
    }
    for (int i = first; i < end; ++i) {
      range.step_pair(pairs, static_cast<size_t>(i), scene);
    }
    range.finish(scene);
    if (end == count) range.release_until(std::numeric_limits<RigidIndex>::max(), 0, scene);
  });
  for (const Range& range : ranges_) memory.add(range.springs);
  for (const PairBook& book : books_) memory.add(book);
}

// Every pair has its place in the lists, so that threads do not wait for each other.
void PatchTangential::make_room(std::span<const PairInTouch> pairs) {
  places_.resize(pairs.size() + 1);
  Place place;
  for (size_t i = 0; i < pairs.size(); ++i) {
    places_[i] = place;
    const PairInTouch& pair = pairs[i];
    const PairLaw& law = table_.between(pair.a, pair.b);
    ++place.pair;
    if (!is_rough(law) && !is_damped(law)) continue;
    const auto patches = static_cast<size_t>(pair.patches), runs = static_cast<size_t>(pair.runs);
    place.run += runs;
    if (table_.damped()) place.damper += patches;
    if (is_rough(law)) place.spring += edgewise() ? runs : patches;
  }
  places_.back() = place;
  forces_.resize(place.pair);
  books_.resize(place.pair);
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

void PatchTangential::Range::release_until(RigidIndex a, RigidIndex b, const PatchScene& scene) {
  const std::vector<TangentialForce>& before = all_.forces_before_;
  for (; last_ < before.size() && BoxPair{before[last_].a, before[last_].b} < BoxPair{a, b};
       ++last_) {
    release(before[last_], scene);
  }
}

// Of a pair that touches no more: in the first half of this step its last force has still acted.
void PatchTangential::Range::release(const TangentialForce& last, const PatchScene& scene) {
  const PairRate rate = pair_rate(scene.now, last.a, last.b);
  springs.lose(-scene.dt / 2 * (last.all.power(rate) - last.damping.power(rate)));
  TangentialForceOf<double> gone{.rate = rate}, over{.rate = rate};
  springs.damp(close_damping(last, scene.dt, gone));
  springs.damp(close_damping(gone, scene.dt, over));
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

void PatchTangential::Range::step_pair(const PairIntegrals& pairs, size_t i,
                                       const PatchScene& scene) {
  const PairInTouch& result = pairs.touching()[i];
  const RigidIndex a = result.a, b = result.b;
  release_until(a, b, scene);
  const TangentialForce* last = nullptr;
  if (last_ < all_.forces_before_.size()) {
    const TangentialForce& next = all_.forces_before_[last_];
    if (next.a == a && next.b == b) last = &next, ++last_;
  }
  const Place& to = all_.places_[i];
  const PairLaw& law = all_.table_.between(a, b);
  Pair pair{.a = a,
            .b = b,
            .law = law,
            .rough = all_.is_rough(law),
            .damped = all_.is_damped(law),
            .last = last,
            // Also of pairs without friction: what has ended before them is booked by this range.
            .springs = springs.before(polygon_kernel, a, b),
            .dampers = {},
            .to = to,
            .total = all_.forces_[to.pair],
            .held = all_.stiffness_[to.pair],
            .book = all_.books_[to.pair]};
  PairHistory& history = all_.now_.pairs[to.pair] = {a, b, 0, 0};
  if (!pair.rough && !pair.damped) {
    pair.clear();
    return;
  }
  runs_ = pairs.runs(result);
  patches_ = pairs.patches(result);
  history.patches = static_cast<int>(patches_.size());
  history.runs = static_cast<int>(runs_.size());
  std::copy(runs_.begin(), runs_.end(),
            all_.now_.runs.begin() + static_cast<std::ptrdiff_t>(to.run));
  const PairHistory* const before = find_before(a, b);
  ancestors_ = before ? static_cast<size_t>(before->patches) : 0;
  if (pair.damped && before) {
    pair.dampers = std::span(all_.before_.dampers).subspan(place_.damper, ancestors_);
  }
  if (patches_.size() == 1 && ancestors_ <= 1 && !all_.edgewise()) {
    add_alone(pair, scene);
    return;
  }
  pair.clear();
  find_shares(before);
  step_patches(pair, scene);
  if (pair.rough && all_.edgewise()) per_edge(pair, scene);
  if (pair.damped) {
    TangentialForceOf<double> none{.rate = pair.total.rate};
    pair.book.damping_loss += close_damping(
        last ? static_cast<const TangentialForceOf<double>&>(*last) : none, scene.dt, pair.total);
  }
}

// The one patch of a pair, which had one or none before.
void PatchTangential::Range::add_alone(const Pair& pair, const PatchScene& scene) {
  if (!pair.rough || !pair.damped) pair.clear();  // otherwise all of it will be written
  pair.total.a = pair.a;
  pair.total.b = pair.b;
  Spring* spring = nullptr;
  if (pair.rough) {
    spring = &all_.springs_[pair.to.spring];
    spring->key = {polygon_kernel, pair.a, pair.b, 0};
    spring->accounted = true;
  }
  PatchDamper* damper = nullptr;
  if (all_.table_.damped()) *(damper = &all_.now_.dampers[pair.to.damper]) = {};
  batch_.add(scene, pair.rough, pair.damped,
             {pair.a, pair.b, &patches_[0], &pair.law, pair.last, ancestors_ == 0,
              pair.springs.empty() ? 0 : pair.springs[0].force,
              pair.dampers.empty() ? nullptr : &pair.dampers[0]},
             {&pair.total, &pair.held, spring, damper, &pair.book});
}

void PatchTangential::Range::step_patches(const Pair& pair, const PatchScene& scene) {
  const bool one_each = pair.rough && !all_.edgewise();
  dampers_.assign(patches_.size(), {});
  if (pair.damped) {
    inherit(pair.dampers, dampers_,
            [](PatchDamper& heir, double share, const PatchDamper& old, const PairIntegral&) {
              heir.elastic = heir.elastic + share * old.elastic;
              heir.damping = heir.damping + share * old.damping;
              heir.tangential += share * old.tangential;
            });
  }
  if (one_each) {
    inherit(pair.springs, patch_springs_,
            [](Spring& heir, double share, const Spring& old, const PairIntegral& patch) {
              Vec2 tangent = tangent_of(patch.force);
              if (tangent == Vec2::Zero()) tangent = old.tangent;
              heir.force += share * old.force * tangent.dot(old.tangent);
            });
  }
  pair.total.rate = pair_rate(scene.now, pair.a, pair.b);
  for (size_t j = 0; j < patches_.size(); ++j) {
    const PatchWork work{pair.a,
                         pair.b,
                         &patches_[j],
                         &pair.law,
                         pair.last,
                         ancestors_ == 0,
                         one_each ? patch_springs_[j].force : 0,
                         &dampers_[j]};
    const PatchForces<double> forces = step_one(scene, work, one_each, pair.damped, dampers_[j]);
    pair.total.all = pair.total.all + forces.all;
    pair.total.damping = pair.total.damping + forces.damping;
    if (!one_each) continue;
    pair.held.a.add(forces.held_a, 1);
    pair.held.b.add(forces.held_b, 1);
    Spring& spring = all_.springs_[pair.to.spring + j];
    spring = {{polygon_kernel, pair.a, pair.b, static_cast<int>(j)},
              forces.spring,
              pair.law.friction.tangential_stiffness * scene.thickness,
              {forces.tangent.x, forces.tangent.y},
              true};
    pair.book.energy += spring.energy();
    pair.book.loss += forces.lost;
  }
  if (one_each && !inherit_whole()) pair.book.loss = lost_by_balance(pair, scene.dt);
  if (all_.table_.damped()) {
    std::copy(dampers_.begin(), dampers_.end(),
              all_.now_.dampers.begin() + static_cast<std::ptrdiff_t>(pair.to.damper));
  }
}

// What the patches before hand down to those of now: everything to the only heir, otherwise in
// proportion to the normal forces of those that share boundary with it. Forces are neither invented
// nor lost.
void PatchTangential::Range::find_shares(const PairHistory* before) {
  const size_t heirs = patches_.size();
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
double PatchTangential::Range::lost_by_balance(const Pair& pair, double dt) const {
  const auto power = [&](const TangentialForceOf<double>& f) {
    return (f.all - f.damping).power(pair.total.rate);
  };
  double lost = -dt / 2 * ((pair.last ? power(*pair.last) : 0) + power(pair.total));
  for (const Spring& spring : pair.springs) lost += spring.energy();
  return lost - pair.book.energy;
}

// The older law, for comparison (Eq. 9): a spring along every edge of the overlap. Edges that slope
// against the motion meet a false tangential force.
void PatchTangential::Range::per_edge(const Pair& pair, const PatchScene& scene) {
  const Vec2 between = all_.surfaces_.between(pair.a, pair.b);
  const PairRate& rate = pair.total.rate;
  const double stiffness = pair.law.friction.tangential_stiffness * scene.thickness;
  const double normal_stiffness = pair.law.normal_stiffness * scene.thickness;
  const int edges_of_a = all_.surfaces_.shapes().view(pair.a).size;
  Spring* next = &all_.springs_[pair.to.spring];
  auto old = pair.springs.begin();
  const auto lost = [&] { pair.book.loss += (old++)->energy(); };  // of an edge that is free again
  for (const BoundaryRun& run : runs_) {
    const SpringKey key{polygon_kernel, pair.a, pair.b,
                        run.of_a ? run.edge : edges_of_a + run.edge};
    while (old != pair.springs.end() && old->key < key) lost();
    double before = 0;
    if (old != pair.springs.end() && old->key == key) before = (old++)->force;
    const Vec2 tangent = tangent_of(run.force);
    const Vec2 behind = run.centre + between;
    const Vec2 slip = Vec2(rate.x, rate.y) + cross(rate.a, run.centre) - cross(rate.b, behind);
    const double force =
        follow(before, slip.dot(tangent) * scene.dt, stiffness,
               pair.law.friction.coefficient * normal_stiffness * run.force.norm(), pair.book);
    *next = {key, force, stiffness, tangent, true};
    pair.book.energy += (next++)->energy();
    const double arm_a = cross(run.centre, tangent), arm_b = cross(behind, tangent);
    pair.total.all = pair.total.all + force * PairForce{tangent.x(), tangent.y(), arm_a, -arm_b};
    pair.held.a.add(stiffness, tangent.x(), tangent.y(), arm_a);
    pair.held.b.add(stiffness, tangent.x(), tangent.y(), arm_b);
  }
  while (old != pair.springs.end()) lost();
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
    patches[j].damping += Vec2(damper.damping.x, damper.damping.y);
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
