#include "lib/contact/mesh/outline_depths.hpp"

#include <algorithm>

#include "lib/contact/mesh/edge_face.hpp"

namespace apothem {
bool OutlineDepths::is_depth(int face, const CollarPiece<double>& piece) const {
  return piece.deepest <= sure_depth(outlines_.regular_depth[face], outlines_.depth[face]);
}

void OutlineDepths::forget() {
  for (BoundaryDistance& b : boundaries_) b.clear();
}

BoundaryDistance& OutlineDepths::boundary(BodyIndex body) {
  const OutlineSurfaces& o = outlines_;
  BoundaryDistance& found = boundaries_[static_cast<size_t>(body)];
  if (!found.empty()) return found;
  for (int i = o.bodies[body].first; i < o.bodies[body].end; ++i) {
    found.add(o.point(i), o.point(o.next[i]));
  }
  return found;
}

double OutlineDepths::of_piece(int edge, int face, const CollarPiece<double>& piece, double floor) {
  const BodyIndex body = outlines_.body[face];
  if (outlines_.body[edge] == body || !is_depth(face, piece)) return of_edge(edge, body, floor);
  // In a face that does not reach beyond its edge, heights are distances.
  const CollarFace<double> collar_face = outlines_.face(face);
  if (collar_face.alpha() >= 0 && collar_face.beta() <= 0) return std::max(floor, piece.deepest);
  const Vec2 start = outlines_.point(edge);
  const Vec2 along = outlines_.point(outlines_.next[edge]) - start;
  return boundary(body).largest(start + piece.from * along, start + piece.to * along, floor);
}

// An edge is inside its own body where the body covers the outer side of the edge as well. Edges
// that continue it smoothly do not count as boundary then.
double OutlineDepths::of_edge(int edge, BodyIndex body, double floor) {
  constexpr double kBeside = 1e-9;  // offset to the outer side, relative to the length of the edge
  // Cosine of the angle up to which a neighbour continues the edge.
  constexpr double kCarriesOn = .7;
  const OutlineSurfaces& o = outlines_;
  const bool self = o.body[edge] == body;
  const auto is_other = [&](int i) {
    if (!self) return true;
    if (i == edge) return false;
    const bool near = i == o.next[edge] || i == o.previous[edge];
    return !near || o.tx[i] * o.tx[edge] + o.ty[i] * o.ty[edge] < kCarriesOn;
  };
  const Vec2 start = o.point(edge), along = o.point(o.next[edge]) - start;
  const Vec2 beside = self ? kBeside * Vec2(along.y(), -along.x()) : Vec2(0, 0);
  std::vector<double> ends{0, 1};
  const OutlineSurfaces::Body& vertices = o.bodies[body];
  BoundaryDistance of_others;
  BoundaryDistance& depths = self ? of_others : boundary(body);
  for (int i = vertices.first; i < vertices.end; ++i) {
    if (!is_other(i)) continue;
    if (self) depths.add(o.point(i), o.point(o.next[i]));
    const Vec2 from = o.point(i) - start, to = o.point(o.next[i]) - start;
    const double p = cross(along, from), q = cross(along, to);
    if ((p > 0) == (q > 0)) continue;
    const Vec2 place = from + p / (p - q) * (to - from);
    ends.push_back(std::clamp(place.dot(along) / along.squaredNorm(), 0., 1.));
  }
  std::ranges::sort(ends);
  double deepest = floor;
  for (size_t i = 1; i < ends.size(); ++i) {
    if (!(ends[i] > ends[i - 1])) continue;
    const Vec2 from = start + ends[i - 1] * along, to = start + ends[i] * along;
    if (o.winding((from + to) / 2 + beside, body) != 0) deepest = depths.largest(from, to, deepest);
  }
  return deepest;
}

}  // namespace apothem
