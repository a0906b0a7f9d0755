// How a long computation tells how far it has come, and how it is ended before its time.
#pragma once

#include <functional>
#include <optional>
#include <string_view>

namespace apothem {

/// How far a long computation has come.
struct Stage {
  std::string_view name;       ///< what is being computed
  std::optional<double> done;  ///< share of this stage that is done, 0 to 1, if it is known
};

/// Called several times a second, or every hundredth of a stage. It may throw, which ends the
/// computation and its helper processes.
using Progress = std::function<void(const Stage&)>;

}  // namespace apothem
