#include "apothem/dynamics/simulation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apothem/dynamics/contact_term.hpp"
#include "apothem/dynamics/elements.hpp"
#include "apothem/dynamics/equilibrium.hpp"
#include "apothem/dynamics/fold_watch.hpp"
#include "apothem/dynamics/loads.hpp"
#include "apothem/dynamics/mass_damping.hpp"
#include "apothem/dynamics/settle.hpp"
#include "apothem/dynamics/unstable.hpp"

namespace apothem {
namespace {

constexpr std::int64_t kTimedEvery = 64;
constexpr std::int64_t kWatchedEvery = 64;   // steps between looks at the energy in play
constexpr double kOvershoot = 1.05;          // of a step just below the limit: see shorten_step
constexpr double kLargestEnergyError = 0.1;  // of the energy in play

// Energy that round-off alone may move: lifting every body, and pressing contacts, by a few
// roundings of the scene's size.
double energy_noise(const Model& model) {
  Box scene;
  double weight = 0;
  for (const RigidBody& body : model.bodies) {
    scene.include(body.position.x(), body.position.y());
    for (const Vec2& v : body.potential.vertices) {
      scene.include(body.position.x() + v.x(), body.position.y() + v.y());
    }
    if (body.motion == Motion::free) weight += body.mass * model.gravity.norm();
  }
  for (const DeformableBody& body : model.deformables) {
    for (const Vec2& x : body.mesh.nodes) scene.include(x.x(), x.y());
  }
  const double shift = 1e-12 * scene.extent();
  return weight * shift + model.stiffness() * shift * shift;
}

const std::vector<double>& mass_of(const Elements* elements) {
  static const std::vector<double> kNone;
  return elements ? elements->elements().mass() : kNone;
}

}  // namespace

Simulation::Simulation(const Model& model, const TimeSettings& time, int frames, int threads)
    : model_(model),
      own_elements_(Elements::needed(model) ? std::make_unique<Elements>(model, threads) : nullptr),
      dofs_(model, mass_of(own_elements_.get())),
      state_(dofs_.start()),
      ledger_(dofs_),
      automatic_(!time.fixed_step),
      safety_(time.safety),
      lambda_(model.bodies.size()),
      energy_noise_(energy_noise(model)) {
  make_terms(threads);
  StepBounds bounds;
  for (const auto& term : terms_) term->bound_step(bounds);
  choice_ = choose_step(model, time, bounds, frames, ContactTerm::touches_meshes(model));
  if (time.statics && elements_) {
    equilibrium_ = std::make_unique<Equilibrium>(model, dofs_, terms_, time.tolerance);
  }
  try {
    find_forces(state_.v, 0);
    if (time.settled) settle();
  } catch (const Unstable& error) {
    throw Unrunnable(error.what(), "bodies", error.body());
  }
  ledger_.start(state_, energies_of_terms());
}

Simulation::~Simulation() = default;

// The order of the list is that in which forces are summed.
void Simulation::make_terms(int threads) {
  if (own_elements_) {
    elements_ = own_elements_.get();
    elements_->start(dofs_, state_);
    terms_.push_back(std::move(own_elements_));
  }
  if (Loads::needed(model_)) terms_.push_back(std::make_unique<Loads>(model_));
  if (ContactTerm::needed(model_)) {
    auto contact = std::make_unique<ContactTerm>(model_, dofs_, state_, threads);
    contact_ = contact.get();
    terms_.push_back(std::move(contact));
  }
  if (MassDamping::needed(model_)) terms_.push_back(std::make_unique<MassDamping>(model_, dofs_));
  if (FoldWatch::needed(model_)) terms_.push_back(std::make_unique<FoldWatch>(model_));
}

void Simulation::add(std::unique_ptr<Term> term) {
  terms_.push_back(std::move(term));
  if (state_.step > 0) {  // of a checkpoint, whose forces and ledger know of the term
    terms_.back()->refresh(state_);
    return;
  }
  find_forces(state_.v, 0);
  ledger_.start(state_, energies_of_terms());
}

void Simulation::step() {
  const double dt = choice_.step;
  const bool timed = state_.step % kTimedEvery == 0;
  clock_.start(timed);
  damp(dt / 2);
  dofs_.kick(state_, dt / 2);
  advance_time();
  dofs_.steer(state_, dt);
  ledger_.book_before_drift(state_, dt);
  for (const auto& term : terms_) term->book(state_, dt / 2, ledger_);
  dofs_.drift(state_, dt);
  for (const auto& term : terms_) term->check_drift(state_, dt);
  clock_.lap(Phase::integrate);
  find_forces(state_.v, dt);
  ledger_.book_after_drift(state_, dt);
  for (const auto& term : terms_) term->book(state_, dt / 2, ledger_);
  dofs_.kick(state_, dt / 2);
  dofs_.follow(state_);
  damp(dt / 2);
  shorten_step();
  clock_.lap(Phase::integrate);
  timed_steps_ += timed;
  if (state_.step % kWatchedEvery == 0) watch();
}

void Simulation::damp(double h) {
  for (const auto& term : terms_) term->damp(state_, h, ledger_);
}

void Simulation::advance_time() {
  ++state_.step;
  state_.time = base_time_ + static_cast<double>(state_.step - base_step_) * choice_.step;
}

void Simulation::find_forces(std::span<const double> velocity, double dt) {
  std::ranges::fill(state_.layout.of_rigid(state_.f), 0.);
  std::fill(lambda_.begin(), lambda_.end(), 0.);
  for (const auto& term : terms_) term->add_forces({state_, velocity, dt, lambda_, clock_});
}

LoadStep Simulation::balance(double time, const std::function<bool()>& stop) {
  const State before = state_;
  const LoadStep result = equilibrium_->find(state_, ledger_, time, stop);
  if (!result.complete) return result;
  dofs_.plan_moves(before, time);
  ledger_.book_after_drift(before, 0);
  for (const auto& term : terms_) term->watch(state_);
  dofs_.follow(state_);
  find_forces(state_.v, 0);
  ledger_.book_after_drift(state_, 0);
  return result;
}

void Simulation::inherit(const ContactMemory& memory) {
  if (!contact_) return;
  contact_->inherit(memory);
  contact_->start_ledger();
  find_forces(state_.v, 0);
  ledger_.start(state_, energies_of_terms());
}

void Simulation::settle() {
  apothem::settle({model_, dofs_, state_, lambda_, choice_.stability},
                  [&](std::span<const double> velocity, double dt) { find_forces(velocity, dt); });
  for (const auto& term : terms_) term->start_ledger();
}

void Simulation::watch() {
  // Energies may be asked for at the top of a bounce, where all there was is in the height.
  const double kinetic = dofs_.kinetic(state_);
  if (!std::isfinite(kinetic)) refuse_infinite(state_, "a body");
  energy_in_play_ = std::max(energy_in_play_, kinetic);
  for (const auto& term : terms_) term->watch(state_);
}

// The limit known before the run holds for two bodies flat on each other; a body squeezed between
// several is stiffer. An automatic step then shrinks by whole halves and never grows again: a step
// that follows the contact would make the energy drift. The bound counts the short flanks of a flat
// contact as well, which do not press: a fixed step may exceed it by a little.
void Simulation::shorten_step() {
  const auto worst = std::max_element(lambda_.begin(), lambda_.end());
  if (worst == lambda_.end()) return;
  const double largest = automatic_ ? safety_ : kOvershoot;
  if (!(choice_.step * choice_.step * *worst > 4 * largest * largest)) return;
  const double limit = 2 / std::sqrt(*worst);
  const std::string& name = model_.bodies[static_cast<size_t>(worst - lambda_.begin())].name;
  if (!automatic_) {
    throw Unstable(
        fmt::format("the step of {} s is above the stability limit of {:.6g} s of the "
                    "contacts of body \"{}\" {}; give a smaller time.step or \"auto\"",
                    choice_.step, limit, name, at_time(state_)));
  }
  base_time_ = state_.time;
  base_step_ = state_.step;
  while (choice_.step > safety_ * limit) choice_.step /= 2;
  choice_.stability = limit;
  choice_.limit = {limit, fmt::format("contacts of \"{}\" {}", name, at_time(state_))};
}

Energies Simulation::energies_of_terms() {
  Energies sum;
  for (const auto& term : terms_) term->add_energies(state_, choice_.step, sum);
  return sum;
}

Energies Simulation::energies() {
  const Energies e = ledger_.close(state_, energies_of_terms());
  energy_in_play_ =
      std::max(energy_in_play_, e.kinetic + e.strain + e.contact + std::abs(e.external_work));
  energy_error_ = std::max(energy_error_, std::abs(e.total_error));
  // A load step that comes at once gives off energy; that is no error of the equilibrium.
  if (equilibrium_) return e;
  if (!(std::abs(e.total_error) <= kLargestEnergyError * energy_in_play_ + energy_noise_)) {
    throw Unstable(
        fmt::format("{:.3g} J of the {:.3g} J in play are unaccounted for {}: the step is too "
                    "long for this impact; reduce time.step or time.safety",
                    e.total_error, energy_in_play_, at_time(state_)));
  }
  return e;
}

void Simulation::fields(Archive& archive) {
  archive("state", state_)("ledger", ledger_);
  archive("step_size", choice_.step)("step_limit", choice_.limit.step)(
      "step_limited_by", choice_.limit.reason)("stability_limit", choice_.stability);
  archive("base_time", base_time_)("base_step", base_step_);
  archive("energy_in_play", energy_in_play_)("energy_error", energy_error_);
  for (size_t i = 0; i < terms_.size(); ++i) archive(fmt::format("term_{}", i).c_str(), *terms_[i]);
  if (equilibrium_) archive("equilibrium", *equilibrium_);
}

void Simulation::refresh() {
  for (const auto& term : terms_) term->refresh(state_);
  ledger_.refresh(state_);
  steps_before_ = state_.step;
}

}  // namespace apothem
