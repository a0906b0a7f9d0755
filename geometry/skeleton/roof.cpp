#include "geometry/skeleton/roof.hpp"

namespace apothem {

Roof make_roof(const Skeleton& skeleton, double reference) {
  Roof roof;
  for (const Skeleton::Node& node : skeleton.nodes) {
    roof.points.push_back(node.point);
    roof.values.push_back(node.height / reference);
  }
  for (const Skeleton::Arc& arc : skeleton.arcs) roof.arcs.push_back({arc.start, arc.end});
  roof.faces = skeleton.faces;
  return roof;
}

}  // namespace apothem
