#include "apothem/contact/tangential.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace apothem {
namespace {

// Error of the sum of a patch's normal forces, in units of eps x size / reference length x own
// length: twice the worst of a million pairs (docs/verification.md).
constexpr double kForceError = 1.2;

}  // namespace

TangentialContact::TangentialContact(const ContactLaw& law, double thickness,
                                     std::vector<int> material,
                                     std::vector<std::array<double, 3>> inverse_mass)
    : law_(law),
      thickness_(thickness),
      material_(std::move(material)),
      inverse_mass_(std::move(inverse_mass)) {}

bool TangentialContact::needed(const ContactLaw& law) {
  return law.friction.coefficient > 0 || law.normal_damping > 0 ||
         std::any_of(law.rules.begin(), law.rules.end(),
                     [](const ContactRule& r) { return r.friction.coefficient > 0; });
}

Friction TangentialContact::friction_of(int a, int b) const {
  return friction_between(law_, a, material_[a], b, material_[b]);
}

std::vector<double> TangentialContact::friction(size_t bodies) const {
  std::vector<double> friction(bodies);
  size_t patch = 0, spring = 0;
  for (const PairMemory& pair : now_.pairs) {
    double size = 0;
    for (int i = 0; i < pair.patches; ++i) size += std::abs(now_.patches[patch++].spring);
    for (int i = 0; i < pair.springs; ++i) size += std::abs(now_.springs[spring++].spring);
    friction[pair.pair.first] += size;
    friction[pair.pair.second] += size;
  }
  return friction;
}

void TangentialContact::update(const PlacedShapes& shapes, const std::vector<double>& position,
                               const std::vector<double>& velocity, double dt,
                               const std::vector<BoxPair>& pairs,
                               const std::vector<PairIntegral>& integrals) {
  std::swap(now_, before_);
  now_.clear();
  now_.friction_loss = before_.friction_loss;
  now_.damping_loss = before_.damping_loss;
  forces_.clear();
  now_.energy = 0;
  const auto order = [](const BoxPair& p) { return std::pair(p.first, p.second); };
  size_t next = 0;
  Place place{};
  const auto skip = [&] {
    const PairMemory& pair = before_.pairs[next++];
    place.patch += static_cast<size_t>(pair.patches);
    place.run += static_cast<size_t>(pair.runs);
    place.spring += static_cast<size_t>(pair.springs);
  };
  for (int p = 0; p < static_cast<int>(pairs.size()); ++p) {
    if (!integrals[p].touching()) continue;
    const BoxPair& pair = pairs[p];
    while (next < before_.pairs.size() && order(before_.pairs[next].pair) < order(pair)) {
      release(before_.pairs[next], place);
      skip();
    }
    const bool known =
        next < before_.pairs.size() && order(before_.pairs[next].pair) == order(pair);
    const double* xa = &position[3 * static_cast<size_t>(pair.first)];
    const double* xb = &position[3 * static_cast<size_t>(pair.second)];
    const double* va = &velocity[3 * static_cast<size_t>(pair.first)];
    const double* vb = &velocity[3 * static_cast<size_t>(pair.second)];
    const Motion motion{
        {va[0], va[1]}, {vb[0], vb[1]}, va[2], vb[2], {xa[0] - xb[0], xa[1] - xb[1]}};
    step_pair(p, pair, shapes, motion, dt, integrals[p], known ? &before_.pairs[next] : nullptr,
              place);
    if (known) skip();
  }
  while (next < before_.pairs.size()) {
    release(before_.pairs[next], place);
    skip();
  }
}

// The contact is over: what its springs still hold is lost.
void TangentialContact::release(const PairMemory& pair, const Place& place) {
  const Friction friction = friction_of(pair.pair.first, pair.pair.second);
  const double stiffness = friction.tangential_stiffness * thickness_;
  if (!(stiffness > 0)) return;
  for (int i = 0; i < pair.patches; ++i) {
    const double s = before_.patches[place.patch + static_cast<size_t>(i)].spring;
    now_.friction_loss += s * s / (2 * stiffness);
  }
  for (int i = 0; i < pair.springs; ++i) {
    const double s = before_.springs[place.spring + static_cast<size_t>(i)].spring;
    now_.friction_loss += s * s / (2 * stiffness);
  }
}

