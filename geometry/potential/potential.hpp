// The contact potential phi of a polygon. One structure serves for the distance potential of the
// paper (Eq. 6) and for Munjiza's area potential of triangles (Eq. 2). For a convex polygon
//
//   phi(x) = min(1, min_i g_i . (x - p_i))   inside,   0 outside,
//
// where p_i is a point of edge i and g_i is the inward unit normal of edge i divided by a length.
// The linear functions are kept in this difference form because its round-off is proportional to
// the size of the polygon and not to its distance from the origin of the coordinates. For a polygon
// that is not convex, phi either consists of the same linear functions, each over one face of the
// straight skeleton (roof.hpp), or is the distance to the boundary (distance_field.hpp).
#pragma once

#include <array>
#include <functional>
#include <string_view>
#include <vector>

#include "geometry/polygon/polygon.hpp"
#include "geometry/polygon/rare.hpp"
#include "geometry/potential/boundary_layer.hpp"
#include "geometry/potential/distance_field.hpp"
#include "geometry/skeleton/roof.hpp"

namespace apothem {

/// The contact potential of a polygon. A polygon that is not convex has either a roof or a distance
/// field, and phi is then not the minimum of the linear functions of its edges.
struct Potential {
  std::vector<Vec2> vertices;    ///< p_i relative to an origin that the owner chooses, m
  std::vector<Vec2> gradients;   ///< g_i, 1/m
  Rare<RingLinks> links;         ///< neighbours of the vertices of a polygon with holes
  double top = 0;                ///< maximum of phi if it is not limited to 1
  std::vector<Vec2> top_points;  ///< where phi is highest: points and ends of ridges, m
  double steepest = 0;           ///< largest |g_i|, 1/m
  Rare<Roof> roof;               ///< roof over the straight skeleton
  Rare<DistanceField> distance;  ///< distance field
  Rare<BoundaryLayer> layer;     ///< boundary layer, if the polygon is not convex

  /// Number of vertices and of edges.
  [[nodiscard]] int size() const { return static_cast<int>(vertices.size()); }
  /// The vertex or the edge after i in its ring, or before it.
  [[nodiscard]] int next(int i) const { return apothem::next(ring_links(), i, size()); }
  [[nodiscard]] int previous(int i) const { return apothem::previous(ring_links(), i, size()); }
  [[nodiscard]] const RingLinks* ring_links() const { return links ? &*links : nullptr; }
  /// The vertices of each ring: the outer one, counter-clockwise, and then the holes, clockwise.
  [[nodiscard]] Rings rings() const;
  /// True if the limit phi <= 1 has an effect. The saturated region, where phi = 1, is the paper's
  /// singular area.
  [[nodiscard]] bool capped() const { return top > 1; }
};

/// Ratio of a polygon's size to its reference length r beyond which one ulp of the coordinates
/// changes phi by more than about 1e-13. For such thin polygons (needles), values that are computed
/// only once, and single evaluations of a contact, use long double.
inline constexpr double kNeedle = 1e3;

/// A largest inscribed circle of a polygon.
struct InscribedCircle {
  double radius;  ///< radius, m
  /// Possible centres relative to the polygon's origin(), m. If the centres of a convex polygon
  /// form a segment, these are its two ends.
  std::vector<Vec2> centres;
};

/// Returns the largest inscribed circle of a convex polygon. Throws InvalidPolygon if the polygon
/// is not convex, or if it is thinner than double precision resolves.
InscribedCircle inscribed_circle(const Polygon& polygon);

/// The choice of a potential: its kind, the field that measures the depth, and the reference length
/// r by which the depth is divided. For a convex polygon both fields are the same and the height of
/// the roof is the radius of the inscribed circle, so `roof` and `inscribed_circle` agree. For
/// other polygons the height of the roof is never larger than that radius.
struct PotentialChoice {
  enum class Kind { distance, area };                       ///< Eq. 6 or Eq. 2 of the paper
  enum class Field { roof, distance };                      ///< roof or distance to the boundary
  enum class Reference { roof, inscribed_circle, length };  ///< the quantity used as r
  Kind kind = Kind::distance;                               ///< kind of the potential
  Field field = Field::roof;                                ///< measure of the depth
  Reference reference = Reference::roof;                    ///< choice of the reference length
  double length = 0;  ///< the reference length for Reference::length, m
};

/// Returns the potential of a polygon, with vertices relative to polygon.origin(). The linear
/// functions of the area potential have the slopes 3 / altitude. Throws InvalidPolygon
/// - for the area potential of a polygon that is not a triangle,
/// - if the polygon is thinner than double precision resolves, and
/// - if the polygon is not convex, its straight skeleton is needed and none can be found. The
///   distance field needs the skeleton only for Reference::roof.
Potential make_potential(const Polygon& polygon, const PotentialChoice& choice = {});

/// True if a polygon that is not convex needs its straight skeleton for this potential.
bool needs_skeleton(const PotentialChoice& choice);

/// Returns the potential of a polygon with a given skeleton. `skeleton` is called only if it is
/// needed, and may throw SkeletonFailure.
Potential make_potential(const Polygon& polygon, const PotentialChoice& choice,
                         const std::function<Skeleton()>& skeleton);

/// The same potential in coordinates whose origin is moved by `shift`, m: all points minus `shift`.
Potential translated(Potential potential, const Vec2& shift);

/// The potentials by name. A new one is one line here and its edge list in geometry.
struct NamedPotential {
  std::string_view name;
  PotentialChoice::Kind kind;
};
inline constexpr std::array kPotentials{
    NamedPotential{"distance", PotentialChoice::Kind::distance},  // Eq. 6
    NamedPotential{"area", PotentialChoice::Kind::area},          // Eq. 2, triangles only
};

/// The measures of the depth in a polygon that is not convex; convex polygons have one field only.
struct NamedField {
  std::string_view name;
  PotentialChoice::Field field;
};
inline constexpr std::array kFields{
    NamedField{"roof", PotentialChoice::Field::roof},
    NamedField{"distance", PotentialChoice::Field::distance},
};

/// The reference lengths a scene can name (a number is a length in m).
struct NamedReference {
  std::string_view name;
  PotentialChoice::Reference reference;
};
inline constexpr std::array kReferences{
    NamedReference{"roof", PotentialChoice::Reference::roof},
    NamedReference{"inscribed_circle", PotentialChoice::Reference::inscribed_circle},
};

}  // namespace apothem
