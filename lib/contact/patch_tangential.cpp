#include "apothem/contact/patch_tangential.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace apothem {
namespace {

constexpr size_t kPairsAheadOfStep = 8;  // that are fetched, for large scenes

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
      ranges_(static_cast<size_t>(threads_.count()), Range(*this)),
      scene_{surfaces_, thickness_} {}

void PatchTangential::begin_step(const PairIntegrals& pairs, const Kinematics& now, double dt,
                                 FrictionMemory& memory) {
  pairs_ = &pairs;
  kinematics_ = now;
  scene_.now = &kinematics_;
  scene_.dt = dt;
  std::swap(now_, before_);
  springs_ = memory.make_room(make_room());
  for (Range& range : ranges_) memory.begin(range.springs, {-1, 0});
}

// Every pair has its place in the lists, so that threads do not wait for each other. Returns the
// number of springs.
size_t PatchTangential::make_room() {
  const std::vector<PairInTouch>& touching = pairs_->touching();
  places_.clear();
  Place place;
  for (size_t i = 0; i < touching.size(); ++i) {
    if (i % kBlock == 0) places_.push_back(place);
    const PairInTouch& pair = touching[i];
    place.pass(pair.patches, pair.runs, kind_of(table_.between(pair.a, pair.b)), *this);
  }
  now_.pairs.resize(touching.size());
  now_.runs.resize(static_cast<size_t>(place.run));
  now_.dampers.resize(static_cast<size_t>(place.damper));
  now_.damping.resize(table_.damped() ? touching.size() : 0);
  books_.assign(places_.size(), {});
  return place.spring;
}

// What a pair has comes behind this place, and this place moves behind it.
void PatchTangential::Place::pass(int patches, int runs, Tangential kind,
                                  const PatchTangential& all) {
  if (!kind.any()) return;
  run += runs;
  if (all.table_.damped()) damper += patches;
  if (kind.rough) spring += static_cast<size_t>(all.per_edge_ ? runs : patches);
}

void PatchTangential::begin_range(Range& range, int first, FrictionMemory& memory) {
  range.begin(0);
  if (first == 0) return;
  const PairInTouch& last = pairs_->touching()[static_cast<size_t>(first - 1)];
  const BoxPair behind{last.a, last.b};
  memory.begin(range.springs, {last.a, last.b});
  const auto next = std::ranges::partition_point(before_.pairs, [&](const PairHistory& p) {
    return BoxPair{p.a, p.b} <= behind;
  });
  range.begin(static_cast<size_t>(next - before_.pairs.begin()));
}

void PatchTangential::end_step(FrictionMemory& memory) {
  for (const Range& range : ranges_) memory.add(range.springs);
  for (const PairBook& book : books_) memory.add(book);
}

void PatchTangential::inherit(History history) {
  now_ = std::move(history);
  now_.number();
  now_.damping.assign(table_.damped() ? now_.pairs.size() : 0, {});
}

void PatchTangential::History::number() {
  int run = 0, damper = 0;
  for (PairHistory& pair : pairs) {
    pair.first_run = run;
    pair.first_damper = damper;
    run += pair.runs;
    damper += pair.patches;
  }
}

void PatchTangential::History::fields(Archive& archive) {
  archive("pairs", pairs)("runs", runs)("dampers", dampers)("damping", damping);
  number();
}

void PatchTangential::Range::release_until(RigidIndex a, RigidIndex b) {
  const std::vector<PairHistory>& before = all_.before_.pairs;
  for (; next_ < before.size() && BoxPair{before[next_].a, before[next_].b} < BoxPair{a, b};
       ++next_) {
    release(before[next_], all_.damping_before(next_));
  }
}

// Of a pair that touches no more: in the first half of this step its last force has still acted.
void PatchTangential::Range::release(const PairHistory& last, const PairDamping* damping) {
  const PairRate rate = pair_rate(*all_.scene_.now, last.a, last.b);
  const double dt = all_.scene_.dt;
  const PairForce damped = damping ? damping->damping : PairForce();
  springs.lose(-dt / 2 * (last.force.power(rate) - damped.power(rate)));
  if (!damping) return;
  PairDamping gone{.rate = rate}, over{.rate = rate};
  springs.damp(close_damping(*damping, dt, gone));
  springs.damp(close_damping(gone, dt, over));
}

void PatchTangential::Range::step_block(int first, int end, PairBook& book) {
  const std::vector<PairInTouch>& touching = all_.pairs_->touching();
  const size_t count = static_cast<size_t>(end - first);
  loads.resize(count);
  books_.resize(count);
  Place to = all_.places_[static_cast<size_t>(first / kBlock)];
  for (size_t k = 0; k < count; ++k) {
    const auto i = static_cast<size_t>(first) + k;
    if (i + kPairsAheadOfStep < touching.size()) {
      const PairInTouch& ahead = touching[i + kPairsAheadOfStep];
      all_.surfaces_.fetch_inertia(ahead.b);
      __builtin_prefetch(ahead.integral);
      __builtin_prefetch(reinterpret_cast<const char*>(ahead.integral + 1) - 1);
      __builtin_prefetch(&all_.kinematics_.pose_rate[3 * static_cast<size_t>(ahead.b)]);
    }
    step_pair(touching[i], i, to, loads[k], books_[k]);
  }
  batch_.flush(all_.scene_);
  for (const PairBook& pair : books_) book.add(pair);
}

void PatchTangential::Range::step_pair(const PairInTouch& touching, size_t number, Place& to,
                                       PairLoad& load, PairBook& book) {
  const RigidIndex a = touching.a, b = touching.b;
  release_until(a, b);
  const std::vector<PairHistory>& all_before = all_.before_.pairs;
  const PairHistory* before = nullptr;
  const PairDamping* last = nullptr;
  if (next_ < all_before.size() && all_before[next_].a == a && all_before[next_].b == b) {
    before = &all_before[next_];
    last = all_.damping_before(next_++);
  }
  const PairLaw& law = all_.table_.between(a, b);
  const Pair pair{.a = a,
                  .b = b,
                  .integral = touching.integral,
                  .law = law,
                  .kind = all_.kind_of(law),
                  .before = before,
                  .last = last,
                  // Also of pairs without friction: what has ended before them is booked by this
                  // range.
                  .springs = springs.before(polygon_kernel, a, b),
                  .to = to,
                  .now = all_.now_.pairs[number],
                  .damping = all_.table_.damped() ? &all_.now_.damping[number] : nullptr,
                  .load = load,
                  .book = book};
  to.pass(touching.patches, touching.runs, pair.kind, all_);
  pair.now = {a, b, 0, 0, pair.to.run, pair.to.damper, {}};
  if (!pair.kind.any()) {
    if (pair.damping) *pair.damping = {};
    book = {};
    batch_.add(all_.scene_, {}, {a, b, touching.integral, &law}, {&load});
    return;
  }
  runs_ = all_.pairs_->runs(touching);
  patches_ = all_.pairs_->patches(touching);
  pair.now.patches = static_cast<int>(patches_.size());
  pair.now.runs = static_cast<int>(runs_.size());
  std::ranges::copy(runs_, all_.now_.runs.begin() + pair.to.run);
  ancestors_ = before ? static_cast<size_t>(before->patches) : 0;
  if (patches_.size() == 1 && ancestors_ <= 1 && !all_.edgewise()) {
    add_alone(pair);
  } else {
    step_patches(pair);
  }
}

// What the patches of the step before have; nothing where the pair was not damped.
std::span<const PatchDamper> PatchTangential::dampers_of(const PairHistory* pair) const {
  if (!pair || before_.dampers.empty()) return {};
  return std::span(before_.dampers)
      .subspan(static_cast<size_t>(pair->first_damper), static_cast<size_t>(pair->patches));
}

// The one patch of a pair, which had one or none before.
void PatchTangential::Range::add_alone(const Pair& pair) {
  PairTarget to{.load = &pair.load, .tangential = &pair.now.force, .book = &pair.book};
  if (pair.kind.rough) {
    to.spring = &all_.springs_[pair.to.spring];
    to.spring->key = {polygon_kernel, pair.a, pair.b, 0};
    to.spring->accounted = true;
  }
  if (pair.damping) {
    to.damping = pair.damping;
    to.damper = &all_.now_.dampers[static_cast<size_t>(pair.to.damper)];
    if (!pair.kind.damped) *to.damping = {}, *to.damper = {};
  }
  const std::span<const PatchDamper> dampers = all_.dampers_of(pair.before);
  batch_.add(all_.scene_, pair.kind,
             {.a = pair.a,
              .b = pair.b,
              .integral = pair.integral,
              .law = &pair.law,
              .touched = pair.before != nullptr,
              .begins = ancestors_ == 0,
              .last = pair.last,
              .damper = dampers.empty() ? nullptr : &dampers[0],
              .spring = pair.springs.empty() ? 0 : pair.springs[0].force},
             to);
}

void PatchTangential::Range::step_patches(const Pair& pair) {
  const bool one_each = pair.kind.rough && !all_.edgewise();
  pair.book = {};
  find_shares(pair.before);
  dampers_.assign(patches_.size(), {});
  if (pair.kind.damped) {
    inherit(all_.dampers_of(pair.before), dampers_,
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
  const PairScene& scene = all_.scene_;
  Sum sum{.rate = pair_rate(*scene.now, pair.a, pair.b)};
  for (size_t j = 0; j < patches_.size(); ++j) {
    const PairWork work{.a = pair.a,
                        .b = pair.b,
                        .integral = &patches_[j],
                        .law = &pair.law,
                        .touched = pair.before != nullptr,
                        .begins = ancestors_ == 0,
                        .last = pair.last,
                        .damper = &dampers_[j],
                        .spring = one_each ? patch_springs_[j].force : 0};
    const PatchForces<double> forces =
        step_patch(scene, work, {one_each, pair.kind.damped}, dampers_[j]);
    sum.force = sum.force + forces.all;
    sum.damping = sum.damping + forces.damping;
    if (!one_each) continue;
    sum.held_a.add(forces.held_a, 1);
    sum.held_b.add(forces.held_b, 1);
    Spring& spring = all_.springs_[pair.to.spring + j];
    spring = {{polygon_kernel, pair.a, pair.b, static_cast<int>(j)},
              forces.spring,
              pair.law.friction.tangential_stiffness * scene.thickness,
              {forces.tangent.x, forces.tangent.y},
              true};
    pair.book.energy += spring.energy();
    pair.book.loss += forces.lost;
  }
  if (one_each && !inherit_whole()) pair.book.loss = lost_by_balance(pair, sum);
  if (pair.kind.rough && all_.edgewise()) per_edge(pair, sum);
  pair.now.force = sum.force;
  if (pair.damping) {
    std::ranges::copy(dampers_, all_.now_.dampers.begin() + pair.to.damper);
    *pair.damping = {};
  }
  if (pair.damping && pair.kind.damped) {
    *pair.damping = {.damping = sum.damping, .rate = sum.rate};
    const PairDamping none{.rate = sum.rate};
    pair.book.damping_loss = close_damping(pair.last ? *pair.last : none, scene.dt, *pair.damping);
  }
  load_pair(scene, {.a = pair.a, .b = pair.b, .integral = pair.integral, .law = &pair.law},
            sum.force, sum.held_a, sum.held_b, pair.load);
}

// What the patches before hand down to those of now: everything to the only heir, otherwise in
// proportion to the normal forces of those that share boundary with it. Forces are neither invented
// nor lost.
void PatchTangential::Range::find_shares(const PairHistory* before) {
  const size_t heirs = patches_.size();
  if (ancestors_ == 0 || (ancestors_ == 1 && heirs == 1)) return;
  shared_length({all_.before_.runs.data() + before->first_run, static_cast<size_t>(before->runs)},
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
double PatchTangential::Range::lost_by_balance(const Pair& pair, const Sum& sum) const {
  double power = (sum.force - sum.damping).power(sum.rate);
  if (pair.before) {
    const PairForce damping = pair.last ? pair.last->damping : PairForce();
    power += (pair.before->force - damping).power(sum.rate);
  }
  double lost = -all_.scene_.dt / 2 * power;
  for (const Spring& spring : pair.springs) lost += spring.energy();
  return lost - pair.book.energy;
}

// The older law, for comparison (Eq. 9): a spring along every edge of the overlap. Edges that slope
// against the motion meet a false tangential force.
void PatchTangential::Range::per_edge(const Pair& pair, Sum& sum) {
  const Vec2 between = all_.surfaces_.between(pair.a, pair.b);
  const PairRate& rate = sum.rate;
  const double stiffness = pair.law.friction.tangential_stiffness * all_.thickness_;
  const double normal_stiffness = pair.law.normal_stiffness * all_.thickness_;
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
        follow(before, slip.dot(tangent) * all_.scene_.dt, stiffness,
               pair.law.friction.coefficient * normal_stiffness * run.force.norm(), pair.book);
    *next = {key, force, stiffness, tangent, true};
    pair.book.energy += (next++)->energy();
    const double arm_a = cross(run.centre, tangent), arm_b = cross(behind, tangent);
    sum.force = sum.force + force * PairForce{tangent.x(), tangent.y(), arm_a, -arm_b};
    sum.held_a.add(stiffness, tangent.x(), tangent.y(), arm_a);
    sum.held_b.add(stiffness, tangent.x(), tangent.y(), arm_b);
  }
  while (old != pair.springs.end()) lost();
}

void PatchTangential::add_to(std::span<ContactRecord> patches, std::span<const BoundaryRun> runs,
                             std::span<const Spring> springs) const {
  const BoxPair pair{patches[0].a, patches[0].b};
  const auto found = std::ranges::partition_point(now_.pairs, [&](const PairHistory& p) {
    return BoxPair{p.a, p.b} < pair;
  });
  if (found == now_.pairs.end() || BoxPair{found->a, found->b} != pair) return;
  if (found->patches == 0) return;
  for (size_t j = 0; table_.damped() && j < patches.size(); ++j) {
    const PatchDamper& damper = now_.dampers[static_cast<size_t>(found->first_damper) + j];
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
