#include "lib/dynamics/elements.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lib/dynamics/unstable.hpp"
#include "lib/fem/spectrum.hpp"
#include "lib/model/inradius.hpp"

namespace apothem {
namespace {

// A uniaxially compressed St. Venant-Kirchhoff bar bears most at 1/sqrt(3) of its length; elements
// grow across the load, so that their area is a little more.
constexpr double kSoftened = 0.65;

// What the damping of the scene adds to Rayleigh's coefficient beta of each body, s: it gives
// oscillations through its thickness, of the angular frequency c/(2 R) with the inradius R and the
// speed of sound in a bar c, the ratio of the scene.
std::vector<double> bulk_damping(const Model& model) {
  std::vector<double> beta(model.deformables.size());
  const double ratio = model.contact.damping.bulk;
  for (size_t i = 0; ratio > 0 && i < beta.size(); ++i) {
    const Material& m = model.materials[model.deformables[i].material];
    const double inradius = inradius_of(model, static_cast<BodyIndex>(model.bodies.size() + i));
    beta[i] = 4 * ratio * inradius * std::sqrt(m.density / m.elastic.young);
  }
  return beta;
}

std::vector<ElementSet> element_sets(const Model& model, const std::vector<double>& bulk) {
  std::vector<ElementSet> sets;
  for (const DeformableBody& body : model.deformables) {
    const Material& m = model.materials[body.material];
    sets.push_back({body.element, &body.mesh, body.first_node, m.elastic, m.density,
                    model.thickness, m.stiffness_damping + bulk[sets.size()]});
    if (body.element_material.empty()) continue;
    const double added = bulk[sets.size() - 1];
    for (const Material& each : model.materials) {
      sets.back().materials.push_back({each.elastic, each.density, each.stiffness_damping + added});
    }
    sets.back().material_of = body.element_material;
  }
  return sets;
}

}  // namespace

Elements::Elements(const Model& model, int threads)
    : model_(model),
      bulk_damping_(bulk_damping(model)),
      elements_(element_sets(model, bulk_damping_), threads) {}

// The largest beta of any element, s.
double Elements::stiffness_damping() const {
  double beta = 0;
  for (size_t i = 0; i < model_.deformables.size(); ++i) {
    for (const MaterialIndex material : model_.deformables[i].materials()) {
      beta = std::max(beta, model_.materials[material].stiffness_damping + bulk_damping_[i]);
    }
  }
  return beta;
}

void Elements::start(const DegreesOfFreedom& dofs, State& state) {
  find_limit(dofs, state);
  const Layout& layout = state.layout;
  first_damping_power_ = damping_power_ =
      elements_.force(layout.of_nodes(state.x), layout.of_nodes(state.v), layout.of_nodes(state.f));
}

std::string Elements::describe() const {
  std::string kinds;
  for (const DeformableBody& body : model_.deformables) {
    for (const MaterialIndex material : body.materials()) {
      const Material& m = model_.materials[material];
      const std::string kind =
          fmt::format("{} ({}, plane {})", kElements[static_cast<size_t>(body.element)].name,
                      kElasticLaws[static_cast<size_t>(m.elastic.law)],
                      kPlanes[static_cast<size_t>(m.elastic.plane)]);
      if (kinds.find(kind) == std::string::npos) kinds += (kinds.empty() ? "" : ", ") + kind;
    }
  }
  return fmt::format("{} finite elements, {} nodes: {}{}", elements_.element_count(),
                     elements_.node_count(), kinds,
                     stiffness_damping() > 0 ? "; damping in proportion to the stiffness" : "");
}

void Elements::find_limit(const DegreesOfFreedom& dofs, const State& state) {
  const Layout& layout = state.layout;
  const double lambda =
      largest_eigenvalue(elements_, layout.of_nodes(state.x), layout.of_nodes(dofs.inverse_mass()));
  if (!(lambda > 0)) {
    limit_ = {HUGE_VAL, "no element can move"};
    return;
  }
  const double w = std::sqrt(lambda);
  // Damping lags behind by half a step (T. Belytschko et al. 2014, Sec. 6.2).
  const double ratio = stiffness_damping() * w / 2;
  limit_ = {2 / (w * (std::sqrt(1 + ratio * ratio) + ratio)),
            ratio > 0 ? "elements and their damping" : "elements"};
}

void Elements::add_forces(const Evaluation& now) {
  State& state = now.state;
  const Layout& layout = state.layout;
  span_ = now.still && elements_.damped() ? now.step.span : 0;
  if (now.still) moved_.assign(layout.of_nodes(state.v).size(), 0);
  if (span_ > 0) std::ranges::copy(layout.of_nodes(now.step.v), moved_.begin());
  const std::span<const double> velocity =
      now.still ? std::span<const double>(moved_) : layout.of_nodes(state.v);
  const double lag = now.still ? span_ / 2 : now.trial ? 0 : now.dt / 2;
  const double power =
      elements_.force(layout.of_nodes(state.x), velocity, layout.of_nodes(state.f), lag);
  if (!now.trial) book_damping(power, now);
  now.clock.lap(Phase::elements);
}

void Elements::book_damping(double power, const Evaluation& now) {
  if (now.dt > 0) {
    damping_power_ = power;
    summed_damping_loss_ += now.dt * power;
    step_ = now.dt;
    return;
  }
  // Steps of velocity Verlet begin anew, or an implicit step has been taken.
  summed_damping_loss_ = damping_loss(step_) + span_ * power;
  first_damping_power_ = damping_power_ = now.still ? 0 : power;
}

Vec2 Elements::centre_of(const FiniteElements::Collapse& where) const {
  const Mesh& mesh = model_.deformables[where.set].mesh;
  Vec2 centre = Vec2::Zero();
  const std::span<const int> nodes = mesh.element(where.element);
  for (const int node : nodes) centre += mesh.nodes[node] / static_cast<double>(nodes.size());
  return centre + model_.origin;
}

void Elements::watch(const State& state) {
  const FiniteElements::Collapse worst = elements_.smallest_ratio(state.layout.of_nodes(state.x));
  if (worst.ratio > 0) return;
  const Vec2 centre = centre_of(worst);
  throw Unstable(fmt::format(
      "the element at ({:.6g}, {:.6g}) m of \"{}\" has turned inside out {}: the load is "
      "more than the material can bear, or the step is too long; reduce the load or "
      "the time step, or raise time.load_steps",
      centre.x(), centre.y(), model_.deformables[worst.set].name, at_time(state)));
}

std::string Elements::collapse(const State& state) const {
  const FiniteElements::Collapse worst = elements_.smallest_ratio(state.layout.of_nodes(state.x));
  const DeformableBody& body = model_.deformables[worst.set];
  const Material& material = model_.materials[body.material_of(worst.element)];
  if (material.elastic.law != ElasticLaw::st_venant_kirchhoff || worst.ratio > kSoftened) return {};
  const Vec2 centre = centre_of(worst);
  const std::string size = worst.ratio > 0
                               ? fmt::format("is compressed to {:.2g} of its area", worst.ratio)
                               : std::string("has collapsed");
  return fmt::format(
      "the element at ({:.6g}, {:.6g}) m of \"{}\" {} {}: St. Venant-Kirchhoff material resists "
      "less and less below 0.58 of its length, and then not at all; give the material \"{}\" "
      "\"law\": \"neo_hookean\", or reduce the load",
      centre.x(), centre.y(), body.name, size, at_time(state), material.name);
}

void Elements::add_energies(const State& state, Energies& e) {
  e.strain += elements_.strain_energy(state.layout.of_nodes(state.x));
}

// Of the last force only half a step has acted (-dt/2 [v.C.v] since the start), and each power was
// taken with the velocity half a step before its force: SUM v.C.a dt^2/2 = dt/4 [v.C.v].
double Elements::damping_loss(double dt) const {
  return summed_damping_loss_ - dt / 4 * (damping_power_ - first_damping_power_);
}

void Elements::bound_step(StepBounds& bounds) { bounds.nodes = limit_; }

bool Elements::add_tangent(const State& state, Tangent& tangent) const {
  const auto moved = span_ > 0 ? std::span<const double>(moved_) : std::span<const double>();
  elements_.add_tangent(state.layout.of_nodes(state.x), state.layout.node(0), tangent, moved,
                        span_);
  return true;
}

void Elements::add_stiffness(const State& state, NodeStiffness& stiffness) {
  elements_.stiffness_sums(state.layout.of_nodes(state.x), stiffness.elastic);
}

}  // namespace apothem
