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

std::span<const PatchDamper> PatchTangential::Lists::dampers_of(const PairMemory& pair) const {
  if (pair.split < 0) return {};
  const Place& place = places[static_cast<size_t>(pair.split)];
  return {dampers.data() + place.first_damper, static_cast<size_t>(place.dampers)};
}

std::span<const Spring> PatchTangential::Lists::springs_of(const PairMemory& pair) const {
  if (pair.split < 0) return {};
  const Place& place = places[static_cast<size_t>(pair.split)];
  return {springs.data() + place.first_spring, static_cast<size_t>(place.springs)};
}

void PatchTangential::put_in_order(SlotOrder& order) {
  order.apply(memory_);
  if (table_.damped()) order.apply(damping_);
}

void PatchTangential::begin_step(const Kinematics& now, double dt, FrictionMemory& memory) {
  kinematics_ = now;
  scene_.now = &kinematics_;
  scene_.dt = dt;
  if (!adopt()) {
    const auto grow = [&](auto& list) {  // large scenes need the memory
      list.reserve(pairs_.slots());
      list.resize(pairs_.slots());
    };
    grow(memory_);
    if (table_.damped()) grow(damping_);
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
    const Tangential kind = kind_of(table_.between(pair.a, pair.b));
    const auto patches = static_cast<int>(pairs_.patches(pair).size());
    const int listed = patches == 1 ? 0 : patches;
    next.runs = kind.any() ? static_cast<int>(pairs_.runs(pair).size()) : 0;
    next.dampers = kind.any() && table_.damped() ? listed : 0;
    next.springs = 0;
    if (kind.rough) next.springs = per_edge_ ? next.runs : listed;
    now_.places[static_cast<size_t>(pair.split)] = next;
    next.first_run += next.runs;
    next.first_damper += next.dampers;
    next.first_spring += next.springs;
  }
  now_.runs.resize(static_cast<size_t>(next.first_run));
  now_.dampers.resize(static_cast<size_t>(next.first_damper));
  now_.springs.resize(static_cast<size_t>(next.first_spring));
}

void PatchTangential::end_step(FrictionMemory& memory) {
  for (const PairBook& book : books_) memory.add(book);
}

// Of a pair that touches no more: in the first half of this step its last force has still acted.
void PatchTangential::release(const Left& last, FrictionMemory& memory) const {
  const PairRate rate = pair_rate(kinematics_, last.a, last.b);
  const double dt = scene_.dt;
  memory.lose(last.energy - dt / 2 * (last.force.power(rate) - last.damping.damping.power(rate)));
  if (table_.damped()) memory.damp(-dt / 2 * last.damping.damping.power(rate));
}

