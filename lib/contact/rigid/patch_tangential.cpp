#include "lib/contact/rigid/patch_tangential.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace apothem {
namespace {

constexpr size_t kPairsAheadOfStep = 8;  // number of pairs that are prefetched, for large scenes

// The force of a spring after a slip in m. The spring loses the mean force times the part of the
// slip that it does not follow.
double follow(const CoulombSpring<double>& spring, double force, double slip, PairLedger& book) {
  const double trial = spring.trial(force, slip), next = spring.within(trial);
  book.loss += (force + next) * (trial - next) / (2 * spring.stiffness);
  return next;
}

}  // namespace

PatchTangential::PatchTangential(const Surfaces& surfaces, const PairIntegrals& pairs,
                                 const ContactLaw& law, const PairTable& table,
                                 FrictionMemory& memory, double thickness, int threads)
    : surfaces_(surfaces),
      pairs_(pairs),
      per_edge_(law.friction_law == FrictionLaw::per_edge),
      table_(table),
      memory_(memory),
      thickness_(thickness),
      ranges_(static_cast<size_t>(threads), Range(*this)),
      scene_{surfaces_, thickness_} {}

void PatchTangential::begin_step(const Kinematics& now, double dt) {
  kinematics_ = now;
  scene_.now = &kinematics_;
  scene_.dt = dt;
  make_room();
}

// Every pair gets its range in the lists, so that threads need not wait for each other.
void PatchTangential::make_room() {
  const std::vector<PairInTouch>& touching = pairs_.touching();
  books_.assign((touching.size() + kBlock - 1) / kBlock, {});
  for (Range& range : ranges_) range.ended.clear();
  places_.clear();
  Place end{touching.size(), 0};
  if (pairs_.split_pairs() > 0) {
    end = {};
    for (const PairInTouch& pair : touching) {
      places_.push_back(end);
      const size_t runs = pairs_.runs(pair).size();
      end.spring += per_edge_ ? runs : pairs_.patches(pair).size();
      if (table_.between(pair.a, pair.b).rough()) end.run += runs;
    }
    places_.push_back(end);
  }
  springs_ = memory_.make_room(end.spring);
  runs_ = memory_.runs().make_room(end.run);
}

void PatchTangential::end_step() {
  for (const Range& range : ranges_) {
    for (const double lost : range.ended) memory_.lose(lost);
  }
  for (const PairLedger& book : books_) memory_.add(book);
}

// The energy lost by the springs of a pair that no longer touches. In the first half of this step
// its last force has still acted.
double PatchTangential::lost_at_end(std::span<const Spring> springs) const {
  double energy = 0;
  PairForce force;
  for (const Spring& spring : springs) {
    energy += spring.energy();
    force = force + spring.on_bodies;
  }
  const ContactKey& pair = springs.front().key;
  return energy - scene_.dt / 2 * force.power(pair_rate(kinematics_, pair.a, pair.b));
}

// The springs of a pair. The guess is their index in the last step, which is right unless there has
// been an evaluation or an undone step since.
std::span<Spring> PatchTangential::springs_of(const PairInTouch& pair) const {
  const auto number = static_cast<size_t>(pair.number);
  const size_t guess = number < places_.size() ? place_of(number).spring : number;
  return records_of_pair(memory_.springs(), {polygon_kernel, pair.a, pair.b, 0}, guess);
}

std::optional<PairForce> PatchTangential::friction_of(RigidIndex a, RigidIndex b,
                                                      std::span<const Spring> springs,
                                                      std::span<const PatchSegment> runs) const {
  const ContactKey pair{polygon_kernel, a, b, 0};
  const std::span<const Spring> all = records_of_pair(springs, pair);
  const bool alone =
      per_edge_ ? std::ranges::all_of(records_of_pair(runs, pair),
                                      [](const PatchSegment& run) { return run.place.patch == 0; })
                : all.size() == 1;
  if (!alone) return {};
  PairForce sum;
  for (const Spring& spring : all) sum = sum + spring.on_bodies;
  return sum;
}

double PatchTangential::spring_in(const PairInTouch& pair, size_t patch) const {
  if (per_edge_) return 0;
  const std::span<const Spring> springs = springs_of(pair);
  return patch < springs.size() ? springs[patch].force : 0;
}

void PatchTangential::keep_push(const PairInTouch& pair, size_t patch, double push) {
  if (per_edge_) return;
  const std::span<Spring> springs = springs_of(pair);
  if (patch < springs.size()) springs[patch].push = push;
}

void PatchTangential::add_to(std::span<ContactRecord> patches, std::span<const BoundarySegment> runs,
                             const PairInTouch& pair) const {
  const std::span<const Spring> springs = springs_of(pair);
  for (size_t i = 0; i < springs.size(); ++i) {
    const int patch = per_edge_ ? runs[i].patch : springs[i].key.part;
    patches[static_cast<size_t>(patch)].tangential += springs[i].force * springs[i].tangent;
  }
}

