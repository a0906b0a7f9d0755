#include "lib/dynamics/simulation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lib/dynamics/contact_term.hpp"
#include "lib/dynamics/elements.hpp"
#include "lib/dynamics/equilibrium.hpp"
#include "lib/dynamics/fold_watch.hpp"
#include "lib/dynamics/gravity_history.hpp"
#include "lib/dynamics/implicit.hpp"
#include "lib/dynamics/islands.hpp"
#include "lib/dynamics/loads.hpp"
#include "lib/dynamics/mass_damping.hpp"
#include "lib/model/columns.hpp"
#include "lib/model/pairs.hpp"

namespace apothem {
namespace {

// Steps between those that are timed: primes, so that they do not go with what is done every 64
// steps. The clock takes 0.2 microseconds.
constexpr std::int64_t kTimedEvery = 61;
constexpr std::int64_t kLongOnesTimedEvery = 5;
constexpr size_t kLong = 300;               // coordinates
constexpr double kSettled = 1e-9;           // of the loads, out of balance at a settled start
constexpr std::int64_t kWatchedEvery = 64;  // steps between looks at places and shapes
constexpr double kMostTicks = 1e15;         // of an implicit step

const std::vector<double>& mass_of(const Elements* elements) {
  static const std::vector<double> kNone;
  return elements ? elements->elements().mass() : kNone;
}

}  // namespace

Simulation::Simulation(const Model& model, const TimeSettings& time, int frames, int threads,
                       const std::function<bool()>& stop)
    : model_(model),
      own_elements_(Elements::needed(model) ? std::make_unique<Elements>(model, threads) : nullptr),
      dofs_(model, mass_of(own_elements_.get()), threads),
      state_(dofs_.start()),
      ledger_(dofs_),
      onsets_(time.onsets),
      forces_(state_.f.size()),
      lambda_(model.bodies.size()),
      guard_(model) {
  if (Population::needed(model)) {
    population_ = std::make_unique<Population>(model);
    state_.absent = Population::absent_at_start(model);
    take_absent_out();
    state_.v = dofs_.start().v;
  }
  make_terms(threads);
  StepBounds bounds;
  for (const auto& term : terms_) term->bound_step(bounds);
  control_.emplace(model, time, bounds, frames, ContactTerm::touches_meshes(model));
  if (time.statics) {
    equilibrium_ = std::make_unique<Equilibrium>(model, dofs_, terms_, contact_, time.tolerance);
  }
  if (time.scheme != TimeScheme::verlet) {
    implicit_ = std::make_unique<ImplicitSteps>(model, time, dofs_, terms_, contact_);
  }
  if (contact_ && Islands::needed(model, time, terms_)) {
    islands_ = std::make_unique<Islands>(model, dofs_, time, state_);
    contact_->let_bodies_rest();
  }
  try {
    find_forces(state_.v, 0);
    if (time.settled) {
      settle(stop);
    } else {
      finish_look();
    }
  } catch (const Unstable& error) {
    throw Unrunnable(error.what(), "bodies", error.body());
  }
  if (!model.deformables.empty()) note_turns(model, node_mass(), state_);
  start_ledger();
}

Simulation::~Simulation() = default;

// The order of the list is that in which forces are summed.
void Simulation::make_terms(int threads) {
  if (own_elements_) {
    elements_ = own_elements_.get();
    elements_->start(dofs_, state_);
    terms_.push_back(std::move(own_elements_));
  }
  if (GravityHistory::needed(model_)) {
    terms_.push_back(std::make_unique<GravityHistory>(model_, dofs_));
  }
  if (Loads::needed(model_)) terms_.push_back(std::make_unique<Loads>(model_));
  if (ContactTerm::needed(model_)) {
    auto contact = std::make_unique<ContactTerm>(model_, dofs_, state_, threads);
    contact_ = contact.get();
    terms_.push_back(std::move(contact));
  }
  if (MassDamping::needed(model_)) {
    terms_.push_back(std::make_unique<MassDamping>(model_, dofs_, threads));
  }
  if (FoldWatch::needed(model_)) terms_.push_back(std::make_unique<FoldWatch>(model_));
}

void Simulation::add(std::unique_ptr<Term> term) {
  wake_all();
  if (islands_) islands_->end();  // a term may push a body that rests
  terms_.push_back(std::move(term));
  if (state_.step > 0) {  // of a checkpoint, whose forces and ledger know of the term
    terms_.back()->refresh(state_);
    return;
  }
  find_forces(state_.v, 0);
  start_ledger();
}

void Simulation::start_ledger() {
  const Energies terms = energies_of_terms();
  ledger_.start(state_, terms);
  guard_.start(ledger_.close(state_, terms));
}

void Simulation::step(double horizon) {
  try {
    if (!implicit_ || !take_implicit_step(horizon)) take_step();
  } catch (const Unstable& error) {
    explain(error);
  }
}

// Where elements have collapsed, or a body cannot feel itself any more, all that follows from it is
// misleading.
void Simulation::explain(const Unstable& error) const {
  const std::string collapse = elements_ ? elements_->collapse(state_) : "";
  if (!collapse.empty()) throw Unstable(collapse, error.body());
  const std::string notch = contact_ ? contact_->closed_notch() : "";
  if (notch.empty()) throw error;
  throw Unstable(fmt::format("{}. The cause may be that {}", error.what(), notch), error.body());
}

void Simulation::take_step() {
  const double dt = step_size();
  const auto every = state_.layout.size() < kLong ? kTimedEvery : kLongOnesTimedEvery;
  const bool timed = state_.step % every == 0;
  clock_.start(timed);
  damp(dt / 2);
  dofs_.kick(state_, dt / 2);
  control_->advance(state_);
  dofs_.steer(state_, dt);
  ledger_.book_before_drift(state_, dt);
  for (const auto& term : terms_) term->book(state_, dt / 2, ledger_);
  dofs_.drift(state_, dt);
  if (contact_) contact_->check_drift(state_, dt);
  clock_.lap(Phase::integrate);
  if (needs_forces_before()) forces_ = state_.f;
  find_forces(state_.v, dt, control_->deciding_lambda());
  const bool onsets = contact_ && finish_contact(dt);
  ledger_.book_after_drift(state_, dt);
  for (const auto& term : terms_) term->book(state_, dt / 2, ledger_);
  dofs_.kick(state_, dt / 2);
  if (onsets) state_.f = forces_;
  dofs_.follow(state_);
  damp(dt / 2);
  control_->follow(state_, lambda_);
  clock_.lap(Phase::integrate);
  ++verlet_steps_;
  timed_steps_ += timed;
  watch();
}

// False if velocity Verlet is to take the step.
bool Simulation::take_implicit_step(double horizon) {
  const double dt = step_size();
  if (!implicit_->due(state_, dt)) return false;
  const double left = std::min(std::ceil((horizon - state_.time) / dt - 1e-6), kMostTicks);
  if (implicit_->is_frozen(state_)) return rest(std::max<std::int64_t>(1, std::int64_t(left)));
  const double error = energies().total_error;
  clock_.start(false);
  const std::int64_t ticks = implicit_->try_step(
      state_, *control_, std::max<std::int64_t>(1, static_cast<std::int64_t>(left)));
  if (ticks == 0) {
    restore_forces();
    return false;
  }
  control_->advance(state_, ticks);
  const StepMotion motion = implicit_->motion(state_);
  find_forces(state_.v, 0, 0, &motion);
  if (contact_) contact_->silence_dashpots(state_);
  const State& middle = implicit_->finish(state_);
  const double h = implicit_->length();
  for (const auto& term : terms_) term->book(middle, h, ledger_);
  ledger_.book_implicit(implicit_->before(), state_, h);
  damp(h);
  ledger_.add_numerical_loss(error - energies().total_error);
  implicit_->follow(state_, dt, energies());
  if (!implicit_->running()) restore_forces();
  watch(true);
  return true;
}

// A step in which nothing moves, as it would come out.
bool Simulation::rest(std::int64_t ticks) {
  const double h = static_cast<double>(ticks) * step_size();
  control_->advance(state_, ticks);
  dofs_.steer(state_, h);
  ledger_.book_implicit(state_, state_, h);
  implicit_->count_rest(ticks);
  watch(population_ != nullptr);
  return true;
}

// What velocity Verlet goes on from after an implicit step, or after one that has been given up.
void Simulation::restore_forces() {
  if (contact_) contact_->drop_trial();
  for (const auto& term : terms_) term->refresh(state_);
  find_forces(state_.v, 0);
  finish_look();
}

const ImplicitCounts* Simulation::implicit_counts() const {
  return implicit_ ? &implicit_->counts() : nullptr;
}

void Simulation::take_absent_out() {
  dofs_.set_absent(state_.absent);
  if (contact_) contact_->set_absent(state_.absent);
}

void Simulation::change_population(std::span<const BodyIndex> leave,
                                   std::span<const BodyIndex> come) {
  const auto rests = [&](BodyIndex b) { return islands_ && islands_->is_resting(b); };
  if (std::ranges::any_of(leave, rests)) wake_all();
  const double error = energies().total_error;
  const Impulse momentum = dofs_.momentum(state_);
  const auto mark = [&](BodyIndex b, Presence presence) {
    state_.absent[static_cast<size_t>(b)] = static_cast<std::uint8_t>(presence);
  };
  for (const BodyIndex b : leave) mark(b, Presence::left);
  for (const BodyIndex b : come) mark(b, Presence::present);
  take_absent_out();
  const auto copy_velocity = [&](BodyIndex b, const State& from) {
    const auto [first, end] = dofs_.coordinates(b);
    for (size_t c = first; c < end; ++c) state_.v[c] = from.v[c];
  };
  const State start = dofs_.start(), rest(state_.layout);
  for (const BodyIndex b : leave) copy_velocity(b, rest);
  for (const BodyIndex b : come) copy_velocity(b, start);
  find_forces(state_.v, 0);
  finish_look();
  ledger_.refresh(state_);
  book_change(error, momentum);
}

void Simulation::set_velocities(std::span<const double> velocities) {
  wake_all();
  const double error = energies().total_error;
  const Impulse momentum = dofs_.momentum(state_);
  for (size_t c = 0; c < velocities.size(); ++c) {
    if (dofs_.can_move(c)) state_.v[c] = velocities[c];
  }
  book_change(error, momentum);
}

void Simulation::book_change(double error, const Impulse& momentum) {
  if (implicit_) implicit_->disturb();
  const Impulse after = dofs_.momentum(state_);
  ledger_.add_work(energies().total_error - error);
  ledger_.add_impulse(
      {after.x - momentum.x, after.y - momentum.y, after.angular - momentum.angular});
}

// Looks who has come to rest, and wakes those that another body comes near.
void Simulation::follow_rest(bool regular) {
  const std::span<const BoxPair> near = contact_->contacts().near();
  bool changed = contact_->disturbs_rest() && islands_->wake(state_, near);
  if (regular) changed = islands_->look(state_, near) || changed;
  if (changed) change_rest();
}

void Simulation::wake_all() {
  if (islands_ && islands_->wake_all(state_)) change_rest();
}

// Bodies that rest stop, and bodies that have been woken begin to move from where they are.
void Simulation::change_rest() {
  const double error = energies().total_error;
  const Impulse momentum = dofs_.momentum(state_);
  const std::vector<std::uint8_t>& resting = islands_->resting();
  for (size_t c = 0; c < 3 * resting.size(); ++c) {
    if (resting[c / 3] != 0) state_.v[c] = 0;
  }
  dofs_.set_resting(resting, state_);
  contact_->set_resting(resting, state_);
  find_forces(state_.v, 0);
  finish_look();
  ledger_.refresh(state_);
  const Impulse after = dofs_.momentum(state_);
  ledger_.add_numerical_loss(error - energies().total_error);
  ledger_.add_impulse(
      {after.x - momentum.x, after.y - momentum.y, after.angular - momentum.angular});
  implicit_->disturb();
}

void Simulation::damp(double h) {
  for (const auto& term : terms_) term->damp(state_, h, ledger_);
}

// `implicit`: at the end of such a step.
void Simulation::find_forces(std::span<const double> velocity, double dt, double lambda_limit,
                             const StepMotion* implicit) {
  std::ranges::fill(state_.layout.of_rigid(state_.f), 0.);
  std::ranges::fill(lambda_, 0.);
  for (const auto& term : terms_) {
    term->add_forces({.state = state_,
                      .velocity = velocity,
                      .dt = dt,
                      .lambda = lambda_,
                      .clock = clock_,
                      .lambda_limit = lambda_limit,
                      .still = implicit != nullptr,
                      .step = implicit ? *implicit : StepMotion()});
  }
}

bool Simulation::needs_forces_before() const {
  return contact_ && (onsets_ || contact_->dissipates());
}

// After the forces at the end of the drift, with those at its start in forces_. Contacts that begin
// or end within the step push in its second half as if they had pushed when they did. True if there
// are any: state.f holds their forces as well, and forces_ the others alone.
bool Simulation::finish_contact(double dt) {
  const bool onsets = onsets_ && contact_->find_event_impulses(state_, forces_, dt);
  if (contact_->damped()) contact_->add_dashpots(state_, dt, onsets, false);
  if (contact_->dissipates()) contact_->add_bend_losses(state_, forces_, dt);
  if (!onsets) return false;
  forces_ = state_.f;
  contact_->add_event_impulses(state_);
  return true;
}

// After forces that have been found where nothing has moved.
void Simulation::finish_look() {
  if (!contact_) return;
  if (onsets_) contact_->find_event_impulses(state_, forces_, 0);
  if (contact_->damped() && !equilibrium_) {
    contact_->add_dashpots(state_, step_size() / 2, false, true);
  }
}

LoadStep Simulation::balance(double time, const std::function<bool()>& stop) {
  const State before = state_;
  LoadStep result;
  try {
    result = equilibrium_->find(state_, ledger_, time, stop);
  } catch (const Unstable& error) {
    explain(error);
  }
  if (result.complete) finish_load_step(before, time);
  return result;
}

LoadStep Simulation::balance_near(double time, const std::function<bool()>& stop,
                                  std::vector<double>& motion) {
  const State before = state_;
  LoadStep result = equilibrium_->find_near(state_, ledger_, time, stop, motion);
  if (result.complete && result.found) finish_load_step(before, time);
  return result;
}

void Simulation::finish_load_step(const State& before, double time) {
  dofs_.plan_moves(before, time);
  ledger_.book_after_drift(before, 0);
  for (const auto& term : terms_) term->watch(state_);
  dofs_.follow(state_);
  find_forces(state_.v, 0);
  ledger_.book_after_drift(state_, 0);
  if (!state_.turns.empty()) note_turns(model_, node_mass(), state_);
  check_energy();
}

void Simulation::inherit(const FrictionMemory& memory) {
  if (contact_) {
    contact_->inherit(memory);
    contact_->start_ledger();
  }
  find_forces(state_.v, 0);
  finish_look();
  if (equilibrium_) equilibrium_->begin_loaded();
  start_ledger();
}

void Simulation::settle(const std::function<bool()>& stop) {
  if (!contact_ && model_.deformables.empty()) {
    throw Unrunnable("nothing can touch anything: no body comes to rest; leave out time.start",
                     "time/start", -1);
  }
  // Friction at its limit must not follow the dashpots of a motion that is over.
  if (contact_) contact_->silence_dashpots(state_);
  Equilibrium equilibrium(model_, dofs_, terms_, contact_, kSettled);
  try {
    equilibrium.settle(state_, stop);
  } catch (const Unstable& error) {
    throw Unrunnable(error.what(), "time/start", -1);
  }
  find_forces(state_.v, 0);
  for (const auto& term : terms_) term->start_ledger();
  finish_look();
  start_ledger();
}

void Simulation::watch(bool always) {
  const bool regular = always || state_.step % kWatchedEvery == 0;
  if (regular) {
    if (!std::isfinite(dofs_.kinetic(state_))) refuse_infinite(state_, "a body");
    for (const auto& term : terms_) term->watch(state_);
    if (!state_.turns.empty()) note_turns(model_, node_mass(), state_);
  }
  if (islands_) follow_rest(regular);
  if (guard_.due(state_.step, losses(), counts().touching_now)) look_at_energy(false);
  if (!regular || !population_) return;
  const Population::Change change = population_->look(state_);
  if (!change.empty()) change_population(change.leave, change.come);
}

void Simulation::check_energy() { look_at_energy(true); }

void Simulation::look_at_energy(bool last) {
  const Energies e = energies();
  if (!std::isfinite(e.total_error)) refuse_infinite(state_, "a body or node");
  const EnergyGuard::Verdict verdict = guard_.judge(state_.step, e, last);
  const std::int64_t touching = counts().touching_pairs;
  // A load step that comes at once gives off energy; that is no error of the equilibrium.
  if (verdict != EnergyGuard::Verdict::good && !equilibrium_) {
    refuse_energy(verdict, e.total_error, touching > touching_before_);
  }
  // What an excess is due to came before it.
  if (state_.step % EnergyGuard::kEvery == 0 && std::abs(e.total_error) <= guard_.allowed())
    touching_before_ = touching;
}

void Simulation::refuse_energy(EnergyGuard::Verdict verdict, double error, bool touched) const {
  std::string stiffest;
  const PairPeak pair = contact_ ? contact_->contacts().largest_force() : PairPeak{};
  if (pair.a >= 0) {
    stiffest = fmt::format(", of which \"{}\" with \"{}\" has the largest force",
                           model_.name_of(pair.a), model_.name_of(pair.b));
  }
  if (verdict == EnergyGuard::Verdict::numerical) {
    throw Unstable(fmt::format(
        "implicit steps have given {:.3g} J back of what they had taken, which is energy out of "
        "nothing, {}; {:.3g} J are in play: reduce the time step",
        guard_.numerical_fall(), at_time(state_), guard_.in_play()));
  }
  if (verdict != EnergyGuard::Verdict::unaccounted) {
    const bool friction = verdict == EnergyGuard::Verdict::friction;
    throw Unstable(fmt::format(
        "{} has given {:.3g} J back of what it had taken, which is energy out of nothing, {}; "
        "{:.3g} J are in play: the step is too long for the {} of these contacts{}; reduce "
        "{}the time step",
        friction ? "friction" : "damping",
        friction ? guard_.friction_fall() : guard_.damping_fall(), at_time(state_),
        guard_.in_play(), friction ? "friction" : "damping", stiffest,
        friction ? "contact.friction.tangential_stiffness or " : "contact.damping.ratio or "));
  }
  std::string cause = "no bodies touch: the step is too long for what moves them";
  if (touched) {
    cause = "the step is too long for the contacts of these steps" + stiffest;
  } else if (elements_) {
    cause = "no bodies touch: the step is too long for the elements";
  }
  throw Unstable(fmt::format(
      "{:.3g} J of the {:.3g} J in play are unaccounted for {}, a tenth is allowed: {}; reduce "
      "the time step",
      error, guard_.in_play(), at_time(state_), cause));
}

const std::vector<double>& Simulation::node_mass() const { return mass_of(elements_); }

Energies Simulation::losses() const {
  Energies sum;
  for (const auto& term : terms_) term->add_losses(step_size(), sum);
  return sum;
}

Energies Simulation::energies_of_terms() const {
  Energies sum = losses();
  for (const auto& term : terms_) term->add_energies(state_, sum);
  return sum;
}

Energies Simulation::energies_to_record() {
  const Energies e = energies();
  guard_.record(e);
  return e;
}

Energies Simulation::energies() const { return ledger_.close(state_, energies_of_terms()); }

void Simulation::fields(Archive& archive) {
  archive("state", state_)("ledger", ledger_);
  archive("step_control", *control_);
  archive("energy_guard", guard_)("touching_before", touching_before_);
  if (population_) archive("population", *population_);
  for (size_t i = 0; i < terms_.size(); ++i) archive(fmt::format("term_{}", i).c_str(), *terms_[i]);
  if (equilibrium_) archive("equilibrium", *equilibrium_);
  if (implicit_) archive("implicit", *implicit_);
  if (islands_) archive("islands", *islands_);
}

void Simulation::refresh() {
  if (population_) take_absent_out();
  if (islands_) {
    dofs_.set_resting(islands_->resting(), state_);
    contact_->restore_resting(islands_->resting());
  }
  for (const auto& term : terms_) term->refresh(state_);
  ledger_.refresh(state_);
  steps_before_ = state_.step;
}

}  // namespace apothem
