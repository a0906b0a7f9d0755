// The numbers of a traced skeleton's nodes. This header is private to the construction of the
// straight skeleton.
#pragma once

#include <vector>

#include "geometry/skeleton/skeleton_parts.hpp"

namespace apothem {

/// The event in which an inner node was made.
struct NodeEvent {
  int time;   ///< number of its time: the same for all nodes of that time
  int first;  ///< first edge of the polygon that has started in one of the vertices that met there
};

/// Gives the inner nodes of a skeleton other numbers. They do not follow the time across the whole
/// polygon, but each part of the front to its end before the next one, from the last part of a
/// front that was divided to the first. Then nodes near each other have numbers near each other.
/// All parts of the front of a polygon with holes count as one, because they may be joined again.
void renumber(std::vector<Skeleton::Node>& nodes, std::vector<std::vector<FaceBorder>>& borders,
              const std::vector<NodeEvent>& events, const Polygon& polygon);

}  // namespace apothem
