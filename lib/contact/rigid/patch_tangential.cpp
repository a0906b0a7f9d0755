#include "lib/contact/rigid/patch_tangential.hpp"

#include <algorithm>
#include <cmath>

namespace apothem {
namespace {

constexpr size_t kPairsAheadOfStep = 8;  // that are fetched, for large scenes

// The force of a spring after a slip in m. What it loses is the mean force times the slip that it
// does not follow.
double follow(const CoulombSpring<double>& spring, double force, double slip, PairBook& book) {
  const double trial = spring.trial(force, slip), next = spring.within(trial);
  book.loss += (force + next) * (trial - next) / (2 * spring.stiffness);
  return next;
}

}  // namespace

PatchTangential::PatchTangential(const Surfaces& surfaces, const PairIntegrals& pairs,
                                 const ContactLaw& law, const PairTable& table, double thickness,
                                 int threads)
    : surfaces_(surfaces),
      pairs_(pairs),
      per_edge_(law.friction_law == FrictionLaw::per_edge),
      table_(table),
      thickness_(thickness),
      threads_(threads),
      ranges_(static_cast<size_t>(threads_.count()), Range(*this)),
      scene_{surfaces_, thickness_} {}

std::span<const RunPlace> PatchTangential::Lists::runs_of(const PairMemory& pair) const {
  if (pair.split < 0) return {};
  const Place& place = places[static_cast<size_t>(pair.split)];
  return {runs.data() + place.first_run, static_cast<size_t>(place.runs)};
}

std::span<const Spring> PatchTangential::Lists::springs_of(const PairMemory& pair) const {
  if (pair.split < 0) return {};
  const Place& place = places[static_cast<size_t>(pair.split)];
  return {springs.data() + place.first_spring, static_cast<size_t>(place.springs)};
}

void PatchTangential::put_in_order(SlotOrder& order) { order.apply(memory_); }

void PatchTangential::begin_step(const Kinematics& now, double dt, FrictionMemory& memory) {
  kinematics_ = now;
  scene_.now = &kinematics_;
  scene_.dt = dt;
  if (!adopt()) {
    memory_.reserve(pairs_.slots());  // large scenes need the memory
    memory_.resize(pairs_.slots());
  }
  std::swap(now_, before_);
  make_room();
  release_ended(memory);
}

// Every pair that is split has its place in the lists, so that threads do not wait for each other.
void PatchTangential::make_room() {
  const std::vector<PairInTouch>& touching = pairs_.touching();
  books_.assign((touching.size() + kBlock - 1) / kBlock, {});
  now_.places.resize(pairs_.split_pairs());
  Place next;
  for (size_t i = 0; i < touching.size() && !now_.places.empty(); ++i) {
    const PairInTouch& pair = touching[i];
    if (pair.split < 0) continue;
    const bool rough = table_.between(pair.a, pair.b).rough();
    const auto patches = static_cast<int>(pairs_.patches(pair).size());
    next.runs = rough ? static_cast<int>(pairs_.runs(pair).size()) : 0;
    next.springs = 0;
    if (rough) next.springs = per_edge_ ? next.runs : patches == 1 ? 0 : patches;
    now_.places[static_cast<size_t>(pair.split)] = next;
    next.first_run += next.runs;
    next.first_spring += next.springs;
  }
  now_.runs.resize(static_cast<size_t>(next.first_run));
  now_.springs.resize(static_cast<size_t>(next.first_spring));
}

void PatchTangential::end_step(FrictionMemory& memory) {
  for (const PairBook& book : books_) memory.add(book);
}

// Of a pair that touches no more: in the first half of this step its last force has still acted.
void PatchTangential::release(const Left& last, FrictionMemory& memory) const {
  memory.lose(last.energy -
              scene_.dt / 2 * last.force.power(pair_rate(kinematics_, last.a, last.b)));
}

void PatchTangential::release_ended(FrictionMemory& memory) {
  for (const Left& last : left_) release(last, memory);
  left_.clear();
  for (const PairInTouch& pair : pairs_.ended()) {
    PairMemory& old = memory_[static_cast<size_t>(pair.slot)];
    if (old.touched()) {
      std::vector<Spring>& springs = ranges_[0].springs_before;
      springs.clear();
      add_springs(pair, old, before_, springs);
      double energy = 0;
      for (const Spring& spring : springs) energy += spring.energy();
      release({pair.a, pair.b, old.force, energy}, memory);
    }
    old = {};
  }
}

void PatchTangential::Range::step_block(int first, int end, PairBook& book) {
  const std::vector<PairInTouch>& touching = all_.pairs_.touching();
  const size_t count = static_cast<size_t>(end - first);
  loads.resize(count);
  books_.resize(count);
  for (size_t k = 0; k < count; ++k) {
    const auto i = static_cast<size_t>(first) + k;
    if (i + kPairsAheadOfStep < touching.size()) all_.fetch(touching[i + kPairsAheadOfStep]);
    step_pair(touching[i], loads[k], books_[k]);
  }
  batch_.flush(all_.scene_);
  for (const PairBook& pair : books_) book.add(pair);
}

// Begins to bring what a pair remembers to the cache.
void PatchTangential::fetch(const PairInTouch& pair) const {
  const auto fetch = [](const auto& object) {
    const char* const first = reinterpret_cast<const char*>(&object);
    for (size_t at = 0; at < sizeof(object); at += 64) __builtin_prefetch(first + at);
    __builtin_prefetch(first + sizeof(object) - 1);
  };
  surfaces_.fetch_inertia(pair.b);
  fetch(pairs_.integral(pair));
  fetch(memory_[static_cast<size_t>(pair.slot)]);
  __builtin_prefetch(&kinematics_.pose_rate[3 * static_cast<size_t>(pair.b)]);
}

void PatchTangential::Range::step_pair(const PairInTouch& touching, PairLoad& load,
                                       PairBook& book) {
  const PairLaw& law = all_.table_.between(touching.a, touching.b);
  const bool rough = law.rough();
  PairMemory& memory = all_.memory_[static_cast<size_t>(touching.slot)];
  PairWork work{.a = touching.a,
                .b = touching.b,
                .integral = &all_.pairs_.integral(touching),
                .law = &law,
                .load = &load};
  book = {};
  if (!rough) {
    memory = {.patches = 0};
    batch_.add(all_.scene_, false, work);
    return;
  }
  work.memory = &memory;
  work.book = &book;
  const bool split = touching.split >= 0;
  if (!split && memory.patches <= 1) {
    batch_.add(all_.scene_, true, work);
    return;
  }
  runs_ = all_.pairs_.runs(touching);
  patches_ = all_.pairs_.patches(touching);
  Place to;
  if (split) to = all_.now_.places[static_cast<size_t>(touching.split)];
  std::ranges::copy(runs_, all_.now_.runs.begin() + to.first_run);
  if (patches_.size() == 1 && memory.patches <= 1 && !all_.per_edge_) {
    memory.split = touching.split;
    batch_.add(all_.scene_, true, work);
    return;
  }
  before_ = memory;
  memory.split = touching.split;
  step_patches(touching, work, to);
}

void PatchTangential::Range::step_patches(const PairInTouch& touching, const PairWork& pair,
                                          const Place& to) {
  const bool one_each = !all_.per_edge_;
  ancestors_ = static_cast<size_t>(std::max(before_.patches, 0));
  springs_before.clear();
  all_.add_springs({pair.a, pair.b, 0}, before_, all_.before_, springs_before);
  find_shares();
  if (one_each) inherit();
  const PairScene& scene = all_.scene_;
  PairMemory& now = *pair.memory;
  now.patches = static_cast<int>(patches_.size());
  now.spring = now.stiffness = now.push = 0;
  now.tangent = {};
  Sum sum{.rate = pair_rate(*scene.now, pair.a, pair.b)};
  if (one_each) step_springs(pair, to, sum);
  if (all_.per_edge_) per_edge(pair, all_.pairs_.whole_runs(touching), to, sum);
  now.force = sum.force;
  load_pair(scene, pair, sum.force, sum.held_a, sum.held_b);
}

// One spring for each patch.
void PatchTangential::Range::step_springs(const PairWork& pair, const Place& to, Sum& sum) {
  const PairScene& scene = all_.scene_;
  PairMemory& now = *pair.memory;
  friction_.resize(patches_.size());
  std::array<PairMemory, kComparedLanes> memory;
  std::array<PairWork, kComparedLanes> work;
  for (size_t first = 0; first < patches_.size(); first += kComparedLanes) {
    const size_t count = std::min<size_t>(kComparedLanes, patches_.size() - first);
    for (size_t k = 0; k < count; ++k) {
      const Spring& spring = patch_springs_[first + k];
      memory[k] = {.spring = spring.force,
                   .stiffness = spring.stiffness,
                   .push = spring.push,
                   .patches = before_.patches};
      work[k] = pair;
      work[k].integral = &patches_[first + k];
      work[k].memory = &memory[k];
    }
    find_patch_friction(scene, {work.data(), count}, &friction_[first]);
  }
  for (size_t j = 0; j < patches_.size(); ++j) {
    const PatchFriction<double>& friction = friction_[j];
    sum.force = sum.force + friction.force;
    sum.held_a.add(friction.held_a, 1);
    sum.held_b.add(friction.held_b, 1);
    const Spring spring{{polygon_kernel, pair.a, pair.b, static_cast<int>(j)},
                        friction.spring,
                        friction.stiffness,
                        {friction.tangent.x, friction.tangent.y},
                        patch_springs_[j].push};
    if (to.springs > 0) {
      all_.now_.springs[static_cast<size_t>(to.first_spring) + j] = spring;
    } else {
      now.spring = spring.force;
      now.stiffness = spring.stiffness;
      now.push = spring.push;
      now.tangent = friction.tangent;
    }
    pair.book->energy += spring.energy();
  }
  pair.book->loss = lost_by_balance(pair, sum);
}

// What the patches before hand down to those of now: everything to the only heir, otherwise in
// proportion to the normal forces of those that share boundary with it. Forces are neither invented
// nor lost.
void PatchTangential::Range::find_shares() {
  const size_t heirs = patches_.size();
  if (ancestors_ == 0 || (ancestors_ == 1 && heirs == 1)) return;
  shared_length(all_.before_.runs_of(before_), before_.patches, runs_, static_cast<int>(heirs),
                shares_);
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

void PatchTangential::Range::inherit() {
  patch_springs_.assign(patches_.size(), {});
  if (springs_before.size() == 1 && patches_.size() == 1) {
    patch_springs_[0] = springs_before[0];
    return;
  }
  for (size_t i = 0; i < springs_before.size(); ++i) {
    const Spring& old = springs_before[i];
    for (size_t j = 0; j < patches_.size(); ++j) {
      const double share = shares_[i * patches_.size() + j];
      if (!(share > 0)) continue;
      Vec2 tangent = tangent_of(patches_[j].force);
      if (tangent == Vec2::Zero()) tangent = old.tangent;
      Spring& heir = patch_springs_[j];
      heir.force += share * old.force * tangent.dot(old.tangent);
      heir.stiffness += share * old.stiffness;
      heir.push += share * old.push;
    }
  }
}

// What friction has taken from the bodies and the springs do not store.
double PatchTangential::Range::lost_by_balance(const PairWork& pair, const Sum& sum) const {
  double power = sum.force.power(sum.rate);
  if (before_.touched()) power += before_.force.power(sum.rate);
  double lost = -all_.scene_.dt / 2 * power;
  for (const Spring& spring : springs_before) lost += spring.energy();
  return lost - pair.book->energy;
}

// The older law, for comparison (Eq. 9): a spring along every edge of the overlap. Edges that slope
// against the motion meet a false tangential force.
void PatchTangential::Range::per_edge(const PairWork& pair, std::span<const BoundaryRun> runs,
                                      const Place& to, Sum& sum) {
  const Vec2 between = all_.surfaces_.between(pair.a, pair.b);
  const PairRate& rate = sum.rate;
  const double stiffness = pair.law->one_stiffness() * all_.thickness_;
  const double normal_stiffness = pair.law->normal_stiffness * all_.thickness_;
  const int edges_of_a = all_.surfaces_.shapes().view(pair.a).size;
  auto next = all_.now_.springs.begin() + to.first_spring;
  auto old = springs_before.begin();
  const auto lost = [&] { pair.book->loss += (old++)->energy(); };  // of an edge that is free again
  for (const BoundaryRun& run : runs) {
    const SpringKey key{polygon_kernel, pair.a, pair.b,
                        run.of_a ? run.edge : edges_of_a + run.edge};
    while (old != springs_before.end() && old->key < key) lost();
    double before = 0;
    if (old != springs_before.end() && old->key == key) before = (old++)->force;
    const Vec2 tangent = tangent_of(run.force);
    const Vec2 behind = run.centre + between;
    const Vec2 slip = Vec2(rate.x, rate.y) + cross(rate.a, run.centre) - cross(rate.b, behind);
    const double force =
        follow({stiffness, pair.law->friction.coefficient * normal_stiffness * run.force.norm()},
               before, slip.dot(tangent) * all_.scene_.dt, *pair.book);
    *next = {key, force, stiffness, tangent};
    pair.book->energy += (next++)->energy();
    const double arm_a = cross(run.centre, tangent), arm_b = cross(behind, tangent);
    sum.force = sum.force + force * PairForce{tangent.x(), tangent.y(), arm_a, -arm_b};
    sum.held_a.add(stiffness, tangent.x(), tangent.y(), arm_a);
    sum.held_b.add(stiffness, tangent.x(), tangent.y(), arm_b);
  }
  while (old != springs_before.end()) lost();
}

}  // namespace apothem
