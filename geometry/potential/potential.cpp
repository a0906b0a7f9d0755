#include "geometry/potential/potential.hpp"

#include <cmath>

#include "geometry/polygon/cyclic.hpp"
#include "geometry/polygon/predicates.hpp"
#include "geometry/potential/inscribed_circle.hpp"
#include "geometry/potential/lower_envelope.hpp"
#include "lib/execution/elementary.hpp"

namespace apothem {
namespace {

// Heights of the envelope whose relative difference is smaller than this are equal. So the centres
// of a rectangle's largest inscribed circles form a segment, although round-off makes the heights
// at its ends differ.
constexpr double kSameHeight = 1e-13;
// A radius of the largest inscribed circle below this fraction of the polygon's size consists of
// round-off.
constexpr double kThinnest = 8 * 0x1p-52;

void require_convex(const Polygon& polygon) {
  if (const auto reflex = polygon.first_reflex_vertex()) {
    const int i = polygon.input_index(*reflex);
    throw InvalidPolygon("vertex " + std::to_string(i) +
                             " is reflex (interior angle above 180 degrees): give a convex polygon",
                         i);
  }
}

// Inward unit normals of the edges, from differences of the input coordinates.
std::vector<Vec2> inward_normals(const Polygon& polygon) {
  std::vector<Vec2> normals(polygon.size());
  for (int i = 0; i < polygon.size(); ++i) {
    const Vec2 d = polygon.after(i) - polygon[i];
    normals[i] = Vec2(-d.y(), d.x()) / hypotenuse(d.x(), d.y());
  }
  return normals;
}

// Maximum of the envelope over a needle, in long double, because in double precision only a few of
// its digits would be correct.
double top_of_needle(const Polygon& polygon, const Potential& potential) {
  using Fine = long double;
  using FineVec = lower_envelope::Vec<Fine>;
  std::vector<FineVec> ring;
  for (const Vec2& v : polygon.vertices())
    ring.push_back(v.cast<Fine>() - polygon.origin().cast<Fine>());
  std::vector<lower_envelope::Line<Fine>> lines;
  for (size_t i = 0; i < ring.size(); ++i) {
    const FineVec d = after(ring, i) - ring[i];
    const FineVec g =
        FineVec(-d.y(), d.x()) * (potential.gradients[i].cast<Fine>().norm() / d.norm());
    lines.push_back({g, -g.dot(ring[i])});
  }
  Fine top = 0;
  for (const auto& corner : lower_envelope::corners(lines, ring))
    top = std::max(top, corner.height);
  return static_cast<double>(top);
}

// Finds the maximum of the envelope and the points where it is attained.
void find_top(Potential& potential) {
  std::vector<lower_envelope::Line<double>> lines;
  for (int i = 0; i < potential.size(); ++i) {
    const Vec2& g = potential.gradients[i];
    lines.push_back({g, -g.dot(potential.vertices[i])});
  }
  const auto corners = lower_envelope::corners(lines, potential.vertices);
  potential.top = 0;
  for (const auto& corner : corners) potential.top = std::max(potential.top, corner.height);
  Vec2 first = Vec2::Zero(), last = Vec2::Zero();  // ends of the level ridge
  bool any = false;
  for (const auto& corner : corners) {
    if (!(corner.height >= potential.top * (1 - kSameHeight))) continue;
    if (!any) first = last = corner.point;
    any = true;
    if (precedes(corner.point, first)) first = corner.point;
    if (precedes(last, corner.point)) last = corner.point;
  }
  const double slope = potential.gradients.front().norm();
  const bool level = (last - first).norm() * slope > 1e-9 * potential.top;
  potential.top_points = level ? std::vector<Vec2>{first, last} : std::vector<Vec2>{first};
}

Potential envelope_potential(const Polygon& polygon, std::vector<Vec2> gradients) {
  Potential potential;
  potential.vertices = polygon.local_vertices();
  potential.gradients = std::move(gradients);
  if (polygon.size() > kFewEdges) {
    // The gradients are unit vectors, and clipping all faces would take n^3 steps.
    InscribedCircle circle = largest_inscribed_circle(polygon);
    potential.top = circle.radius;
    potential.top_points = std::move(circle.centres);
    return potential;
  }
  find_top(potential);
  const double extent = bounding_box(polygon).extent() * potential.gradients[0].norm();
  if (extent > kNeedle * potential.top) potential.top = top_of_needle(polygon, potential);
  if (!(potential.top > kThinnest * extent) || !std::isfinite(1 / potential.top)) {
    throw InvalidPolygon("is thinner than double precision resolves", 0);
  }
  return potential;
}

void scale(Potential& potential, double factor) {
  for (Vec2& g : potential.gradients) g *= factor;
  potential.top *= factor;
}

using SkeletonSource = std::function<Skeleton()>;

Skeleton skeleton_of(const Polygon& polygon, const SkeletonSource& source) {
  try {
    Skeleton skeleton = source();
    if (skeleton.roof_height > kThinnest * bounding_box(polygon).extent()) return skeleton;
  } catch (const SkeletonFailure& failure) {
    throw InvalidPolygon(failure.what(), 0);
  }
  throw InvalidPolygon("is thinner than double precision resolves", 0);
}

// Vertices and gradients of a polygon that is not convex.
Potential sloped_lines(const Polygon& polygon, double reference) {
  Potential potential;
  potential.vertices = polygon.local_vertices();
  if (polygon.links()) potential.links = *polygon.links();
  potential.gradients = inward_normals(polygon);
  for (Vec2& g : potential.gradients) g /= reference;
  potential.steepest = 1 / reference;
  return potential;
}

using Reference = PotentialChoice::Reference;

// The potential of a polygon that is not convex as the roof of its straight skeleton over r.
Potential roof_potential(const Polygon& polygon, const PotentialChoice& choice,
                         const SkeletonSource& source) {
  const Skeleton skeleton = skeleton_of(polygon, source);
  const double reference = choice.reference == Reference::length ? choice.length
                           : choice.reference == Reference::inscribed_circle
                               ? largest_inscribed_circle(polygon).radius
                               : skeleton.roof_height;
  Potential potential = sloped_lines(polygon, reference);
  potential.top = choice.reference == Reference::roof ? 1 : skeleton.roof_height / reference;
  potential.roof = make_roof(skeleton, reference);
  if (!polygon.has_holes()) potential.layer = boundary_layer(polygon, *potential.roof);
  for (const Skeleton::Node& node : skeleton.nodes) {
    if (node.height >= skeleton.roof_height * (1 - kSameHeight)) {
      potential.top_points.push_back(node.point);
    }
  }
  return potential;
}

// The potential of a polygon that is not convex as the distance to its boundary over r. A skeleton
// is needed only if r is the height of the roof.
Potential field_potential(const Polygon& polygon, const PotentialChoice& choice,
                          const SkeletonSource& source) {
  const InscribedCircle circle = largest_inscribed_circle(polygon);
  const double reference = choice.reference == Reference::length ? choice.length
                           : choice.reference == Reference::inscribed_circle
                               ? circle.radius
                               : skeleton_of(polygon, source).roof_height;
  Potential potential = sloped_lines(polygon, reference);
  potential.top = choice.reference == Reference::inscribed_circle ? 1 : circle.radius / reference;
  potential.top_points = circle.centres;
  potential.distance = make_distance_field(polygon, reference);
  if (!polygon.has_holes()) {
    potential.layer = boundary_layer(polygon, potential.distance->slope);
  }
  return potential;
}

Potential distance_potential(const Polygon& polygon, const PotentialChoice& choice,
                             const SkeletonSource& source) {
  if (!polygon.is_convex()) {
    return choice.field == PotentialChoice::Field::roof ? roof_potential(polygon, choice, source)
                                                        : field_potential(polygon, choice, source);
  }
  Potential potential = envelope_potential(polygon, inward_normals(polygon));
  const double inradius = potential.top;
  if (choice.reference == PotentialChoice::Reference::length) {
    scale(potential, 1 / choice.length);
    potential.steepest = 1 / choice.length;
  } else {
    scale(potential, 1 / inradius);
    potential.top = 1;
    potential.steepest = 1 / inradius;
  }
  return potential;
}

Potential area_potential(const Polygon& polygon) {
  if (polygon.size() != 3) {
    throw InvalidPolygon("has " + std::to_string(polygon.size()) +
                             " vertices: the area potential is defined for triangles only (use the "
                             "distance potential)",
                         3);
  }
  const double area = area_moments(polygon).area;
  std::vector<Vec2> gradients(3);
  double steepest = 0;
  for (int i = 0; i < 3; ++i) {
    const Vec2 d = polygon.after(i) - polygon[i];
    gradients[i] = Vec2(-d.y(), d.x()) * (1.5 / area);  // slope 3 / altitude
    steepest = std::max(steepest, gradients[i].norm());
  }
  Potential potential = envelope_potential(polygon, std::move(gradients));
  potential.top = 1;  // at the centroid, where the three areas agree
  potential.steepest = steepest;
  return potential;
}

}  // namespace

InscribedCircle inscribed_circle(const Polygon& polygon) {
  require_convex(polygon);
  Potential potential = envelope_potential(polygon, inward_normals(polygon));
  return {potential.top, std::move(potential.top_points)};
}

bool needs_skeleton(const PotentialChoice& choice) {
  return choice.kind == PotentialChoice::Kind::distance &&
         (choice.field == PotentialChoice::Field::roof ||
          choice.reference == PotentialChoice::Reference::roof);
}

Rings Potential::rings() const {
  Rings rings;
  for_each_ring(ring_links(), size(), [&](int first, int last) {
    rings.emplace_back(vertices.begin() + first, vertices.begin() + last);
  });
  return rings;
}

Potential make_potential(const Polygon& polygon, const PotentialChoice& choice) {
  return make_potential(polygon, choice, [&] { return straight_skeleton(polygon); });
}

Potential make_potential(const Polygon& polygon, const PotentialChoice& choice,
                         const std::function<Skeleton()>& skeleton) {
  return choice.kind == PotentialChoice::Kind::area ? area_potential(polygon)
                                                    : distance_potential(polygon, choice, skeleton);
}

Potential translated(Potential potential, const Vec2& shift) {
  for (Vec2& v : potential.vertices) v -= shift;
  for (Vec2& v : potential.top_points) v -= shift;
  if (potential.roof) {
    for (Vec2& v : potential.roof->points) v -= shift;
  }
  return potential;
}

}  // namespace apothem
