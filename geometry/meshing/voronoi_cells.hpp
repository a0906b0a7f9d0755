// The Voronoi diagram of sites, exact, and its cells cut by the outline of a region. CGAL stays
// behind it, which is slow to compile. This header is private to voronoi.cpp.
#pragma once

#include <memory>
#include <vector>

#include "geometry/meshing/cell_pieces.hpp"
#include "geometry/polygon/polygon.hpp"

namespace apothem {

/// The Voronoi diagram of sites in the plane.
class VoronoiDiagram {
 public:
  /// All sites lie in the box, which is that of the region. Throws std::invalid_argument if two of
  /// them are the same point.
  VoronoiDiagram(const std::vector<Vec2>& sites, const Box& box);
  ~VoronoiDiagram();
  VoronoiDiagram(const VoronoiDiagram&) = delete;
  VoronoiDiagram& operator=(const VoronoiDiagram&) = delete;

  /// The box around the cell of a site, in double precision.
  [[nodiscard]] Box box_of(int site) const;

  /// The cell of a site without the outline, in double precision.
  [[nodiscard]] std::vector<Vec2> whole_cell(int site) const;

  /// The marked sites and those whose cells share an edge with theirs.
  [[nodiscard]] std::vector<bool> with_neighbours(const std::vector<bool>& marked) const;

  /// The pieces into which the outline of the region cuts the cells of the sites that are `wanted`.
  [[nodiscard]] Pieces cut(const Polygon& region, const std::vector<bool>& wanted) const;

  struct Parts;  ///< the diagram in CGAL's numbers

 private:
  std::unique_ptr<const Parts> parts_;
};

}  // namespace apothem
