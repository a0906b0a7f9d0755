#include "lib/dynamics/unstable.hpp"

#include <fmt/format.h>

namespace apothem {

std::string at_time(const State& state) {
  return fmt::format("at t = {:.9g} s (step {})", state.time, state.step);
}

void refuse_infinite(const State& state, const std::string& what, RigidIndex body) {
  throw Unstable(fmt::format("the position of {} is not finite {}: the run has become unstable; "
                             "reduce the time step",
                             what, at_time(state)),
                 body);
}

}  // namespace apothem