void TangentialContact::step_pair(int p, const BoxPair& pair, const PlacedShapes& shapes,
                                  const Motion& motion, double dt, const PairIntegral& integral,
                                  const PairMemory* before, const Place& place) {
  const auto [a, b] = pair;
  const Friction friction = friction_of(a, b);
  if (!(friction.coefficient > 0) && !(law_.normal_damping > 0)) return;
  const PlacedPotential view_a = shapes.view(a);
  const PlacedPotential view_b = shapes.view(b);
  const bool edgewise = law_.friction_law == FrictionLaw::per_edge;
  runs_.clear();
  if (edgewise || !view_a.convex() || !view_b.convex()) {
    contact_patches(view_a, view_b, motion.between, workspace_, runs_, patches_);
  } else {
    patches_.assign(1, integral);
  }
  const double stiffness = friction.tangential_stiffness * thickness_;
  inherit(before, place, stiffness);

  TangentialForce total{.pair = p};
  for (size_t j = 0; j < patches_.size(); ++j) {
    PatchMemory& memory = inherited_[j];
    damp(a, b, shapes, patches_[j], motion, dt, memory, total);
    if (edgewise) continue;
    const double error =
        kForceError * std::numeric_limits<double>::epsilon() *
        (shapes.radius(a) + shapes.radius(b)) *
        (patches_[j].own_length_a * shapes.slope(b) + patches_[j].own_length_b * shapes.slope(a));
    resultant(patches_[j], motion, dt, friction, error, memory, total);
  }
  const size_t springs = now_.springs.size();
  if (edgewise) per_edge(motion, dt, friction, before, place, total);
  now_.patches.insert(now_.patches.end(), inherited_.begin(), inherited_.end());
  now_.runs.insert(now_.runs.end(), runs_.begin(), runs_.end());
  now_.pairs.push_back({pair, static_cast<int>(patches_.size()), static_cast<int>(runs_.size()),
                        static_cast<int>(now_.springs.size() - springs)});
  forces_.push_back(total);
}

// What the patches before hand down to those of now: everything to the only heir, otherwise in
// proportion to the normal forces of those that share boundary with it. Forces are neither invented
// nor lost; the elastic energy that a merger of springs leaves over goes to the friction loss.
void TangentialContact::inherit(const PairMemory* before, const Place& place, double stiffness) {
  inherited_.assign(patches_.size(), {});
  if (before == nullptr || before->patches == 0) return;
  const auto ancestors = static_cast<size_t>(before->patches);
  const PatchMemory* const old = &before_.patches[place.patch];
  if (ancestors == 1 && patches_.size() == 1) {
    inherited_[0] = old[0];
    return;
  }
  shared_length({before_.runs.data() + place.run, static_cast<size_t>(before->runs)},
                before->patches, runs_, static_cast<int>(patches_.size()), shared_);
  double energy = 0;
  for (size_t i = 0; i < ancestors; ++i) {
    energy += old[i].spring * old[i].spring;
    double* const share = &shared_[i * patches_.size()];
    double sum = 0;
    for (size_t j = 0; j < patches_.size(); ++j) {
      share[j] = share[j] > 0 ? patches_[j].force.norm() : 0;
      sum += share[j];
    }
    if (!(sum > 0)) continue;
    for (size_t j = 0; j < patches_.size(); ++j) {
      if (!(share[j] > 0)) continue;
      const double part = share[j] / sum;
      PatchMemory& heir = inherited_[j];
      heir.normal += part * old[i].normal;
      heir.moment_a += part * old[i].moment_a;
      heir.moment_b += part * old[i].moment_b;
      heir.damping += part * old[i].damping;
      heir.damping_a += part * old[i].damping_a;
      heir.damping_b += part * old[i].damping_b;
      Vec2 tangent = tangent_of(patches_[j].force);
      if (tangent == Vec2::Zero()) tangent = old[i].tangent;
      heir.spring += part * old[i].spring * tangent.dot(old[i].tangent);
    }
  }
  for (const PatchMemory& heir : inherited_) energy -= heir.spring * heir.spring;
  if (stiffness > 0) now_.friction_loss += energy / (2 * stiffness);
}

double TangentialContact::slide(double spring, double slip, double limit, double stiffness) {
  const double trial = spring - stiffness * slip;
  const double next = std::clamp(trial, -limit, limit);
  // Mean force times the slip that the spring does not follow.
  now_.friction_loss += (spring + next) * (trial - next) / (2 * stiffness);
  now_.energy += next * next / (2 * stiffness);
  return next;
}

// The paper's law (Eqs. 10-14): one spring per patch, at right angles to its normal force. As a
// number along the tangent it turns with the contact by itself (Eq. 13). Friction on a opposes a's
// slip against b: the sign of Eq. 12 is a misprint.
void TangentialContact::resultant(const PairIntegral& patch, const Motion& motion, double dt,
                                  const Friction& friction, double force_error, PatchMemory& memory,
                                  TangentialForce& total) {
  if (!(friction.coefficient > 0)) return;
  const double stiffness = friction.tangential_stiffness * thickness_;
  const double size = patch.force.norm();
  if (!(size > kNoResultant * patch.weight)) {
    now_.friction_loss += memory.spring * memory.spring / (2 * stiffness);
    memory.spring = 0;
    return;
  }
  const Vec2 tangent = tangent_of(patch.force);
  const Vec2 point = loading_point(patch);
  const Vec2 normal = law_.normal_stiffness * thickness_ * patch.force + memory.damping;
  const Vec2 velocity = motion.slip(point);
  double slip = velocity.dot(tangent);
  // The tangent is only as exact as the force: what it makes of an approach is no slip.
  if (std::abs(slip) <= velocity.norm() * force_error / size) slip = 0;
  memory.spring = slide(memory.spring, slip * dt, friction.coefficient * normal.norm(), stiffness);
  memory.tangent = tangent;
  const Vec2 force = memory.spring * tangent;
  total.force += force;
  total.moment_a += cross(point, force);
  total.moment_b -= cross(point + motion.between, force);
  total.stiffness += stiffness;
  total.arm = std::max({total.arm, std::abs(cross(point, tangent)),
                        std::abs(cross(point + motion.between, tangent))});
}

