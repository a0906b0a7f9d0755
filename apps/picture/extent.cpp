#include "apps/picture/extent.hpp"

#include <cmath>

#include "apps/commands.hpp"

namespace apothem {

std::optional<Box> box_of(const std::vector<double>& corners) {
  if (corners.empty()) return std::nullopt;
  Box box;
  box.include(corners[0], corners[1]);
  box.include(corners[2], corners[3]);
  if (!(box.x0 < box.x1 && box.y0 < box.y1 && std::isfinite(box.x1 - box.x0) &&
        std::isfinite(box.y1 - box.y0))) {
    throw UsageError("--window", "must be X0,Y0,X1,Y1 in m, of two opposite corners");
  }
  return box;
}

std::optional<Vec2> range_of(const std::vector<double>& ends) {
  if (ends.empty()) return std::nullopt;
  if (!(ends[0] < ends[1] && std::isfinite(ends[1] - ends[0]))) {
    throw UsageError("--range", "must be LOW,HIGH with LOW below HIGH");
  }
  return Vec2(ends[0], ends[1]);
}

}  // namespace apothem
