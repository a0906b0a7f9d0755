#include "lib/output/potential_map.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/polygon/cyclic.hpp"
#include "geometry/polygon/half_plane.hpp"
#include "geometry/polygon/predicates.hpp"
#include "geometry/polygon/ring_moments.hpp"
#include "geometry/polygon/segment.hpp"
#include "geometry/potential/inscribed_circle.hpp"

namespace apothem {
namespace {

constexpr double kThin = 1e-12;  // parts of less area, over the square of the size, are left out
constexpr double kNear = 1e-9;  // distance to a part, over the size, at which a point belongs to it

using Ring = std::vector<Vec2>;

// The lower envelope of linear functions over a convex polygon, divided among them.
std::vector<PotentialPiece> envelope(const Ring& ring, const std::vector<PotentialPiece>& lines) {
  std::vector<PotentialPiece> pieces;
  const double least = kThin * ring_area(ring);
  for (const PotentialPiece& line : lines) {
    PotentialPiece piece = line;
    piece.ring = ring;
    for (const PotentialPiece& other : lines) {
      if (&other == &line) continue;
      piece.ring =
          part_above(piece.ring, [&](const Vec2& p) { return other.phi(p) - line.phi(p); });
    }
    if (piece.ring.size() > 2 && ring_area(piece.ring) > least) pieces.push_back(std::move(piece));
  }
  return pieces;
}

// The linear functions of the edges as the contact kernels have them.
std::vector<PotentialPiece> lines_of(const Potential& potential, const Polygon& polygon) {
  std::vector<PotentialPiece> lines;
  for (int i = 0; i < potential.size(); ++i) {
    lines.push_back({polygon.input_edge(i),
                     {},
                     polygon.origin() + potential.vertices[i],
                     potential.gradients[i]});
  }
  return lines;
}

std::vector<PotentialPiece> pieces_of(const Potential& potential, const Polygon& polygon) {
  const std::vector<PotentialPiece> lines = lines_of(potential, polygon);
  if (!potential.roof) return envelope(polygon.vertices(), lines);
  // The values of the roof, not the lines, are what the kernels integrate.
  std::vector<PotentialPiece> pieces;
  const Roof& roof = *potential.roof;
  for (size_t e = 0; e < roof.faces.size(); ++e) {
    PotentialPiece& piece = pieces.emplace_back(lines[e]);
    const Vec2 inward = lines[e].gradient.normalized();
    double highest = 0;
    for (const int node : roof.faces[e]) {
      piece.ring.push_back(polygon.origin() + roof.points[node]);
      const double height = inward.dot(piece.ring.back() - piece.base);
      if (height > highest) {
        highest = height;
        piece.gradient = inward * (roof.values[node] / height);
      }
    }
  }
  return pieces;
}

// The linear functions n A_i/A of a polygon's edges.
std::vector<PotentialPiece> area_shares(const Polygon& polygon) {
  const double area = ring_area(polygon.vertices());
  std::vector<PotentialPiece> lines;
  for (int i = 0; i < polygon.size(); ++i) {
    const Vec2 d = polygon.after(i) - polygon[i];
    lines.push_back({polygon.input_edge(i),
                     {},
                     polygon[i],
                     Vec2(-d.y(), d.x()) * (polygon.size() / (2 * area))});
  }
  return lines;
}

std::vector<PotentialPiece> sectors(const Polygon& polygon) {
  const Vec2 centre = polygon.origin() + area_moments(polygon).centroid;
  std::vector<PotentialPiece> pieces = area_shares(polygon);
  for (int i = 0; i < polygon.size(); ++i) {
    pieces[i].ring = {polygon[i], polygon.after(i), centre};
  }
  return pieces;
}

std::vector<PotentialPiece> halves(const Polygon& polygon) {
  if (polygon.size() != 4) {
    throw InvalidPolygon("has not four vertices: only quadrilaterals are halved", 0);
  }
  PotentialChoice choice;
  choice.kind = PotentialChoice::Kind::area;
  std::vector<PotentialPiece> pieces;
  for (const int first : {0, 2}) {
    const Polygon half({polygon[first], polygon[first + 1], polygon[(first + 2) % 4]});
    for (PotentialPiece& piece : pieces_of(make_potential(half, choice), half)) {
      pieces.push_back(std::move(piece));
    }
  }
  return pieces;
}

void require_convex(const Polygon& polygon) {
  if (const auto reflex = polygon.first_reflex_vertex()) {
    throw InvalidPolygon("is not convex: areas have no sign then", polygon.input_index(*reflex));
  }
}

// How far a point lies outside of a convex part, m; for others at least a sign.
double outside_by(const PotentialPiece& piece, const Vec2& x) {
  const double far = distance_to_ring(piece.ring, x);
  return strictly_inside(piece.ring, x) ? -far : far;
}

}  // namespace

PotentialMap potential_map(const Polygon& polygon, MapKind kind, const PotentialChoice& choice) {
  PotentialMap map;
  map.holes = rings_of(polygon);
  map.outline = std::move(map.holes.front());
  map.holes.erase(map.holes.begin());
  if (kind != MapKind::distance && kind != MapKind::area) require_convex(polygon);
  switch (kind) {
    case MapKind::area_smallest:
      map.pieces = envelope(polygon.vertices(), area_shares(polygon));
      return map;
    case MapKind::area_sectors:
      map.pieces = sectors(polygon);
      return map;
    case MapKind::area_halves:
      map.pieces = halves(polygon);
      return map;
    case MapKind::area: {
      PotentialChoice area;
      area.kind = PotentialChoice::Kind::area;
      map.pieces = pieces_of(make_potential(polygon, area), polygon);
      return map;
    }
    case MapKind::distance:
      break;
  }
  map.pieces = pieces_of(make_potential(polygon, choice), polygon);
  map.circle = largest_inscribed_circle(polygon);
  const Skeleton skeleton = straight_skeleton(polygon);
  using Reference = PotentialChoice::Reference;
  map.reference = choice.reference == Reference::length             ? choice.length
                  : choice.reference == Reference::inscribed_circle ? map.circle->radius
                                                                    : skeleton.roof_height;
  map.singular = singular_area(skeleton, map.reference);
  const auto place = [&](Vec2& p) { p += polygon.origin(); };
  for (PolygonWithHoles& part : map.singular->polygons) {
    std::ranges::for_each(part.outer, place);
    for (Ring& hole : part.holes) std::ranges::for_each(hole, place);
  }
  for (auto& ends : map.singular->segments) std::ranges::for_each(ends, place);
  std::ranges::for_each(map.singular->points, place);
  std::ranges::for_each(map.circle->centres, place);
  return map;
}

double phi_at(const PotentialMap& map, const Vec2& x) {
  const auto nearest =
      std::ranges::min_element(map.pieces, [&](const PotentialPiece& a, const PotentialPiece& b) {
        return outside_by(a, x) < outside_by(b, x);
      });
  return std::min(1., nearest->phi(x));
}

double largest_phi(const PotentialMap& map) {
  double largest = 0;
  for (const PotentialPiece& piece : map.pieces) {
    for (const Vec2& p : piece.ring) largest = std::max(largest, piece.phi(p));
  }
  return std::min(1., largest);
}

double largest_jump(const PotentialMap& map) {
  // phi is linear in every part, so the largest difference is at a vertex.
  const double near = kNear * box_of(map.outline).extent();
  double largest = 0;
  for (const PotentialPiece& piece : map.pieces) {
    for (const Vec2& p : piece.ring) {
      for (const PotentialPiece& other : map.pieces) {
        if (std::abs(outside_by(other, p)) > near) continue;
        largest =
            std::max(largest, std::abs(std::min(1., piece.phi(p)) - std::min(1., other.phi(p))));
      }
    }
  }
  return largest;
}

}  // namespace apothem
