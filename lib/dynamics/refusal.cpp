// Where bodies go while Newton's method seeks an equilibrium, and what is said if it finds none.
#include <fmt/format.h>

#include <algorithm>

#include "lib/dynamics/contact_term.hpp"
#include "lib/dynamics/departure.hpp"
#include "lib/dynamics/equilibrium.hpp"
#include "lib/dynamics/unstable.hpp"

namespace apothem {
namespace {

constexpr double kLost = 3;  // of the scene's size, beyond what prescribed motion does

}  // namespace

// Whether the bodies are still where an equilibrium may be, at the end of an implicit step, while
// their contacts tell what they do.
bool Equilibrium::stays(const State& state, const State& before, const NewtonPath& path) {
  const bool lost = !note_departure(state, before);
  return near_ ? !strays(state, path.x_done) : !lost;
}

// Notes what the first body does that leaves its neighbourhood. False if a body is lost.
bool Equilibrium::note_departure(const State& state, const State& before) {
  const BodyIndex mover = farthest_mover(state, before);
  if (mover < 0) return true;
  const double way = motion_of(model_, state, before, mover).most();
  if (departed_ < 0 && way > kNear * inradius_[mover] + driven_way_) {
    departed_ = mover;
    departure_ = departure_of(mover, state, before);
  }
  return way <= kLost * extent_ + driven_way_;
}

// The free body that has moved farthest, in parts of its inradius; -1 if none has moved.
BodyIndex Equilibrium::farthest_mover(const State& state, const State& before) const {
  double farthest = 0;
  BodyIndex mover = -1;
  for (BodyIndex b = 0; b < static_cast<BodyIndex>(body_loads_.size()); ++b) {
    if (inradius_[b] == 0) continue;
    const double part = motion_of(model_, state, before, b).most() / inradius_[b];
    if (part > farthest) farthest = part, mover = b;
  }
  return mover;
}

// Whether a body has come to another place than it had, which is not near the last equilibrium.
void Equilibrium::note_move(const State& state, const State& before, LoadStep& result) const {
  const BodyIndex mover = farthest_mover(state, before);
  if (mover < 0) return;
  const double way = motion_of(model_, state, before, mover).most() - driven_way_;
  if (way > inradius_[mover]) result.moved = mover, result.way = way;
}

Departure Equilibrium::departure_of(BodyIndex body, const State& state, const State& before) const {
  return describe_departure(
      model_, state, before, body,
      contact_ ? contact_->contacts().records() : std::vector<ContactRecord>());
}

// Notes where the search ends that has found nothing: at the last implicit step.
void Equilibrium::note_end(State& state, const State& before, const NewtonPath& path,
                           const LoadStep& result) {
  state.x = path.base;
  const bool fine = try_forces(state);
  for (const RigidIndex wall : walls_) {
    if (!(motion_of(model_, state, before, wall).most() > kNear * model_.bodies[wall].inradius))
      continue;
    at_end_.words =
        fmt::format("the servo wall \"{}\" goes on: what it presses on does not bear its force",
                    model_.bodies[wall].name);
    return;
  }
  const BodyIndex mover = farthest_mover(state, before);
  if (fine && mover >= 0) {
    at_end_ = departure_of(mover, state, before);
    return;
  }
  at_end_.words = fmt::format("the forces on \"{}\" are out of balance",
                              model_.name_of(std::max(result.unbalanced, 0)));
}

// Whether a free body has left the neighbourhood of the last equilibrium, whose places are `from`.
// While weight grows, bodies of finite elements may come farther until they are held.
bool Equilibrium::strays(const State& state, const std::vector<double>& from) const {
  State start = state;
  start.x = from;
  const size_t count = weight_grows_ ? model_.bodies.size() : body_loads_.size();
  for (BodyIndex b = 0; b < static_cast<BodyIndex>(count); ++b) {
    if (inradius_[b] == 0) continue;
    const double way = motion_of(model_, state, start, b).most();
    if (!(way <= kNear * inradius_[b] + driven_way_)) return true;
  }
  return false;
}

// Newton's method has found nothing. Where a body has left its place that is the reason.
void Equilibrium::refuse(const State& state, const LoadStep& result) const {
  const auto rigid = static_cast<BodyIndex>(model_.bodies.size());
  const std::string what =
      departed_ >= 0 ? departure_.words
                     : fmt::format("the search for one has come to an end where {}", at_end_.words);
  throw Unstable(fmt::format("no equilibrium at t = {:.9g} s (load step {}): {}; {}", result.time,
                             state.step, what, advice()),
                 departed_ >= 0 && departed_ < rigid ? departed_ : -1);
}

// What helps where no equilibrium is found.
std::string Equilibrium::advice() const {
  if (!slip_.empty()) {
    return "support it, let prescribed velocities begin at 0, or leave out time.start";
  }
  return settling_ ? "support it, or leave out time.start"
                   : "support it, reduce the load, or raise time.load_steps";
}

}  // namespace apothem
