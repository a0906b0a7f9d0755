// Watches the rules by which a run ends before its time.
#pragma once

#include <string>
#include <vector>

#include "lib/archive/archive.hpp"
#include "lib/model/model.hpp"
#include "lib/model/settings.hpp"
#include "lib/model/state.hpp"

namespace apothem {

class StopWatch {
 public:
  /// Both must outlive this object.
  StopWatch(const Model& model, const std::vector<StopRule>& rules)
      : model_(model), rules_(rules), watched_(rules.size()) {}

  /// Looks at the state. The name of the first rule that asks the run to stop, or empty.
  /// `node_mass` in kg; `seconds` of real time since the run was started.
  std::string look(const State& state, const std::vector<double>& node_mass, double seconds);
  /// True if the rule of this name goes by real time: the run can then be continued.
  [[nodiscard]] bool is_wall_clock(const std::string& name) const;

  void fields(Archive& archive) { archive("rules", watched_); }

 private:
  /// What is remembered of a rule.
  struct Watched {
    double since = -1;         ///< s, all its conditions hold since then; below 0: they do not
    double last_exit = 0;      ///< s, when a body was last seen to have left the region
    std::vector<int> members;  ///< bodies in the region at the last look
    void fields(Archive& archive) {
      archive("since", since)("last_exit", last_exit)("members", members);
    }
  };
  [[nodiscard]] bool holds(const StopRule& rule, Watched& watched, const State& state,
                           const std::vector<double>& node_mass) const;

  const Model& model_;
  const std::vector<StopRule>& rules_;
  std::vector<Watched> watched_;
};

}  // namespace apothem
