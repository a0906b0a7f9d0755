#include "lib/dynamics/modes.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "lib/dynamics/touching.hpp"
#include "lib/model/inradius.hpp"

namespace apothem {
namespace {

// Of the norms of all forces.
double unbalance(const Simulation& simulation, const std::vector<double>& out_of_balance) {
  const DegreesOfFreedom& dofs = simulation.degrees_of_freedom();
  double off = 0, loads = 0;
  for (size_t c = 0; c < out_of_balance.size(); ++c) {
    const bool angle = c < dofs.layout().node(0) && c % 3 == 2;
    if (angle || !dofs.can_move(c)) continue;
    off += out_of_balance[c] * out_of_balance[c];
    const double weight = dofs.weight().empty() ? 0 : dofs.weight()[c];
    loads += weight * weight;
  }
  std::vector<double> given(dofs.layout().size() - dofs.layout().node(0), 0);
  for (const auto& term : simulation.terms()) term->add_given_forces(given);
  for (const double force : given) loads += force * force;
  for (const ContactRecord& contact : simulation.contacts()) {
    loads += contact.normal.squaredNorm() + contact.tangential.squaredNorm();
  }
  return loads > 0 ? std::sqrt(off / loads) : 0;
}

// Penetration in which the rounding of places plays no part, of the smaller inradius.
constexpr double kPressing = 1e-11;

// The patches that press, and whether one of them has friction.
void look_at_contacts(const Simulation& simulation, Linearised& scene) {
  const Model& model = simulation.model();
  const size_t bodies = model.bodies.size() + model.deformables.size();
  std::vector<double> inradius(bodies);
  for (size_t b = 0; b < bodies; ++b) inradius[b] = inradius_of(model, static_cast<BodyIndex>(b));
  std::set<std::pair<BodyIndex, BodyIndex>> pressed;
  for (const ContactRecord& contact : simulation.contacts()) {
    const double size = std::min(inradius[contact.a], inradius[contact.b]);
    if (!(contact.penetration > kPressing * size)) {
      scene.overlapping += contact.normal.squaredNorm() > 0;
      continue;
    }
    ++scene.contacts;
    pressed.emplace(std::min(contact.a, contact.b), std::max(contact.a, contact.b));
  }
  const auto rough = [](const ContactRule& rule) {
    return rule.friction && rule.friction->coefficient > 0;
  };
  scene.friction = scene.contacts > 0 && (model.contact.friction.coefficient > 0 ||
                                          std::ranges::any_of(model.contact.rules, rough));
  for (const TouchingBodies& pair : touching_bodies(model, simulation.state())) {
    if (!pressed.contains({pair.a, pair.b})) scene.touching.push_back(pair);
  }
}

// Axis of a coordinate: x, y, or 2 for an angle.
size_t axis_of(const ModalSystem& system, size_t c) {
  return c < system.rigid ? c % 3 : (c - system.rigid) % 2;
}

SceneMode scene_mode(const ModalSystem& system, const std::array<double, 2>& mass, Mode mode) {
  SceneMode result;
  result.eigenvalue = mode.eigenvalue;
  std::array<double, 3> along{};
  for (size_t c = 0; c < mode.shape.size(); ++c) {
    if (system.moves[c] != 0) along[axis_of(system, c)] += system.mass[c] * mode.shape[c];
  }
  for (const size_t axis : {0, 1}) {
    if (mass[axis] > 0) result.share[axis] = along[axis] * along[axis] / mass[axis];
  }
  result.shape = std::move(mode.shape);
  return result;
}

std::array<double, 2> free_mass(const ModalSystem& system) {
  std::array<double, 3> mass{};
  for (size_t c = 0; c < system.mass.size(); ++c) {
    if (system.moves[c] != 0) mass[axis_of(system, c)] += system.mass[c];
  }
  return {mass[0], mass[1]};
}

}  // namespace

double SceneMode::frequency() const {
  return kind == ModeKind::vibration ? std::sqrt(eigenvalue) / (2 * M_PI) : 0;
}

double SceneMode::period() const {
  return kind == ModeKind::vibration ? 2 * M_PI / std::sqrt(eigenvalue) : HUGE_VAL;
}

double SceneMode::growth_rate() const {
  return kind == ModeKind::unstable ? std::sqrt(-eigenvalue) : 0;
}

std::optional<Linearised> linearised(Simulation& simulation) {
  Linearised scene;
  std::vector<double> out_of_balance;
  if (!simulation.linearise(scene.tangent, out_of_balance)) return {};
  const DegreesOfFreedom& dofs = simulation.degrees_of_freedom();
  scene.system.rigid = dofs.layout().node(0);
  for (size_t c = 0; c < dofs.layout().size(); ++c) {
    scene.system.moves.push_back(dofs.can_move(c));
    scene.system.mass.push_back(dofs.mass(c));
  }
  scene.unbalanced = unbalance(simulation, out_of_balance);
  look_at_contacts(simulation, scene);
  return scene;
}

SceneModes modes_of(const Linearised& scene, int count) {
  VibrationModes found = vibration_modes(scene.tangent, scene.system, count);
  SceneModes result;
  result.coordinates = found.coordinates;
  result.unstable = found.unstable, result.rigid = found.rigid;
  result.skew = found.skew;
  result.mass = free_mass(scene.system);
  for (Mode& mode : found.modes) {
    const ModeKind kind = mode.eigenvalue < 0    ? ModeKind::unstable
                          : mode.eigenvalue == 0 ? ModeKind::rigid
                                                 : ModeKind::vibration;
    result.modes.push_back(scene_mode(scene.system, result.mass, std::move(mode)));
    result.modes.back().kind = kind;
  }
  return result;
}

SceneModes buckling_of(const Linearised& unloaded, const Linearised& loaded, int count) {
  SceneModes result;
  result.mass = free_mass(unloaded.system);
  result.coordinates = static_cast<int>(std::ranges::count(unloaded.system.moves, 1));
  for (Mode& mode : buckling_modes(unloaded.tangent, loaded.tangent, unloaded.system, count)) {
    result.modes.push_back(scene_mode(unloaded.system, result.mass, std::move(mode)));
    result.modes.back().kind = ModeKind::buckling;
  }
  return result;
}

}  // namespace apothem
