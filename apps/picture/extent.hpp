// What part of a run a picture or a movie shows, and the ends of its colour scale.
#pragma once

#include <optional>
#include <vector>

#include "geometry/polygon/point.hpp"

namespace apothem {

/// The box of two opposite corners X0, Y0, X1, Y1 in m, in either order; empty for none. Throws
/// UsageError.
std::optional<Box> box_of(const std::vector<double>& corners);

/// LOW and HIGH, which must be greater; empty for none. Throws UsageError.
std::optional<Vec2> range_of(const std::vector<double>& ends);

}  // namespace apothem
