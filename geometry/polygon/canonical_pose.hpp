// A pose of a polygon that does not depend on where its rings start, on their senses, on the order
// of its holes, on mirrors that exchange the senses of the axes or the axes themselves, and on
// quarter turns. What is computed in this pose and mapped back does not depend on them either, to
// the last bit.
#pragma once

#include <vector>

#include "geometry/polygon/place_grid.hpp"
#include "geometry/polygon/polygon.hpp"

namespace apothem {

/// One of the eight maps of the plane onto itself that keep the pair of axes.
struct AxisMap {
  bool exchanged = false;  ///< x and y, before the signs
  double x = 1, y = 1;     ///< signs

  Vec2 operator()(const Vec2& p) const {
    return exchanged ? Vec2(x * p.y(), y * p.x()) : Vec2(x * p.x(), y * p.y());
  }
  [[nodiscard]] Vec2 undo(const Vec2& p) const {
    return exchanged ? Vec2(y * p.y(), x * p.x()) : Vec2(x * p.x(), y * p.y());
  }
  [[nodiscard]] bool mirrors() const { return (x * y < 0) != exchanged; }
};

/// The image of some polygons under one of these maps that comes first in the order of coordinates,
/// where each ring begins at its leftmost and lowest vertex and holes are in this order as well.
struct FirstImage {
  std::vector<Rings> polygons;
  std::vector<AxisMap> maps;  ///< all that lead to it: several if the polygons are symmetric
};
FirstImage first_image(const std::vector<const Polygon*>& polygons);

class CanonicalPose {
 public:
  explicit CanonicalPose(const Polygon& polygon);

  /// The polygon in this pose, which is its first image.
  [[nodiscard]] const Polygon& polygon() const { return polygon_; }

  /// Points that have been computed in this pose, relative to the origin of the polygon there, in
  /// the coordinates relative to the origin of the given polygon. They are rounded to places of
  /// the PlaceGrid, whose world() gives the same ones for all images of a polygon, to the last bit.
  /// If the polygon is symmetric about the origin or a line through it, its pose is not unique; the
  /// points are then rounded to 2^-49 of the size and made as symmetric as the polygon is, each
  /// together with those nearest to its images.
  [[nodiscard]] std::vector<Vec2> back(std::vector<Vec2> points) const;

 private:
  AxisMap map_;                      // into this pose
  std::vector<AxisMap> symmetries_;  // of the polygon in this pose
  Polygon polygon_;
  PlaceGrid grid_;
  Vec2 given_, given_anchor_;  // origin of the given polygon and its anchor
};

}  // namespace apothem
