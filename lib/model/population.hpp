// Which bodies take part in a scene when: those that come later, those that leave the world, and
// the places where bodies are counted.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "geometry/polygon/point.hpp"
#include "lib/mesh/indices.hpp"

namespace apothem {

/// Bodies that are not there at the start. They come batch after batch, each as soon as its time
/// has come and nothing that can move is in its way.
struct Inflow {
  double every = 0;                             ///< s, least time between two batches
  std::vector<std::vector<BodyIndex>> batches;  ///< without the one that is there at the start
};

/// What happens to bodies that leave a box.
struct World {
  enum class Outside { keep, remove, stop };
  Box box;  ///< model coordinates, m
  Outside outside = Outside::keep;
};
/// By the names in scenes, in the order of World::Outside.
inline constexpr std::array kOutsides{"keep", "remove", "stop"};

/// A named part of the plane in which bodies are counted and averaged.
struct Region {
  std::string name;
  std::vector<std::vector<Vec2>> parts;  ///< convex rings that divide it, model coordinates, m
  double area = 0;                       ///< m^2

  /// Whether a point is inside, or on its border: exact, because it has no tolerance.
  [[nodiscard]] bool contains(const Vec2& point) const;
  /// The area that a simple ring has in common with it, m^2.
  [[nodiscard]] double overlap(const std::vector<Vec2>& ring) const;
};

}  // namespace apothem