// Pairs that have ended and lie between the pairs of this range and those of the next one belong to
// this range.
void PatchTangential::Range::begin(size_t first, size_t end) {
  const std::vector<PairInTouch>& touching = all_.pairs_.touching();
  const auto key = [&](size_t number) -> ContactKey {
    return {polygon_kernel, touching[number].a, touching[number].b, 0};
  };
  walk_ = all_.memory_.before(
      first == 0 ? ContactKey{polygon_kernel, 0, 0, 0} : key(first),
      end == touching.size() ? ContactKey{polygon_kernel + 1, 0, 0, 0} : key(end));
}

void PatchTangential::Range::finish() {
  walk_.finish(
      [&](std::span<const Spring> springs) { ended.push_back(all_.lost_at_end(springs)); });
}

void PatchTangential::Range::step_block(size_t first, size_t end, PairLedger& book) {
  const std::vector<PairInTouch>& touching = all_.pairs_.touching();
  const size_t count = end - first;
  loads.resize(count);
  books_.resize(count);
  for (size_t k = 0; k < count; ++k) {
    const size_t i = first + k;
    if (i + kPairsAheadOfStep < touching.size()) all_.fetch(touching[i + kPairsAheadOfStep]);
    step_pair(i, loads[k], books_[k]);
  }
  batch_.flush(all_.scene_);
  for (const PairLedger& pair : books_) book.add(pair);
}

// Prefetches the data of a pair.
void PatchTangential::fetch(const PairInTouch& pair) const {
  const auto* const integral = reinterpret_cast<const char*>(&pairs_.integral(pair));
  for (size_t at = 0; at < sizeof(PairIntegral); at += 64) __builtin_prefetch(integral + at);
  surfaces_.fetch_inertia(pair.b);
  __builtin_prefetch(&kinematics_.pose_rate[3 * static_cast<size_t>(pair.b)]);
}

void PatchTangential::Range::step_pair(size_t number, PairLoad& load, PairLedger& book) {
  const PairInTouch& touching = all_.pairs_.touching()[number];
  const ContactKey key{polygon_kernel, touching.a, touching.b, 0};
  const PairLaw& law = all_.table_.between(touching.a, touching.b);
  before_ = walk_.find(
      key, [&](std::span<const Spring> springs) { ended.push_back(all_.lost_at_end(springs)); });
  const size_t first = all_.place_of(number).spring;
  now_ = all_.springs_.subspan(first, all_.place_of(number + 1).spring - first);
  PairWork work{.a = touching.a,
                .b = touching.b,
                .integral = &all_.pairs_.integral(touching),
                .law = &law,
                .load = &load};
  book = {};
  if (!law.rough()) {
    for (size_t j = 0; j < now_.size(); ++j) {
      now_[j] = {.key = {key.law, key.a, key.b, static_cast<int>(j)}};
    }
    batch_.add(all_.scene_, false, work);
    return;
  }
  work.book = &book;
  bool alone = before_.size() <= 1;
  if (touching.split >= 0 || !alone) {
    patches_ = all_.pairs_.patches(touching);
    runs_ = all_.pairs_.runs(touching);
    keep_runs(key, number);
    alone = alone && patches_.size() == 1 && !all_.per_edge_;
  }
  if (alone) {
    now_[0].key = key;
    if (!before_.empty()) work.before = before_.data();
    work.begins = before_.empty();
    work.now = now_.data();
    batch_.add(all_.scene_, true, work);
    return;
  }
  step_patches(touching, work);
}

void PatchTangential::Range::keep_runs(const ContactKey& pair, size_t number) const {
  PatchSegment* to = all_.runs_.data() + all_.place_of(number).run;
  int part = 0;
  for (const SegmentPlace& run : runs_) *to++ = {{pair.law, pair.a, pair.b, part++}, run};
}

void PatchTangential::Range::step_patches(const PairInTouch& touching, const PairWork& pair) {
  const PairScene& scene = all_.scene_;
  Sum sum{.rate = pair_rate(*scene.now, pair.a, pair.b)};
  if (all_.per_edge_) {
    per_edge(pair, all_.pairs_.whole_runs(touching), sum);
  } else {
    find_shares({polygon_kernel, pair.a, pair.b, 0});
    inherit();
    step_springs(pair, sum);
  }
  load_pair(scene, pair, sum.force, sum.held_a, sum.held_b);
}

