// The singular area of a polygon (Fig. 5 of the paper): the part {t >= r} that is at least as deep
// as the reference length r, where t is the roof of the straight skeleton. It is the offset of the
// polygon along its straight skeleton at the depth r.
//
// Every arc of the skeleton that rises through the depth is crossed once; one sign per node decides
// where that is so. The level lines in the faces join these crossings to closed loops. A face is
// monotone along its edge, so a crossing where the border of the face goes down belongs to the
// preceding one where it goes up; no distances are compared. Nodes above the depth that are
// connected by arcs above it lie in the same component. Water on the roof runs off, hence every
// part of {t < r} is connected to the outside or to a hole of the polygon. So without holes, each
// component is surrounded by exactly one loop. Otherwise it may have further loops, which surround
// parts with holes of the polygon: they are the holes of the component.
//
// A tolerance is needed only to decide whether a node is exactly as high as r. Without it,
// round-off would hide the right answer for r equal to the height of the roof, which is a point or
// a level ridge. The tolerance is 1e-13 r plus 4e-15 of the polygon's size, as for inscribed
// circles.
#pragma once

#include <array>
#include <vector>

#include "geometry/polygon/polygon_with_holes.hpp"
#include "geometry/skeleton/skeleton.hpp"

namespace apothem {

/// A singular area. Its coordinates are relative to the polygon's origin(), in m. The parts do not
/// overlap. Polygons may touch each other, and segments, in points.
struct SingularArea {
  /// What a singular area consists of.
  enum class Kind { none, point, segment, polygons };
  std::vector<PolygonWithHoles> polygons;     ///< polygons of positive area
  std::vector<std::array<Vec2, 2>> segments;  ///< end points of the level ridges as high as r
  std::vector<Vec2> points;                   ///< isolated maxima of the roof as high as r

  /// The kind of the parts with the highest dimension.
  [[nodiscard]] Kind kind() const;
  /// Total area of the polygons, m^2.
  [[nodiscard]] double area() const;
};

/// The name of a kind: "none", "point", "segment" or "polygons".
const char* kind_name(SingularArea::Kind kind);

/// Returns the singular area for a reference length `depth`, m. It is empty if the depth exceeds
/// the height of the roof. Throws std::invalid_argument unless depth > 0.
SingularArea singular_area(const Skeleton& skeleton, double depth);

/// The faces of a skeleton, cut along the level lines of the roof at a depth.
struct CutFaces {
  /// A part of a face on one side of its level lines.
  struct Part {
    int edge;                ///< index of the edge to whose face the part belongs
    bool above;              ///< true where t >= depth, false where t <= depth
    std::vector<int> nodes;  ///< node indices, counter-clockwise, no node twice in succession
  };
  std::vector<Skeleton::Node> nodes;  ///< nodes of the skeleton, then the cuts of its arcs
  std::vector<Part> parts;            ///< parts with three or more nodes
};

/// Cuts the faces of a skeleton at a depth, m. Parts without extent are left out. Throws
/// std::invalid_argument unless depth > 0.
CutFaces cut_faces(const Skeleton& skeleton, double depth);

}  // namespace apothem
