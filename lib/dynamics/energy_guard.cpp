#include "lib/dynamics/energy_guard.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/polygon/point.hpp"

namespace apothem {
namespace {

constexpr double kLargestError = 0.1;  // of the energy in play
// What losses may fall, of the energy in play. Springs and dashpots are booked by the trapezoid
// rule over steps with velocities between them. Of springs that stick this leaves less than 1e-4 in
// random scenes; a dashpot that stops a body within a few steps may fall by some parts in a
// hundred.
constexpr double kFrictionFall = 0.01, kDampingFall = 0.1;
// Implicit steps lose energy. The velocities that are reported half a step later may hide some for
// a moment.
constexpr double kNumericalFall = 0.1;
constexpr double kArriving = 4;  // growth of the energy in play between regular looks
constexpr double kHopeless =
    0.5;  // error, of the energy in play: no contact that passes is so coarse
// A look beyond the regular ones costs so many parts of the work of the steps. Work is counted in
// coordinates and touching pairs, which cost alike in a step, whose first few come at once; the
// energy of a pair costs several times its force.
constexpr std::int64_t kPrice = 32, kStepWork = 8, kEnergyWork = 8;

// Lifting every body, and pressing contacts, by a few roundings of the scene's size.
double round_off(const Model& model) {
  Box scene;
  double weight = 0;
  for (const RigidBody& body : model.bodies) {
    scene.include(body.position);
    for (const Vec2& v : body.potential.vertices) scene.include(body.position + v);
    if (body.motion == Motion::free) weight += body.mass * model.strongest_gravity();
  }
  for (const DeformableBody& body : model.deformables) scene.include(box_of(body.mesh.nodes));
  if (!(scene.extent() > 0)) return 0;
  const double shift = 1e-12 * scene.extent();
  return weight * shift + model.stiffness() * shift * shift;
}

}  // namespace

EnergyGuard::EnergyGuard(const Model& model)
    : noise_(round_off(model)),
      coordinates_(3 * static_cast<std::int64_t>(model.bodies.size()) + 2 * model.node_count()) {}

void EnergyGuard::start(const Energies& e) {
  in_play_ = lately_ = before_ = e.kinetic + e.strain + e.contact;
}

void EnergyGuard::Loss::follow(double loss) {
  largest = std::max(largest, loss);
  fall = largest - loss;
}

bool EnergyGuard::due(std::int64_t step, const Energies& losses, std::int64_t touching) {
  friction_.follow(losses.friction_loss);
  damping_.follow(losses.damping_loss);
  const std::int64_t price = kPrice * (coordinates_ + kEnergyWork * touching);
  credit_ += kStepWork + coordinates_ + touching;
  const bool regular = step % kEvery == 0;
  if (regular) before_ = lately_;
  const bool affordable = touching > 0 && credit_ >= price;
  if (regular || affordable) {
    credit_ = std::max<std::int64_t>(credit_ - price, 0);
    return true;
  }
  // An excess has to be followed, and a fall to be judged.
  if (excess_since_ >= 0) return !arriving();
  return excess(0) != Verdict::good;
}

EnergyGuard::Verdict EnergyGuard::excess(double error) const {
  if (!(error <= allowed())) return Verdict::unaccounted;
  if (friction_.fall > kFrictionFall * in_play_ + noise_) return Verdict::friction;
  if (damping_.fall > kDampingFall * in_play_ + noise_) return Verdict::damping;
  if (numerical_.fall > kNumericalFall * in_play_ + noise_) return Verdict::numerical;
  return Verdict::good;
}

double EnergyGuard::allowed() const { return kLargestError * in_play_ + noise_; }

bool EnergyGuard::arriving() const { return in_play_ > kArriving * before_; }

EnergyGuard::Verdict EnergyGuard::judge(std::int64_t step, const Energies& e, bool last) {
  const double present = e.kinetic + e.strain + e.contact;
  const double work = std::abs(e.gravity) + std::abs(e.external_work);
  const double error = std::abs(e.total_error);
  in_play_ = std::max({in_play_, present, work});
  if (step % kEvery == 0) lately_ = in_play_;
  record(e);
  numerical_.follow(e.numerical_loss);
  const Verdict verdict = excess(error);
  if (verdict == Verdict::good) {
    excess_since_ = -1;
    return verdict;
  }
  if (excess_since_ < 0) excess_since_ = step;
  const bool hopeless = !(error <= kHopeless * in_play_);
  if (last) return hopeless || !arriving() ? verdict : Verdict::good;
  const std::int64_t patience = arriving() ? kArrival : kLasting;
  if (hopeless && !arriving()) return verdict;
  return step - excess_since_ >= patience ? verdict : Verdict::good;
}

void EnergyGuard::record(const Energies& e) {
  largest_error_ = std::max(largest_error_, std::abs(e.total_error));
}

}  // namespace apothem
