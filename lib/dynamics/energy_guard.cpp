#include "apothem/dynamics/energy_guard.hpp"

#include <algorithm>
#include <cmath>

#include "apothem/geometry/polygon/point.hpp"

namespace apothem {
namespace {

constexpr double kLargestError = 0.1;       // of the energy in play
constexpr double kArriving = 4;             // growth of the energy in play between two looks
constexpr std::int64_t kLongestExcess = 4;  // looks in a row, however fast energy arrives

// Lifting every body, and pressing contacts, by a few roundings of the scene's size.
double round_off(const Model& model) {
  Box scene;
  double weight = 0;
  for (const RigidBody& body : model.bodies) {
    scene.include(body.position.x(), body.position.y());
    for (const Vec2& v : body.potential.vertices) {
      scene.include(body.position.x() + v.x(), body.position.y() + v.y());
    }
    if (body.motion == Motion::free) weight += body.mass * model.strongest_gravity();
  }
  for (const DeformableBody& body : model.deformables) {
    for (const Vec2& x : body.mesh.nodes) scene.include(x.x(), x.y());
  }
  if (!(scene.extent() > 0)) return 0;
  const double shift = 1e-12 * scene.extent();
  return weight * shift + model.stiffness() * shift * shift;
}

}  // namespace

EnergyGuard::EnergyGuard(const Model& model) : noise_(round_off(model)) {}

bool EnergyGuard::exceeded(const Energies& e) {
  const double before = in_play_;
  const double present = e.kinetic + e.strain + e.contact;
  const double work = std::abs(e.gravity) + std::abs(e.external_work);
  const double error = std::abs(e.total_error);
  in_play_ = std::max({in_play_, present, work});
  largest_error_ = std::max(largest_error_, error);
  if (error <= kLargestError * in_play_ + noise_) {
    looks_in_excess_ = 0;
    return false;
  }
  ++looks_in_excess_;
  const bool arriving = in_play_ > kArriving * before;
  return !arriving || looks_in_excess_ >= kLongestExcess;
}

}  // namespace apothem
