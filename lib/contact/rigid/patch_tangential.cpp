#include "lib/contact/rigid/patch_tangential.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace apothem {
namespace {

constexpr size_t kPairsAheadOfStep = 8;  // number of pairs that are prefetched, for large scenes

// The force of a spring after a slip in m. The spring loses the mean force times the part of the
// slip that it does not follow.
double follow(const CoulombSpring<double>& spring, double force, double slip, PairLedger& ledger) {
  const double trial = spring.trial(force, slip), next = spring.within(trial);
  ledger.loss += (force + next) * (trial - next) / (2 * spring.stiffness);
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
  ledgers_.assign((touching.size() + kBlock - 1) / kBlock, {});
  for (Range& range : ranges_) range.ended.clear();
  offsets_.clear();
  ListOffsets end{touching.size(), 0};
  if (pairs_.split_pairs() > 0) {
    end = {};
    for (const PairInTouch& pair : touching) {
      offsets_.push_back(end);
      const size_t segments = pairs_.segments(pair).size();
      end.spring += per_edge_ ? segments : pairs_.patches(pair).size();
      if (table_.between(pair.a, pair.b).rough()) end.segment += segments;
    }
    offsets_.push_back(end);
  }
  springs_ = memory_.make_room(end.spring);
  segments_ = memory_.segments().make_room(end.segment);
}

void PatchTangential::end_step() {
  for (const Range& range : ranges_) {
    for (const double lost : range.ended) memory_.lose(lost);
  }
  for (const PairLedger& ledger : ledgers_) memory_.add(ledger);
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
  const size_t guess = number < offsets_.size() ? offsets_of(number).spring : number;
  return records_of_pair(memory_.springs(), {polygon_kernel, pair.a, pair.b, 0}, guess);
}

std::optional<PairForce> PatchTangential::friction_of(
    RigidIndex a, RigidIndex b, std::span<const Spring> springs,
    std::span<const PatchSegment> segments) const {
  const ContactKey pair{polygon_kernel, a, b, 0};
  const std::span<const Spring> all = records_of_pair(springs, pair);
  const bool alone = per_edge_ ? std::ranges::all_of(records_of_pair(segments, pair),
                                                     [](const PatchSegment& segment) {
                                                       return segment.place.patch == 0;
                                                     })
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

bool PatchTangential::tried(const PairInTouch& pair, size_t patch, TriedFriction& friction) const {
  if (per_edge_) return false;
  const std::span<const Spring> now = springs_of(pair);
  if (patch >= now.size()) return false;
  const std::span<const Spring> before =
      records_of_pair(memory_.springs_before(), {polygon_kernel, pair.a, pair.b, 0});
  const bool alone = now.size() == 1 && before.size() <= 1;
  friction = {now[patch], alone ? before.empty() ? &kNoSpring : before.data() : nullptr,
              before.empty(), pair_rate(kinematics_, pair.a, pair.b), scene_.dt};
  return true;
}

void PatchTangential::keep_push(const PairInTouch& pair, size_t patch, double push) {
  if (per_edge_) return;
  const std::span<Spring> springs = springs_of(pair);
  if (patch < springs.size()) springs[patch].push = push;
}

void PatchTangential::add_to(std::span<ContactRecord> patches,
                             std::span<const BoundarySegment> segments,
                             const PairInTouch& pair) const {
  const std::span<const Spring> springs = springs_of(pair);
  for (size_t i = 0; i < springs.size(); ++i) {
    // Pairs that touch by round-off alone may have no patch in another arithmetic.
    if (per_edge_ && i >= segments.size()) break;
    const int patch = per_edge_ ? segments[i].patch : springs[i].key.part;
    if (static_cast<size_t>(patch) >= patches.size()) continue;
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

void PatchTangential::Range::step_block(size_t first, size_t end, PairLedger& ledger) {
  const std::vector<PairInTouch>& touching = all_.pairs_.touching();
  const size_t count = end - first;
  loads.resize(count);
  ledgers_.resize(count);
  for (size_t k = 0; k < count; ++k) {
    const size_t i = first + k;
    if (i + kPairsAheadOfStep < touching.size()) all_.fetch(touching[i + kPairsAheadOfStep]);
    step_pair(i, loads[k], ledgers_[k]);
  }
  batch_.flush(all_.scene_);
  for (const PairLedger& pair : ledgers_) ledger.add(pair);
}

// Prefetches the data of a pair.
void PatchTangential::fetch(const PairInTouch& pair) const {
  const auto* const integral = reinterpret_cast<const char*>(&pairs_.integral(pair));
  for (size_t byte = 0; byte < sizeof(PairIntegral); byte += 64)
    __builtin_prefetch(integral + byte);
  surfaces_.fetch_inertia(pair.b);
  __builtin_prefetch(&kinematics_.pose_rate[3 * static_cast<size_t>(pair.b)]);
}

void PatchTangential::Range::step_pair(size_t number, PairLoad& load, PairLedger& ledger) {
  const PairInTouch& touching = all_.pairs_.touching()[number];
  const ContactKey key{polygon_kernel, touching.a, touching.b, 0};
  const PairLaw& law = all_.table_.between(touching.a, touching.b);
  before_ = walk_.find(
      key, [&](std::span<const Spring> springs) { ended.push_back(all_.lost_at_end(springs)); });
  const size_t first = all_.offsets_of(number).spring;
  now_ = all_.springs_.subspan(first, all_.offsets_of(number + 1).spring - first);
  PairWork work{.a = touching.a,
                .b = touching.b,
                .integral = &all_.pairs_.integral(touching),
                .law = &law,
                .load = &load};
  ledger = {};
  if (!law.rough()) {
    for (size_t j = 0; j < now_.size(); ++j) {
      now_[j] = {.key = {key.law, key.a, key.b, static_cast<int>(j)}};
    }
    batch_.add(all_.scene_, false, work);
    return;
  }
  work.ledger = &ledger;
  bool alone = before_.size() <= 1;
  if (touching.list_index >= 0 || !alone) {
    patches_ = all_.pairs_.patches(touching);
    segments_ = all_.pairs_.segments(touching);
    keep_segments(key, number);
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

void PatchTangential::Range::keep_segments(const ContactKey& pair, size_t number) const {
  PatchSegment* next = all_.segments_.data() + all_.offsets_of(number).segment;
  int part = 0;
  for (const SegmentPlace& segment : segments_)
    *next++ = {{pair.law, pair.a, pair.b, part++}, segment};
}

void PatchTangential::Range::step_patches(const PairInTouch& touching, const PairWork& pair) {
  const PairScene& scene = all_.scene_;
  Sum sum{.rate = pair_rate(*scene.now, pair.a, pair.b)};
  if (all_.per_edge_) {
    per_edge(pair, all_.pairs_.whole_segments(touching), sum);
  } else {
    match_patches({polygon_kernel, pair.a, pair.b, 0});
    transfer_springs();
    step_springs(pair, sum);
  }
  load_pair(scene, pair, sum.force, sum.body_stiffness_a, sum.body_stiffness_b);
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
    sum.body_stiffness_a.add(friction.body_stiffness_a, 1);
    sum.body_stiffness_b.add(friction.body_stiffness_b, 1);
    now_[j] = {.key = {polygon_kernel, pair.a, pair.b, static_cast<int>(j)},
               .force = friction.spring,
               .stiffness = friction.stiffness,
               .tangent = {friction.tangent.x, friction.tangent.y},
               .push = patch_springs_[j].push,
               .on_bodies = friction.force};
    pair.ledger->energy += now_[j].energy();
  }
  pair.ledger->loss = lost_by_balance(pair, sum);
}

// Contact matching: finds the fraction of each earlier patch's spring that goes to each present
// patch. If only one present patch shares boundary with it, that patch gets all of it; otherwise
// the fractions are proportional to the normal forces. Forces are neither created nor lost.
void PatchTangential::Range::match_patches(const ContactKey& pair) {
  if (before_.empty()) return;
  segments_before_.clear();
  const std::span<const PatchSegment> segments = all_.memory_.segments().before();
  for (const PatchSegment& segment : records_of_pair(segments, pair)) {
    segments_before_.push_back(segment.place);
  }
  const size_t count = patches_.size();
  shared_length(segments_before_, static_cast<int>(before_.size()), segments_,
                static_cast<int>(count), fractions_);
  for (size_t i = 0; i < before_.size(); ++i) {
    double* const fraction = fractions_.data() + i * count;
    double sum = 0;
    for (size_t j = 0; j < count; ++j) {
      fraction[j] = fraction[j] > 0 ? patches_[j].force.norm() : 0;
      sum += fraction[j];
    }
    for (size_t j = 0; j < count; ++j) fraction[j] = sum > 0 ? fraction[j] / sum : 0;
  }
}

void PatchTangential::Range::transfer_springs() {
  patch_springs_.assign(patches_.size(), {});
  for (size_t i = 0; i < before_.size(); ++i) {
    const Spring& old = before_[i];
    for (size_t j = 0; j < patches_.size(); ++j) {
      const double fraction = fractions_[i * patches_.size() + j];
      if (!(fraction > 0)) continue;
      Vec2 tangent = tangent_of(patches_[j].force);
      if (tangent == Vec2::Zero()) tangent = old.tangent;
      Spring& spring = patch_springs_[j];
      spring.force += fraction * old.force * tangent.dot(old.tangent);
      spring.stiffness += fraction * old.stiffness;
      spring.push += fraction * old.push;
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
  return lost - pair.ledger->energy;
}

// The older friction law, for comparison (Eq. 9): a spring along every edge of the overlap. Edges
// that are inclined to the motion get a false tangential force.
void PatchTangential::Range::per_edge(const PairWork& pair,
                                      std::span<const BoundarySegment> segments, Sum& sum) {
  const Vec2 between = all_.surfaces_.between(pair.a, pair.b);
  const PairRate& rate = sum.rate;
  const double stiffness = pair.law->one_stiffness() * all_.thickness_;
  const double normal_stiffness = pair.law->normal_stiffness * all_.thickness_;
  const FrictionLimit<double> limit = FrictionLimit<double>::of(*pair.law);
  const int edges_of_a = all_.surfaces_.shapes().view(pair.a).size;
  auto next = now_.begin();
  auto old = before_.begin();
  // Books the loss of the spring of an edge that no longer touches.
  const auto end_one = [&] { pair.ledger->loss += (old++)->energy(); };
  for (const BoundarySegment& segment : segments) {
    const ContactKey key{polygon_kernel, pair.a, pair.b,
                         segment.of_a ? segment.edge : edges_of_a + segment.edge};
    while (old != before_.end() && old->key < key) end_one();
    double before = 0;
    if (old != before_.end() && old->key == key) before = (old++)->force;
    const Vec2 tangent = tangent_of(segment.force);
    const Vec2 behind = segment.centre + between;
    const Vec2 slip = Vec2(rate.x, rate.y) + cross(rate.a, segment.centre) - cross(rate.b, behind);
    const double along = slip.dot(tangent);
    const double force = follow({stiffness, limit(normal_stiffness * segment.force.norm(), along)},
                                before, along * all_.scene_.dt, *pair.ledger);
    const double arm_a = cross(segment.centre, tangent), arm_b = cross(behind, tangent);
    *next = {.key = key,
             .force = force,
             .stiffness = stiffness,
             .tangent = tangent,
             .on_bodies = force * PairForce{tangent.x(), tangent.y(), arm_a, -arm_b}};
    sum.force = sum.force + next->on_bodies;
    pair.ledger->energy += (next++)->energy();
    sum.body_stiffness_a.add(stiffness, tangent.x(), tangent.y(), arm_a);
    sum.body_stiffness_b.add(stiffness, tangent.x(), tangent.y(), arm_b);
  }
  while (old != before_.end()) end_one();
}

}  // namespace apothem
