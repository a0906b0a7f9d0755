// The part of a polygon at least as deep as the reference length: {t >= r} of the roof t, the
// paper's singular area (Fig. 5), which is the offset of the polygon along its straight skeleton.
//
// Every arc of the skeleton that rises through the depth is crossed once, decided by one sign per
// node, and the level lines in the faces join the crossings to closed loops: a face is monotone
// along its edge, so a crossing on the way down belongs to the one before it on the way up. No
// distance is compared on that way. The inner arcs form a tree, so the nodes above the depth fall
// into subtrees, each surrounded by exactly one loop: components are many, holes are impossible
// (water on the roof runs off, {t < r} hangs together with the outside).
//
// Only "as high as r" needs a tolerance, without which the honest answer for r = roof height, a
// point or a level ridge, would drown in round-off: 1e-13 r + 4e-15 of the polygon's size, as for
// inscribed circles.
#pragma once

#include <array>
#include <vector>

#include "geometry/skeleton.hpp"

namespace apothem {

/// Coordinates relative to the polygon's origin(), m. The parts do not overlap; polygons may touch
/// each other, and segments, in points.
struct SingularArea {
  enum class Kind { none, point, segment, polygons };
  std::vector<std::vector<Vec2>> polygons;    ///< counter-clockwise
  std::vector<std::array<Vec2, 2>> segments;  ///< level ridges as high as r
  std::vector<Vec2> points;                   ///< isolated tops as high as r

  /// That of the parts of the highest dimension.
  [[nodiscard]] Kind kind() const;
  /// Of the polygons, m^2.
  [[nodiscard]] double area() const;
};

/// "none", "point", "segment" or "polygons".
const char* kind_name(SingularArea::Kind kind);

/// For depth > 0 in m, also above the roof (then there is none). Throws std::invalid_argument
/// otherwise.
SingularArea singular_area(const Skeleton& skeleton, double depth);

/// The faces of a skeleton, cut along the level lines at a depth.
struct CutFaces {
  struct Part {
    int edge;                ///< whose face this is part of
    bool above;              ///< t >= depth here; else t <= depth
    std::vector<int> nodes;  ///< counter-clockwise, no node twice in a row
  };
  std::vector<Skeleton::Node> nodes;  ///< those of the skeleton, then the cuts
  std::vector<Part> parts;
};

/// As singular_area. Parts without extent are left out.
CutFaces cut_faces(const Skeleton& skeleton, double depth);

}  // namespace apothem
