#include "apothem/contact/patch_tangential.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace apothem {
namespace {

// Error of the sum of a patch's normal forces, in units of eps x size / reference length x own
// length: twice the worst of a million pairs (docs/verification.md).
constexpr double kForceError = 1.2;

// The force of a spring after a slip in m: never beyond Coulomb's limit in N. What it loses is the
// mean force times the slip that it does not follow.
double follow(double force, double slip, double stiffness, double limit, FrictionMemory& memory) {
  const double trial = force - stiffness * slip;
  const double next = std::clamp(trial, -limit, limit);
  memory.lose((force + next) * (trial - next) / (2 * stiffness));
  return next;
}

}  // namespace

// What matching patches needs of a run; the next step makes the rest anew.
static void describe(Archive& archive, BoundaryRun& run) {
  archive("of_a", run.of_a)("edge", run.edge)("patch", run.patch)("from", run.from)("to", run.to)(
      "length", run.length);
}

PatchTangential::PatchTangential(const Surfaces& surfaces, const ContactLaw& law,
                                 const FrictionTable& table, double thickness)
    : surfaces_(surfaces), law_(law), table_(table), thickness_(thickness) {}

void PatchTangential::slide(const PairIntegrals& pairs, std::span<const int> touching,
                            const Kinematics& now, double dt, FrictionMemory& memory) {
  std::swap(now_, before_);
  now_.clear();
  place_ = {};
  std::swap(forces_, forces_before_);
  forces_.clear();
  auto last = forces_before_.begin();
  const auto release_until = [&](RigidIndex a, RigidIndex b) {
    for (; last != forces_before_.end() && std::pair(last->a, last->b) < std::pair(a, b); ++last) {
      release(*last, now, dt, memory);
    }
  };
  for (const int p : touching) {
    const auto pair = static_cast<size_t>(p);
    const auto [a, b] = pairs.pairs()[pair];
    release_until(a, b);
    if (last != forces_before_.end() && last->a == a && last->b == b) ++last;
    step_pair(pairs, pair, now, dt, memory);
  }
  release_until(std::numeric_limits<RigidIndex>::max(), 0);
}

// Of a pair that touches no more: in the first half of this step its last force has still acted.
void PatchTangential::release(const TangentialForce& last, const Kinematics& now, double dt,
                              FrictionMemory& memory) const {
  const PairMotion motion(surfaces_, now, last.a, last.b);
  const double damping = motion.power(last.damping, last.damping_a, last.damping_b);
  const double all = motion.power(last.force, last.moment_a, last.moment_b);
  memory.damp(-dt / 2 * damping);
  memory.lose(-dt / 2 * (all - damping));
}

void PatchTangential::History::fields(Archive& archive) {
  archive("pairs", pairs)("runs", runs)("dampers", dampers);
}

// Leaves place_ at the pair, if it was there before.
const PatchTangential::PairHistory* PatchTangential::find_before(RigidIndex a, RigidIndex b) {
  while (place_.pair < before_.pairs.size()) {
    const PairHistory& pair = before_.pairs[place_.pair];
    if (std::pair(pair.a, pair.b) == std::pair(a, b)) return &pair;
    if (std::pair(pair.a, pair.b) > std::pair(a, b)) return nullptr;
    ++place_.pair;
    place_.run += static_cast<size_t>(pair.runs);
    place_.damper += static_cast<size_t>(pair.patches);
  }
  return nullptr;
}

