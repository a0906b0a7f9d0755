// A polygon and its potential as a picture, in the manner of the paper's Figs. 2-5: bands and
// contour lines of phi, the faces of the roof, the singular area and the inscribed circles. Bands
// and lines are exact level sets of the roof, polygons again; nothing is sampled.
#pragma once

#include <string>

#include "geometry/polygon.hpp"
#include "geometry/potential.hpp"
#include "geometry/singular_area.hpp"
#include "output/canvas.hpp"

namespace apothem {

struct PotentialPicture {
  const Polygon& polygon;
  const Skeleton& skeleton;
  const InscribedCircle& circle;
  const SingularArea& singular;  ///< at the reference length
  double reference;              ///< m
  std::string reference_name;    ///< for the title
};

/// The bytes of a picture file. Polygons thinner than 1/16 are drawn along their length, with
/// unequal scales, and the picture says so.
std::string draw_potential(const PotentialPicture& picture, PictureFormat format);

}  // namespace apothem