// Updates one spring for each patch.
void PatchTangential::Range::step_springs(const PairWork& pair, Sum& sum) {
  friction_.resize(patches_.size());
  std::array<PairWork, kComparedLanes> work;
  for (size_t first = 0; first < patches_.size(); first += kComparedLanes) {
    const size_t count = std::min<size_t>(kComparedLanes, patches_.size() - first);
    for (size_t k = 0; k < count; ++k) {
      work[k] = pair;
      work[k].integral = &patches_[first + k];
      work[k].before = &patch_springs_[first + k];
      work[k].begins = before_.empty();
    }
    find_patch_friction(all_.scene_, {work.data(), count}, &friction_[first]);
  }
  for (size_t j = 0; j < patches_.size(); ++j) {
    const PatchFriction<double>& friction = friction_[j];
    sum.force = sum.force + friction.force;
    sum.held_a.add(friction.held_a, 1);
    sum.held_b.add(friction.held_b, 1);
    now_[j] = {.key = {polygon_kernel, pair.a, pair.b, static_cast<int>(j)},
               .force = friction.spring,
               .stiffness = friction.stiffness,
               .tangent = {friction.tangent.x, friction.tangent.y},
               .push = patch_springs_[j].push,
               .on_bodies = friction.force};
    pair.book->energy += now_[j].energy();
  }
  pair.book->loss = lost_by_balance(pair, sum);
}

// Contact matching: finds the fraction of each earlier patch's spring that goes to each present
// patch. If only one present patch shares boundary with it, that patch gets all of it; otherwise
// the fractions are proportional to the normal forces. Forces are neither created nor lost.
void PatchTangential::Range::find_shares(const ContactKey& pair) {
  if (before_.empty()) return;
  runs_before_.clear();
  const std::span<const PatchSegment> runs = all_.memory_.runs().before();
  for (const PatchSegment& run : records_of_pair(runs, pair)) {
    runs_before_.push_back(run.place);
  }
  const size_t heirs = patches_.size();
  shared_length(runs_before_, static_cast<int>(before_.size()), runs_, static_cast<int>(heirs),
                shares_);
  for (size_t i = 0; i < before_.size(); ++i) {
    double* const share = shares_.data() + i * heirs;
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
  for (size_t i = 0; i < before_.size(); ++i) {
    const Spring& old = before_[i];
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

// The energy that friction has taken from the bodies and the springs do not store.
double PatchTangential::Range::lost_by_balance(const PairWork& pair, const Sum& sum) const {
  PairForce force_before;
  for (const Spring& spring : before_) force_before = force_before + spring.on_bodies;
  double power = sum.force.power(sum.rate);
  power += force_before.power(sum.rate);
  double lost = -all_.scene_.dt / 2 * power;
  for (const Spring& spring : before_) lost += spring.energy();
  return lost - pair.book->energy;
}

// The older friction law, for comparison (Eq. 9): a spring along every edge of the overlap. Edges
// that are inclined to the motion get a false tangential force.
void PatchTangential::Range::per_edge(const PairWork& pair, std::span<const BoundarySegment> runs,
                                      Sum& sum) {
  const Vec2 between = all_.surfaces_.between(pair.a, pair.b);
  const PairRate& rate = sum.rate;
  const double stiffness = pair.law->one_stiffness() * all_.thickness_;
  const double normal_stiffness = pair.law->normal_stiffness * all_.thickness_;
  const int edges_of_a = all_.surfaces_.shapes().view(pair.a).size;
  auto next = now_.begin();
  auto old = before_.begin();
  const auto end_one = [&] { pair.book->loss += (old++)->energy(); };  // the edge no longer touches
  for (const BoundarySegment& run : runs) {
    const ContactKey key{polygon_kernel, pair.a, pair.b,
                         run.of_a ? run.edge : edges_of_a + run.edge};
    while (old != before_.end() && old->key < key) end_one();
    double before = 0;
    if (old != before_.end() && old->key == key) before = (old++)->force;
    const Vec2 tangent = tangent_of(run.force);
    const Vec2 behind = run.centre + between;
    const Vec2 slip = Vec2(rate.x, rate.y) + cross(rate.a, run.centre) - cross(rate.b, behind);
    const double force = follow({stiffness, friction_limit(pair.law->friction.coefficient,
                                                           normal_stiffness * run.force.norm())},
                                before, slip.dot(tangent) * all_.scene_.dt, *pair.book);
    const double arm_a = cross(run.centre, tangent), arm_b = cross(behind, tangent);
    *next = {.key = key,
             .force = force,
             .stiffness = stiffness,
             .tangent = tangent,
             .on_bodies = force * PairForce{tangent.x(), tangent.y(), arm_a, -arm_b}};
    sum.force = sum.force + next->on_bodies;
    pair.book->energy += (next++)->energy();
    sum.held_a.add(stiffness, tangent.x(), tangent.y(), arm_a);
    sum.held_b.add(stiffness, tangent.x(), tangent.y(), arm_b);
  }
  while (old != before_.end()) end_one();
}

}  // namespace apothem
