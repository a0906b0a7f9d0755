// The places of a skeleton's nodes in the coordinates of the polygon's vertices.
#pragma once

#include <vector>

#include "geometry/polygon/place_grid.hpp"
#include "geometry/skeleton/skeleton.hpp"

namespace apothem {

/// For the nodes of a skeleton, or other lists that begin with the polygon's vertices. Both the
/// polygon and the nodes have to outlive this object.
class NodePlaces {
 public:
  NodePlaces(const Polygon& polygon, const std::vector<Skeleton::Node>& nodes)
      : polygon_(polygon), nodes_(nodes), grid_(polygon) {}

  /// The place of node i; for i < polygon.size() that of vertex i, to the last bit. The places of
  /// others do not depend on which vertex is the first one.
  [[nodiscard]] Vec2 operator[](int i) const {
    return i < polygon_.size() ? polygon_[i] : grid_.world(nodes_[i].point);
  }

 private:
  const Polygon& polygon_;
  const std::vector<Skeleton::Node>& nodes_;
  PlaceGrid grid_;
};

}  // namespace apothem