// The older law, for comparison (Eq. 9): a spring along every edge of the overlap. Edges that slope
// against the motion meet a false tangential force.
void TangentialContact::per_edge(const Motion& motion, double dt, const Friction& friction,
                                 const PairMemory* before, const Place& place,
                                 TangentialForce& total) {
  if (!(friction.coefficient > 0)) return;
  const double stiffness = friction.tangential_stiffness * thickness_;
  const size_t end = place.spring + (before ? static_cast<size_t>(before->springs) : 0);
  size_t next = place.spring;
  const auto lost = [&] {
    const double s = before_.springs[next++].spring;
    now_.friction_loss += s * s / (2 * stiffness);
  };
  const auto order = [](bool of_a, int edge) { return std::pair(!of_a, edge); };
  for (const BoundaryRun& run : runs_) {
    const auto key = order(run.of_a, run.edge);
    const auto of_next = [&] {
      return order(before_.springs[next].of_a, before_.springs[next].edge);
    };
    while (next < end && of_next() < key) lost();
    double spring = 0;
    if (next < end && of_next() == key) spring = before_.springs[next++].spring;
    const double size = run.force.norm();
    const Vec2 tangent = tangent_of(run.force);
    spring = slide(spring, motion.slip(run.centre).dot(tangent) * dt,
                   friction.coefficient * law_.normal_stiffness * thickness_ * size, stiffness);
    now_.springs.push_back({run.of_a, run.edge, spring});
    const Vec2 force = spring * tangent;
    total.force += force;
    total.moment_a += cross(run.centre, force);
    total.moment_b -= cross(run.centre + motion.between, force);
    total.stiffness += stiffness;
    total.arm = std::max({total.arm, std::abs(cross(run.centre, tangent)),
                          std::abs(cross(run.centre + motion.between, tangent))});
  }
  while (next < end) lost();
}

// Normal viscous damping: beta times the rate of the resultant and its moments, beta = 2
// ratio/omega with the contact's present stiffness and the two bodies' mobility, and never so much
// that the contact would pull.
void TangentialContact::damp(int a, int b, const PlacedShapes& shapes, const PairIntegral& patch,
                             const Motion& motion, double dt, PatchMemory& memory,
                             TangentialForce& total) {
  if (!(law_.normal_damping > 0)) return;
  const double k = law_.normal_stiffness * thickness_;
  const auto work = [&] {  // over half a step, by the damping force as it is
    const Vec2 v = motion.velocity_a - motion.velocity_b;
    return dt / 2 *
           (memory.damping.dot(v) + memory.damping_a * motion.spin_a +
            memory.damping_b * motion.spin_b);
  };
  now_.damping_loss -= work();
  const Vec2 normal = k * patch.force;
  const double moment_a = k * patch.moment_a;
  const double moment_b = k * patch.moment_b;
  const Vec2 rise = normal - memory.normal;
  const double rise_a = moment_a - memory.moment_a;
  const double rise_b = moment_b - memory.moment_b;
  memory.normal = normal;
  memory.moment_a = moment_a;
  memory.moment_b = moment_b;
  memory.damping.setZero();
  memory.damping_a = memory.damping_b = 0;

  const double size = normal.norm();
  if (!(size > kNoResultant * k * patch.weight) || !(dt > 0)) return;
  const Vec2 n = normal / size;
  const Vec2 point = loading_point(patch);
  const auto mobility = [&](int body, const Vec2& arm) {
    const std::array<double, 3>& w = inverse_mass_[body];
    const double lever = cross(arm, n);
    return w[0] * n.x() * n.x() + w[1] * n.y() * n.y() + w[2] * lever * lever;
  };
  const double omega2 =
      k * (patch.own_length_a * shapes.slope(b) + patch.own_length_b * shapes.slope(a)) *
      (mobility(a, point) + mobility(b, point + motion.between));
  if (!(omega2 > 0)) return;
  double rate = 2 * law_.normal_damping / std::sqrt(omega2) / dt;
  const double pull = -rise.dot(n);
  if (rate * pull > size) rate = size / pull;  // damping takes the whole force and no more
  memory.damping = rate * rise;
  memory.damping_a = rate * rise_a;
  memory.damping_b = rate * rise_b;
  now_.damping_loss -= work();
  total.force += memory.damping;
  total.moment_a += memory.damping_a;
  total.moment_b += memory.damping_b;
}

}  // namespace apothem
