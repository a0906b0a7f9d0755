// Draws a polygon and its potential like Figs. 2-5 of the paper: bands and contour lines of phi,
// the faces of the roof, the singular area and the inscribed circles. Bands and lines are exact
// level sets of the roof, which are polygons; nothing is sampled.
#pragma once

#include <string>

#include "geometry/polygon/polygon.hpp"
#include "geometry/potential/potential.hpp"
#include "geometry/skeleton/singular_area.hpp"
#include "lib/output/canvas.hpp"

namespace apothem {

/// What the picture shows. The references must stay valid while it is drawn.
struct PotentialPicture {
  const Polygon& polygon;
  const Skeleton& skeleton;
  const InscribedCircle& circle;
  const SingularArea& singular;  ///< for the reference length below
  double reference;              ///< reference length r, m
  std::string reference_name;    ///< name of the reference length, for the title
};

/// The picture as the bytes of a file. Polygons whose height is less than 1/16 of their length are
/// drawn along their length with unequal scales, and the picture says so. Throws as Canvas::finish
/// does.
std::string draw_potential(const PotentialPicture& picture, PictureFormat format);

}  // namespace apothem
