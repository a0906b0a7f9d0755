// The load steps of static runs: a given number of them, or as far as the loads can grow.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lib/dynamics/unstable.hpp"
#include "lib/run/run.hpp"

namespace apothem {

// Where the next load step ends, s.
double Run::next_load_time() const {
  if (scene_.time.automatic_load_steps) return progress_.load_path.next(state().time);
  const std::int64_t count = scene_.time.load_steps, next = state().step + 1;
  return next < count ? scene_.time.end * static_cast<double>(next) / static_cast<double>(count)
                      : scene_.time.end;
}

namespace {

[[noreturn]] void refuse_search(double tolerance, double time) {
  throw Unstable(fmt::format(
      "Newton's method finds no equilibrium at t = {:.9g} s, although no body moves away from the "
      "last one: this is no collapse. Another contact.normal_stiffness, or a time.tolerance above "
      "{:g}, may help",
      time, tolerance));
}

}  // namespace

// As far as the loads can grow; after the last of these steps the run has ended.
bool Run::automatic_load_step() {
  LoadPath& path = progress_.load_path;
  const auto pause = [&] { return asked_to_stop() || checkpoint_due(); };
  for (;;) {
    const double before = state().time, time = path.next(before);
    std::vector<double> motion;
    const LoadStep found = simulation_->balance_near(time, pause, motion);
    if (!found.complete) {
      if (asked_to_stop()) return false;
      write_checkpoint();
      continue;
    }
    if (found.found) {
      path.found(time);
      progress_.load_steps.push_back(found);
      record(true, true);
      return true;
    }
    if (path.missed(before, time)) {
      if (!is_mechanism(scene_.model, state(), motion)) refuse_search(scene_.time.tolerance, time);
      end_by_collapse(time, std::move(motion));
      return true;
    }
  }
}

void Run::end_by_collapse(double upper, std::vector<double> motion) {
  const double scale = shown_scale(scene_.model, state(), motion);
  collapse_ = {state().time, upper, std::move(motion), scale};
  if (scene_.rigid) {
    const double here = collapse_->factor();
    collapse_->rigid = progress_.rigid.factor().value_or(Estimate{here, HUGE_VAL});
  }
  stopped_by_ = kStoppedCollapse;
  message_ = describe(scene_.model, state(), *collapse_);
  write_mechanism();
}

// The last frame: the bodies on their way at the limit. Nothing touches in it, because it is not an
// equilibrium.
void Run::write_mechanism() {
  if (!history_) return;
  State shown = state();
  shown.time = collapse_->upper;
  for (size_t c = 0; c < shown.x.size(); ++c) {
    shown.x[c] += collapse_->scale * collapse_->motion[c];
  }
  collapse_->frame = static_cast<int>(frames_->times().size());
  const Simulation& s = *simulation_;
  const std::vector<CauchyStress> stresses = s.stresses();
  const std::vector<BodyForce> none(scene_.model.bodies.size() + scene_.model.deformables.size());
  frames_->write({shown,
                  {},
                  stresses,
                  s.surfaces(),
                  none,
                  s.node_mass(),
                  body_statistics(scene_.model, shown, {}, stresses)});
}

bool Run::seeks_collapse() const {
  const auto names = [](const Reduction& r) { return r.quantity == kCollapseFactor; };
  const auto asks = [&](const Measure& m) {
    return m.stopped_by.empty() ? names(m.of) : m.stopped_by == kStoppedCollapse;
  };
  return std::ranges::any_of(scene_.expectations, names) ||
         std::ranges::any_of(scene_.measures, asks);
}

bool Run::load_step() {
  if (scene_.time.automatic_load_steps) return automatic_load_step();
  const double time = next_load_time();
  const auto pause = [&] { return asked_to_stop() || checkpoint_due(); };
  LoadStep found = simulation_->balance(time, pause);
  while (!found.complete && !asked_to_stop()) {
    write_checkpoint();
    found = simulation_->balance(time, pause);
  }
  if (!found.complete) return false;
  progress_.load_steps.push_back(found);
  record(true, true);
  return true;
}

}  // namespace apothem
