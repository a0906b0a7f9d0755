#include "lib/run/stop_watch.hpp"

#include <algorithm>

#include "lib/model/statistics.hpp"

namespace apothem {

std::string StopWatch::look(const State& state, const std::vector<double>& node_mass,
                            double seconds) {
  for (size_t i = 0; i < rules_.size(); ++i) {
    const StopRule& rule = rules_[i];
    if (rule.wall_clock) {
      if (seconds >= *rule.wall_clock) return rule.name;
      continue;
    }
    Watched& watched = watched_[i];
    const bool now = holds(rule, watched, state, node_mass) && state.time >= rule.after;
    if (!now) {
      watched.since = -1;
      continue;
    }
    if (watched.since < 0) watched.since = state.time;
    if (state.time - watched.since >= rule.hold) return rule.name;
  }
  return {};
}

bool StopWatch::is_wall_clock(const std::string& name) const {
  return std::ranges::any_of(
      rules_, [&](const StopRule& rule) { return rule.wall_clock && rule.name == name; });
}

bool StopWatch::holds(const StopRule& rule, Watched& watched, const State& state,
                      const std::vector<double>& node_mass) const {
  const Crowd crowd = crowd_in(model_, state, node_mass, rule.region);
  const auto count = static_cast<int>(crowd.members.size());
  if (rule.no_exit_for) {
    if (!std::ranges::includes(crowd.members, watched.members)) watched.last_exit = state.time;
    watched.members = crowd.members;
    if (state.time - watched.last_exit < *rule.no_exit_for) return false;
  }
  if (rule.count_below && count >= *rule.count_below) return false;
  if (rule.count_above && count < *rule.count_above) return false;
  return !rule.kinetic_per_body ||
         crowd.kinetic < *rule.kinetic_per_body * static_cast<double>(std::max(count, 1));
}

}  // namespace apothem
