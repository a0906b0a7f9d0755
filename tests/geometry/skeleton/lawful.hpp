// Straight skeletons that obey their laws.
#pragma once

#include <catch2/catch.hpp>

#include "geometry/skeleton/skeleton.hpp"

namespace apothem::test {

/// The skeleton of a polygon, which has to obey the laws.
inline Skeleton lawful(const Polygon& polygon) {
  Skeleton skeleton = straight_skeleton(polygon);
  const std::optional<std::string> broken = broken_law(skeleton, polygon);
  INFO(broken.value_or(""));
  REQUIRE(!broken);
  return skeleton;
}

}  // namespace apothem::test