void PatchTangential::release_ended(FrictionMemory& memory) {
  for (const Left& last : left_) release(last, memory);
  left_.clear();
  for (const PairInTouch& pair : pairs_.ended()) {
    PairMemory& old = memory_[static_cast<size_t>(pair.slot)];
    DampingMemory* const damping = damping_of(pair);
    if (old.touched()) {
      std::vector<Spring>& springs = ranges_[0].springs_before;
      springs.clear();
      add_springs(pair, old, before_, springs);
      double energy = 0;
      for (const Spring& spring : springs) energy += spring.energy();
      release({pair.a, pair.b, old.force, damping ? damping->pair : PairDamping(), energy}, memory);
    }
    old = {};
    if (damping) *damping = {};
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
  if (table_.damped()) fetch(damping_[static_cast<size_t>(pair.slot)]);
  __builtin_prefetch(&kinematics_.pose_rate[3 * static_cast<size_t>(pair.b)]);
}

void PatchTangential::Range::step_pair(const PairInTouch& touching, PairLoad& load,
                                       PairBook& book) {
  const PairLaw& law = all_.table_.between(touching.a, touching.b);
  const Tangential kind = all_.kind_of(law);
  PairMemory& memory = all_.memory_[static_cast<size_t>(touching.slot)];
  PairWork work{.a = touching.a,
                .b = touching.b,
                .integral = &all_.pairs_.integral(touching),
                .law = &law,
                .load = &load};
  book = {};
  if (!kind.any()) {
    memory = {.patches = 0};
    if (DampingMemory* const damping = all_.damping_of(touching)) *damping = {};
    batch_.add(all_.scene_, kind, work);
    return;
  }
  work.memory = &memory;
  work.damping = all_.damping_of(touching);
  work.book = &book;
  const bool split = touching.split >= 0;
  if (!split && memory.patches <= 1) {
    if (work.damping && !kind.damped) *work.damping = {};
    batch_.add(all_.scene_, kind, work);
    return;
  }
  runs_ = all_.pairs_.runs(touching);
  patches_ = all_.pairs_.patches(touching);
  Place to;
  if (split) to = all_.now_.places[static_cast<size_t>(touching.split)];
  std::ranges::copy(runs_, all_.now_.runs.begin() + to.first_run);
  if (patches_.size() == 1 && memory.patches <= 1 && !all_.per_edge_) {
    memory.split = touching.split;
    if (work.damping && !kind.damped) *work.damping = {};
    batch_.add(all_.scene_, kind, work);
    return;
  }
  before_ = memory;
  memory.split = touching.split;
  step_patches(touching, work, kind, to);
}

void PatchTangential::Range::step_patches(const PairInTouch& touching, const PairWork& pair,
                                          Tangential kind, const Place& to) {
  const bool one_each = kind.rough && !all_.per_edge_;
  damping_before_ = pair.damping ? *pair.damping : DampingMemory();
  ancestors_ = static_cast<size_t>(std::max(before_.patches, 0));
  springs_before.clear();
  all_.add_springs({pair.a, pair.b, 0}, before_, all_.before_, springs_before);
  find_shares();
  dampers_.assign(patches_.size(), {});
  if (kind.damped) {
    const std::span<const PatchDamper> before =
        before_.patches == 1 ? std::span<const PatchDamper>(&damping_before_.patch, 1)
                             : all_.before_.dampers_of(before_);
    inherit(before, dampers_,
            [](PatchDamper& heir, double share, const PatchDamper& old, const PairIntegral&) {
              heir.elastic = heir.elastic + share * old.elastic;
              heir.damping = heir.damping + share * old.damping;
              heir.tangential += share * old.tangential;
              heir.stiffness += share * old.stiffness;
            });
  }
  if (one_each) {
    inherit(std::span<const Spring>(springs_before), patch_springs_,
            [](Spring& heir, double share, const Spring& old, const PairIntegral& patch) {
              Vec2 tangent = tangent_of(patch.force);
              if (tangent == Vec2::Zero()) tangent = old.tangent;
              heir.force += share * old.force * tangent.dot(old.tangent);
            });
  }
  const PairScene& scene = all_.scene_;
  PairMemory& now = *pair.memory;
  now.patches = static_cast<int>(patches_.size());
  now.spring = 0;
  now.tangent = {};
  Sum sum{.rate = pair_rate(*scene.now, pair.a, pair.b)};
  forces_.resize(patches_.size());
  std::array<PairMemory, kComparedLanes> memory;
  std::array<DampingMemory, kComparedLanes> damping;
  std::array<PairWork, kComparedLanes> work;
  for (size_t first = 0; first < patches_.size(); first += kComparedLanes) {
    const size_t count = std::min<size_t>(kComparedLanes, patches_.size() - first);
    for (size_t k = 0; k < count; ++k) {
      const size_t j = first + k;
      memory[k] = {.spring = one_each ? patch_springs_[j].force : 0, .patches = before_.patches};
      damping[k] = {damping_before_.pair, dampers_[j]};
      work[k] = pair;
      work[k].integral = &patches_[j];
      work[k].memory = &memory[k];
      work[k].damping = &damping[k];
    }
    find_patch_forces(scene, {work.data(), count}, {one_each, kind.damped}, &dampers_[first],
                      &forces_[first]);
  }
  for (size_t j = 0; j < patches_.size(); ++j) {
    const PatchForces<double>& forces = forces_[j];
    sum.force = sum.force + forces.all;
    sum.damping = sum.damping + forces.damping;
    if (!one_each) continue;
    sum.held_a.add(forces.held_a, 1);
    sum.held_b.add(forces.held_b, 1);
    const Spring spring{{polygon_kernel, pair.a, pair.b, static_cast<int>(j)},
                        forces.spring,
                        pair.law->friction.tangential_stiffness * scene.thickness,
                        {forces.tangent.x, forces.tangent.y}};
    if (to.springs > 0) {
      all_.now_.springs[static_cast<size_t>(to.first_spring) + j] = spring;
    } else {
      now.spring = spring.force;
      now.tangent = {spring.tangent.x(), spring.tangent.y()};
    }
    pair.book->energy += spring.energy();
  }
  if (one_each) pair.book->loss = lost_by_balance(pair, sum);
  if (kind.rough && all_.per_edge_) per_edge(pair, all_.pairs_.whole_runs(touching), to, sum);
  now.force = sum.force;
  if (pair.damping) {
    *pair.damping = {};
    if (patches_.size() == 1) {
      pair.damping->patch = dampers_[0];
    } else {
      std::ranges::copy(dampers_, all_.now_.dampers.begin() + to.first_damper);
    }
  }
  if (pair.damping && kind.damped) {
    pair.damping->pair = {.damping = sum.damping, .rate = sum.rate};
    PairForce both = sum.damping;
    if (before_.touched()) both = both + damping_before_.pair.damping;
    pair.book->damping_loss = -scene.dt / 2 * both.power(sum.rate);
  }
  load_pair(scene, pair, sum.force, sum.held_a, sum.held_b);
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

// What friction has taken from the bodies and the springs do not store.
double PatchTangential::Range::lost_by_balance(const PairWork& pair, const Sum& sum) const {
  double power = (sum.force - sum.damping).power(sum.rate);
  if (before_.touched()) {
    power += (before_.force - damping_before_.pair.damping).power(sum.rate);
  }
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
  const double stiffness = pair.law->friction.tangential_stiffness * all_.thickness_;
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
