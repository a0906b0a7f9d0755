#include "geometry/packing/voronoi_blocks.hpp"

#include <stdexcept>

#include "geometry/skeleton/singular_area.hpp"

namespace apothem {

std::vector<std::vector<Vec2>> voronoi_blocks(const Polygon& region, const VoronoiOptions& options,
                                              double gap) {
  const PolygonMesh mesh = in_world(region, voronoi_mesh(region, options).mesh);
  std::vector<std::vector<Vec2>> blocks;
  for (const std::vector<int>& cell : mesh.cells) {
    std::vector<Vec2> ring = cell_ring(mesh, cell);
    if (gap > 0) {
      const Polygon polygon(ring);
      SingularArea inner = singular_area(straight_skeleton(polygon), gap / 2);
      if (inner.polygons.size() != 1) {
        throw std::invalid_argument("a cell is too small for the gap, or falls into parts");
      }
      ring = std::move(inner.polygons.front().outer);
      for (Vec2& v : ring) v += polygon.origin();
    }
    blocks.push_back(std::move(ring));
  }
  return blocks;
}

}  // namespace apothem
