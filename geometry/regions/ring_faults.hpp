// What keeps rings from being the boundary of a polygon with holes: all of it, with its places.
#pragma once

#include <string>
#include <vector>

#include "geometry/polygon/polygon_with_holes.hpp"

namespace apothem {

struct RingFault {
  enum class Kind {
    repeated_vertex,  ///< `index` is equal to the vertex before it
    spike,            ///< the boundary turns back on itself at the vertex `index`
    touch,            ///< the vertex `index` lies on the vertex `other` of the same ring
    touched_edge,     ///< the vertex `index` lies on the edge `other`
    crossing,         ///< the edges `index` and `other` cross
    common_part,      ///< the edges `index` and `other` have a part of positive length in common
    outside,          ///< a hole outside of the outer ring, which is ring 0
    nested,           ///< a hole in the hole `other_ring`
    no_area,          ///< the ring has fewer than three different vertices that are not spikes
  };
  Kind kind;
  int ring = 0, index = 0;        ///< the vertex or edge; edge i begins at vertex i
  int other_ring = 0, other = 0;  ///< what it meets
  Vec2 place;                     ///< m
};

/// Says what a fault is and where: "edge 3 and edge 7 cross at (1.5, 2) m".
std::string describe(const RingFault& fault);

/// All faults of the outer ring and the holes of one polygon, by the indices of its vertices. Rings
/// that touch each other in single points are none. Found by exact predicates; places of crossings
/// are rounded.
std::vector<RingFault> faults_of(const Rings& rings);

}  // namespace apothem
