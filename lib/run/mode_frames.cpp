#include "lib/run/mode_frames.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "lib/dynamics/elements.hpp"
#include "lib/model/statistics.hpp"
#include "lib/output/frames.hpp"

namespace apothem {
namespace {

constexpr double kSmall = 1e-6;  // of the shown amplitude: a displacement for derivatives

Box box_of_scene(const Model& model) {
  Box box;
  for (const RigidBody& body : model.bodies) {
    for (const Vec2& p : body.potential.vertices) box.include(body.position + p);
  }
  for (const DeformableBody& body : model.deformables) box.include(box_of(body.mesh.nodes));
  return box;
}

const Elements* elements_of(const Simulation& simulation) {
  for (const auto& term : simulation.terms()) {
    if (const auto* found = dynamic_cast<const Elements*>(term.get())) return found;
  }
  return nullptr;
}

// The stresses that a displacement along the shape adds, per unit of it.
std::vector<CauchyStress> stress_rates(const Simulation& simulation, const SceneMode& mode,
                                       double amplitude) {
  const Elements* const elements = elements_of(simulation);
  if (!elements) return {};
  const State& state = simulation.state();
  const double step = kSmall * amplitude;
  const auto at = [&](double along) {
    std::vector<double> x = state.x;
    for (size_t c = 0; c < x.size(); ++c) x[c] += along * mode.shape[c];
    return elements->elements().stresses(state.layout.of_nodes(x));
  };
  std::vector<CauchyStress> rates = at(step);
  const std::vector<CauchyStress> behind = at(-step);
  for (size_t e = 0; e < rates.size(); ++e) {
    for (const auto part : {&CauchyStress::xx, &CauchyStress::yy, &CauchyStress::xy,
                            &CauchyStress::zz, &CauchyStress::energy_density}) {
      rates[e].*part = (rates[e].*part - behind[e].*part) / (2 * step);
    }
    rates[e].energy_density = 0;  // is of the second order
  }
  return rates;
}

}  // namespace

double shown_amplitude(const Simulation& simulation, const SceneMode& mode) {
  const Layout& layout = simulation.state().layout;
  double farthest = 0, angle = 0;
  const double* const shape = mode.shape.data();
  for (RigidIndex i = 0; i < layout.rigid_bodies; ++i) {
    const double* const body = shape + layout.rigid(i);
    angle = std::max(angle, std::abs(body[2]));
    for (const Vec2& p : simulation.model().bodies[i].potential.vertices) {
      farthest = std::max(farthest, (Vec2(body) + cross(body[2], p)).norm());
    }
  }
  for (NodeIndex i = 0; i < layout.nodes; ++i) {
    farthest = std::max(farthest, Vec2(shape + layout.node(i)).norm());
  }
  const double size = box_of_scene(simulation.model()).extent();
  return std::min(kModeAmplitude * size / farthest, angle > 0 ? kModeAngle / angle : HUGE_VAL);
}

void write_mode_frames(const std::string& folder, const Simulation& simulation,
                       const SceneMode& mode, int threads, FileList* list) {
  const Model& model = simulation.model();
  const double amplitude = shown_amplitude(simulation, mode);
  const std::vector<CauchyStress> rates = stress_rates(simulation, mode, amplitude);
  const double period = std::isfinite(mode.period()) ? mode.period() : 1;
  FrameWriter writer(folder, model, {}, threads, list);
  State state = simulation.state();
  for (int phase = 0; phase <= kModePhases; ++phase) {
    const double turn = 2 * M_PI * phase / kModePhases;
    const double along = amplitude * std::cos(turn);
    const double rate = -amplitude * 2 * M_PI / period * std::sin(turn);
    state.time = period * phase / kModePhases;
    for (size_t c = 0; c < state.x.size(); ++c) {
      state.x[c] = simulation.state().x[c] + along * mode.shape[c];
      state.v[c] = rate * mode.shape[c];
    }
    std::vector<CauchyStress> stresses = rates;
    for (CauchyStress& s : stresses) {
      s.xx *= along, s.yy *= along, s.xy *= along, s.zz *= along;
    }
    writer.write({.state = state,
                  .stresses = stresses,
                  .forces = std::vector<BodyForce>(model.bodies.size() + model.deformables.size()),
                  .node_mass = simulation.node_mass(),
                  .bodies = body_statistics(model, state, {}, stresses)});
  }
}

}  // namespace apothem
