#include "lib/dynamics/islands.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace apothem {
namespace {

// A body rests that has stayed, for one of these parts of the run, within the square of that part
// times what the accuracy lets it be off. If it moved with a constant velocity or acceleration that
// is not noticed by that, it would be off by no more than the accuracy lets it at the end of the
// run. Vibrations take less and less room as they die out: the first part that tells is chosen.
constexpr std::array kPartsOfRun{.01, .03, .1};
// What falls must have been seen to move for the time of a fall over this part.
constexpr double kFallSeen = .01;

}  // namespace

bool Islands::needed(const Model& model, const TimeSettings& time,
                     std::span<const std::unique_ptr<Term>> terms) {
  return time.scheme == TimeScheme::automatic && !model.bodies.empty() &&
         std::ranges::none_of(terms, [](const auto& term) { return term->changes_with_time(); });
}

Islands::Islands(const Model& model, const DegreesOfFreedom& dofs, const TimeSettings& time,
                 const State& state)
    : model_(model), dofs_(dofs), quiet_(model, dofs, time.accuracy), end_(time.end) {
  const size_t bodies = model.bodies.size();
  resting_.resize(bodies);
  factor_.assign(bodies, 1);
  for (const double part : kPartsOfRun) {
    const auto rigid = state.layout.of_rigid(state.x);
    watches_.push_back({part, {rigid.begin(), rigid.end()}});
    watches_.back().since.assign(bodies, state.time);
  }
  const double g = model.strongest_gravity();
  for (size_t b = 0; b < bodies; ++b) {
    fall_.push_back(g > 0 ? std::sqrt(2 * kFallSeen * quiet_.way(3 * b) / g) : 0);
  }
}

bool Islands::is_still(const State& state, const Watch& watch, RigidIndex body) const {
  const size_t first = state.layout.rigid(body);
  for (size_t c = first; c < first + 3; ++c) {
    if (std::abs(state.x[c] - watch.from[c]) > watch.part * watch.part * quiet_.way(c))
      return false;
    if (std::abs(state.v[c]) > quiet_.speed(c)) return false;
  }
  return true;
}

bool Islands::has_rested(const State& state, RigidIndex body) const {
  const auto b = static_cast<size_t>(body);
  return std::ranges::any_of(watches_, [&](const Watch& watch) {
    const double wait = factor_[b] * std::max(watch.part * end_, fall_[b]);
    return state.time - watch.since[b] >= wait;
  });
}

// Whether a body connects those that are near it: what cannot move does not.
bool Islands::joins(BodyIndex body) const {
  if (body >= static_cast<BodyIndex>(model_.bodies.size())) return true;
  if (model_.bodies[body].motion == Motion::prescribed) return true;
  const size_t first = dofs_.layout().rigid(body);
  return !dofs_.is_held(first) || !dofs_.is_held(first + 1) || !dofs_.is_held(first + 2);
}

void Islands::join(std::span<const BoxPair> near, bool only_resting) {
  sets_.reset(model_.bodies.size() + model_.deformables.size());
  for (const BoxPair& pair : near) {
    if (only_resting && !(is_resting(pair.first) && is_resting(pair.second))) continue;
    if (joins(pair.first) && joins(pair.second)) sets_.join(pair.first, pair.second);
  }
}

void Islands::begin_again(const State& state, Watch& watch, RigidIndex body) {
  const size_t first = state.layout.rigid(body);
  std::copy_n(&state.x[first], 3, &watch.from[first]);
  watch.since[static_cast<size_t>(body)] = state.time;
}

void Islands::rouse(const State& state, RigidIndex body) {
  resting_[static_cast<size_t>(body)] = 0;
  for (Watch& watch : watches_) begin_again(state, watch, body);
  // Rest must not take the energy of vibrations again and again.
  factor_[static_cast<size_t>(body)] *= 2;
  ++woken_;
}

bool Islands::look(const State& state, std::span<const BoxPair> near) {
  if (ended_) return false;
  bool some = false;
  const auto bodies = static_cast<RigidIndex>(resting_.size());
  for (RigidIndex b = 0; b < bodies; ++b) {
    if (is_resting(b)) continue;
    for (Watch& watch : watches_) {
      if (!is_still(state, watch, b)) begin_again(state, watch, b);
    }
    some = some || (joins(b) && has_rested(state, b) && !state.is_absent(b));
  }
  if (!some) return false;
  join(near, false);
  const int all = bodies + static_cast<int>(model_.deformables.size());
  std::vector<std::uint8_t> moves(static_cast<size_t>(all), 0);  // of the sets
  for (BodyIndex b = 0; b < all; ++b) {
    if (!joins(b) || state.is_absent(b) || is_resting(b)) continue;
    const bool free = b < bodies && model_.bodies[b].motion == Motion::free;
    if (!free || !has_rested(state, b)) moves[static_cast<size_t>(sets_.find(b))] = 1;
  }
  bool changed = false;
  for (RigidIndex b = 0; b < bodies; ++b) {
    if (!joins(b) || state.is_absent(b) || is_resting(b)) continue;
    if (moves[static_cast<size_t>(sets_.find(b))] != 0) continue;
    resting_[static_cast<size_t>(b)] = 1;
    ++stopped_;
    changed = true;
  }
  return changed;
}

bool Islands::wake(const State& state, std::span<const BoxPair> near) {
  const auto bodies = static_cast<BodyIndex>(resting_.size());
  join(near, true);
  std::vector<std::uint8_t> met(resting_.size(), 0);  // of the sets
  for (const BoxPair& pair : near) {
    for (const auto& [rests, other] :
         {std::pair(pair.first, pair.second), std::pair(pair.second, pair.first)}) {
      if (!is_resting(rests) || is_resting(other) || !joins(other)) continue;
      met[static_cast<size_t>(sets_.find(rests))] = 1;
    }
  }
  const std::int64_t before = woken_;
  for (RigidIndex b = 0; b < bodies; ++b) {
    if (is_resting(b) && met[static_cast<size_t>(sets_.find(b))] != 0) rouse(state, b);
  }
  return woken_ > before;
}

bool Islands::wake_all(const State& state) {
  const std::int64_t before = woken_;
  for (RigidIndex b = 0; b < static_cast<RigidIndex>(resting_.size()); ++b) {
    if (is_resting(b)) rouse(state, b);
  }
  return woken_ > before;
}

std::int64_t Islands::count() const { return std::ranges::count(resting_, 1); }

void Islands::fields(Archive& archive) {
  std::string flags;
  for (const std::uint8_t flag : resting_) flags += static_cast<char>('0' + flag);
  archive("resting", flags);
  if (flags.size() != resting_.size()) throw ArchiveMismatch("resting has another size");
  for (size_t i = 0; i < flags.size(); ++i) {
    resting_[i] = static_cast<std::uint8_t>(flags[i] - '0');
  }
  for (size_t i = 0; i < watches_.size(); ++i) {
    archive.sized(fmt::format("from_{}", i).c_str(), watches_[i].from);
    archive.sized(fmt::format("since_{}", i).c_str(), watches_[i].since);
  }
  archive.sized("factor", factor_);
  archive("stopped", stopped_)("woken", woken_);
}

}  // namespace apothem
