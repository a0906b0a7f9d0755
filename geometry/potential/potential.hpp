// The contact potential of a polygon: one structure for the distance potential of the paper (Eq. 6)
// and for Munjiza's area potential of triangles (Eq. 2). For a convex polygon
//
//   phi(x) = min(1, min_i g_i . (x - p_i))   inside,   0 outside,
//
// with p_i a point of edge i and g_i its inward normal divided by a length: the edge list with one
// inverse length per edge. Lines are kept in this difference form because its round-off follows the
// size of the polygon, not its distance from the origin of the coordinates. A polygon that is not
// convex has the same lines over the faces of its straight skeleton (roof.hpp), or the distance to
// its boundary (distance_field.hpp).
#pragma once

#include <optional>
#include <vector>

#include "apothem/geometry/polygon/polygon.hpp"
#include "apothem/geometry/potential/distance_field.hpp"
#include "apothem/geometry/skeleton/roof.hpp"

namespace apothem {

struct Potential {
  std::vector<Vec2> vertices;    ///< p_i, relative to an origin of the owner's choice, m
  std::vector<Vec2> gradients;   ///< g_i, 1/m
  double top = 0;                ///< maximum of phi without the cap
  std::vector<Vec2> top_points;  ///< where it is attained: one point, or the ends of a segment
  double steepest = 0;           ///< largest |g_i|: the inverse of the smallest length, 1/m
  // Of a polygon that is not convex one of these; the envelope is not phi there.
  std::optional<Roof> roof;
  std::optional<DistanceField> distance;

  [[nodiscard]] int size() const { return static_cast<int>(vertices.size()); }
  /// True when min(1, .) matters: the plateau phi = 1 is the paper's singular area.
  [[nodiscard]] bool capped() const { return top > 1; }
};

/// Size over r beyond which one ulp of the coordinates moves phi by more than some 1e-13: what is
/// computed once or singly then takes long double.
inline constexpr double kNeedle = 1e3;

/// Largest inscribed circle of a convex polygon.
struct InscribedCircle {
  double radius;              ///< m
  std::vector<Vec2> centres;  ///< relative to the polygon's origin(); two when it is not unique
};

/// Throws InvalidPolygon if the polygon is not convex.
InscribedCircle inscribed_circle(const Polygon& polygon);

/// Which potential, what measures the depth of the distance potential, and the length r that
/// normalises it. For a convex polygon both fields are the same and the roof height is the
/// inradius, so `roof` and `inscribed_circle` agree; otherwise the roof height is the smaller one.
struct PotentialChoice {
  enum class Kind { distance, area };
  enum class Field { roof, distance };
  enum class Reference { roof, inscribed_circle, length };
  Kind kind = Kind::distance;
  Field field = Field::roof;
  Reference reference = Reference::roof;
  double length = 0;  ///< m, for Reference::length
};

/// The potential of a polygon, with vertices relative to polygon.origin(). Throws InvalidPolygon if
/// there is none: for the area potential (slope 3 / altitude) of all but triangles, for the
/// distance potential of polygons whose straight skeleton is needed (not by the distance field with
/// another reference than the roof) and cannot be found.
Potential make_potential(const Polygon& polygon, const PotentialChoice& choice = {});

/// The potential seen from another origin: all points minus `shift`.
Potential translated(Potential potential, const Vec2& shift);

}  // namespace apothem