void PatchTangential::step_pair(const PairIntegrals& pairs, size_t pair, const Kinematics& now,
                                double dt, FrictionMemory& memory) {
  const auto [a, b] = pairs.pairs()[pair];
  const Friction& friction = table_.between(a, b);
  const bool rough = friction.coefficient > 0, damped = law_.normal_damping > 0;
  if (!rough && !damped) return;
  const PlacedShapes& shapes = surfaces_.shapes();
  const PairMotion motion(surfaces_, now, a, b);
  runs_.clear();
  if (edgewise() || !shapes.view(a).convex() || !shapes.view(b).convex()) {
    contact_patches(shapes.view(a), shapes.view(b), motion.between, workspace_, runs_, patches_);
  } else {
    patches_.assign(1, pairs[pair]);
  }
  const PairHistory* const before = find_before(a, b);
  const std::span<const Spring> springs = memory.before(polygon_kernel, a, b);
  find_shares(before);
  if (damped) {
    const std::span<const PatchDamper> dampers(before_.dampers);
    inherit(dampers.subspan(before ? place_.damper : 0, ancestors_), dampers_,
            [](PatchDamper& heir, double share, const PatchDamper& old, const PairIntegral&) {
              heir.add(share, old);
            });
  }
  if (rough && !edgewise()) {
    inherit(springs, springs_,
            [](Spring& heir, double share, const Spring& old, const PairIntegral& patch) {
              Vec2 tangent = tangent_of(patch.force);
              if (tangent == Vec2::Zero()) tangent = old.tangent;
              heir.force += share * old.force * tangent.dot(old.tangent);
            });
    lose_by_inheritance(springs, friction.tangential_stiffness * thickness_, memory);
  }
  TangentialForce total{.a = a, .b = b};
  for (size_t j = 0; j < patches_.size(); ++j) {
    const PairIntegral& patch = patches_[j];
    if (damped) {
      PatchDamper& d = dampers_[j];
      memory.damp(damp(law_.normal_damping, law_.normal_stiffness * thickness_, surfaces_, a, b,
                       patch, motion, dt, d));
      total.add_damping(d);
    }
    if (!rough || edgewise()) continue;
    const double error =
        kForceError * std::numeric_limits<double>::epsilon() *
        (shapes.radius(a) + shapes.radius(b)) *
        (patch.own_length_a * shapes.slope(b) + patch.own_length_b * shapes.slope(a));
    resultant(motion, dt, friction, {polygon_kernel, a, b, static_cast<int>(j)}, patch, error,
              springs_[j], total, memory);
  }
  if (rough && edgewise()) {
    per_edge(motion, dt, friction, {polygon_kernel, a, b, 0}, springs, total, memory);
  }
  if (damped) now_.dampers.insert(now_.dampers.end(), dampers_.begin(), dampers_.end());
  now_.runs.insert(now_.runs.end(), runs_.begin(), runs_.end());
  now_.pairs.push_back({a, b, static_cast<int>(patches_.size()), static_cast<int>(runs_.size())});
  forces_.push_back(total);
}

