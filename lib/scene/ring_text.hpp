// Rings of vertices as they stand in a text, before they are known to be a polygon.
#pragma once

#include <vector>

#include "geometry/polygon/point.hpp"

namespace apothem {

struct RingText {
  std::vector<Vec2> ring;  ///< world coordinates, m; without a closing vertex
  std::vector<int> lines;  ///< of each vertex in the file, counted from 1
};

/// The outer ring of a polygon, and its holes.
struct PolygonText {
  RingText outer;
  std::vector<RingText> holes;
};

/// Whether the first vertex is repeated at the end is a habit of formats: WKT and GeoJSON ask for
/// it, lists of points do without it. Every reader accepts both, and leaves the closing vertex out.
inline void leave_out_closing_vertex(std::vector<Vec2>& ring) {
  if (ring.size() > 1 && ring.front() == ring.back()) ring.pop_back();
}

/// What to do with a text that holds other than one polygon.
inline constexpr const char* kOnePolygon =
    "give one; apothem polygon and apothem contact take many with --batch FILE";

}  // namespace apothem