// What the patches before hand down to those of now: everything to the only heir, otherwise in
// proportion to the normal forces of those that share boundary with it. Forces are neither invented
// nor lost; the elastic energy that a merger of springs leaves over is dissipated.
void PatchTangential::find_shares(const PairHistory* before) {
  const size_t heirs = patches_.size();
  ancestors_ = before ? static_cast<size_t>(before->patches) : 0;
  if (ancestors_ == 0 || (ancestors_ == 1 && heirs == 1)) return;
  shared_length({before_.runs.data() + place_.run, static_cast<size_t>(before->runs)},
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

template <class T, class Add>
void PatchTangential::inherit(std::span<const T> before, std::vector<T>& now, Add&& add) const {
  now.assign(patches_.size(), {});
  if (before.size() == 1 && now.size() == 1) {
    now[0] = before[0];
    return;
  }
  for (size_t i = 0; i < before.size(); ++i) {
    for (size_t j = 0; j < now.size(); ++j) {
      const double share = shares_[i * now.size() + j];
      if (share > 0) add(now[j], share, before[i], patches_[j]);
    }
  }
}

// Elastic energy that a split or a merger of patches leaves over.
void PatchTangential::lose_by_inheritance(std::span<const Spring> before, double stiffness,
                                          FrictionMemory& memory) const {
  if (before.empty() || (before.size() == 1 && springs_.size() == 1)) return;
  double left = 0;
  for (const Spring& spring : before) left += spring.force * spring.force;
  for (const Spring& spring : springs_) left -= spring.force * spring.force;
  memory.lose(left / (2 * stiffness));
}

// The paper's law (Eqs. 10-14): one spring per patch, at right angles to its normal force. As a
// number along the tangent it turns with the contact by itself (Eq. 13). Friction on a opposes a's
// slip against b: the sign of Eq. 12 is a misprint.
void PatchTangential::resultant(const PairMotion& motion, double dt, const Friction& friction,
                                SpringKey key, const PairIntegral& patch, double force_error,
                                Spring& spring, TangentialForce& total,
                                FrictionMemory& memory) const {
  spring.key = key;
  spring.stiffness = friction.tangential_stiffness * thickness_;
  spring.accounted = true;
  const double size = patch.force.norm();
  if (!(size > kNoResultant * patch.weight)) {
    memory.lose(spring.energy());
    spring.force = 0;
    memory.keep(spring);
    return;
  }
  const Vec2 tangent = tangent_of(patch.force);
  const Vec2 point = loading_point(patch);
  Vec2 normal = law_.normal_stiffness * thickness_ * patch.force;
  if (law_.normal_damping > 0) normal += dampers_[static_cast<size_t>(key.part)].damping;
  const Vec2 velocity = motion.slip(point);
  double slip = velocity.dot(tangent);
  // The tangent is only as exact as the force: what it makes of an approach is no slip.
  if (std::abs(slip) <= velocity.norm() * force_error / size) slip = 0;
  spring.force = follow(spring.force, slip * dt, spring.stiffness,
                        friction.coefficient * normal.norm(), memory);
  spring.tangent = tangent;
  memory.keep(spring);
  const Vec2 force = spring.force * tangent;
  total.add(force, cross(point, force), -cross(point + motion.between, force));
  total.stiffness += spring.stiffness;
  total.arm = std::max({total.arm, std::abs(cross(point, tangent)),
                        std::abs(cross(point + motion.between, tangent))});
}

// The older law, for comparison (Eq. 9): a spring along every edge of the overlap. Edges that slope
// against the motion meet a false tangential force.
void PatchTangential::per_edge(const PairMotion& motion, double dt, const Friction& friction,
                               SpringKey key, std::span<const Spring> before,
                               TangentialForce& total, FrictionMemory& memory) {
  const double stiffness = friction.tangential_stiffness * thickness_;
  const int edges_of_a = surfaces_.shapes().view(key.a).size;
  auto old = before.begin();
  const auto lost = [&] { memory.lose((old++)->energy()); };  // of an edge that is free again
  for (const BoundaryRun& run : runs_) {
    key.part = run.of_a ? run.edge : edges_of_a + run.edge;
    while (old != before.end() && old->key < key) lost();
    double spring = 0;
    if (old != before.end() && old->key == key) spring = (old++)->force;
    const Vec2 tangent = tangent_of(run.force);
    spring = follow(spring, motion.slip(run.centre).dot(tangent) * dt, stiffness,
                    friction.coefficient * law_.normal_stiffness * thickness_ * run.force.norm(),
                    memory);
    memory.keep({key, spring, stiffness, tangent, true});
    const Vec2 force = spring * tangent;
    total.add(force, cross(run.centre, force), -cross(run.centre + motion.between, force));
    total.stiffness += stiffness;
    total.arm = std::max({total.arm, std::abs(cross(run.centre, tangent)),
                          std::abs(cross(run.centre + motion.between, tangent))});
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
  for (size_t j = 0; law_.normal_damping > 0 && j < patches.size(); ++j) {
    patches[j].damping += now_.dampers[cursor.damper + j].damping;
  }
  for (size_t i = 0; i < springs.size(); ++i) {
    const int patch = edgewise() ? runs[i].patch : springs[i].key.part;
    patches[static_cast<size_t>(patch)].tangential += springs[i].force * springs[i].tangent;
  }
}

}  // namespace apothem
