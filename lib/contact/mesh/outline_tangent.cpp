#include "lib/contact/mesh/outline_tangent.hpp"

#include <array>
#include <tuple>

#include "lib/contact/mesh/edge_face.hpp"

namespace apothem {
namespace {

using Number = MovingEdgeFace::Number;

}  // namespace

MovingEdgeFace::Line::Line(const Spot& from, const Spot& to) {
  const Number x = to.x - from.x, y = to.y - from.y;
  length = square_root(x * x + y * y);
  tx = x / length, ty = y / length;
}

namespace {

std::array<MovingEdgeFace::Spot, MovingEdgeFace::kVertices> spots_of(
    const OutlineSurfaces& o, const std::array<int, MovingEdgeFace::kVertices>& vertex) {
  std::array<MovingEdgeFace::Spot, MovingEdgeFace::kVertices> spots;
  for (size_t i = 0; i < spots.size(); ++i) {
    spots[i] = {Number::variable(o.x[vertex[i]], static_cast<int>(2 * i)),
                Number::variable(o.y[vertex[i]], static_cast<int>(2 * i + 1))};
  }
  return spots;
}

}  // namespace

MovingEdgeFace::MovingEdgeFace(const OutlineSurfaces& o, int p, int a)
    : vertex{p, o.next[p], a, o.next[a], o.previous[a], o.next[o.next[a]]},
      spots(spots_of(o, vertex)),
      edge(spots[at_p], spots[at_q]),
      base(spots[at_a], spots[at_b]) {
  const Line before(spots[before_a], spots[at_a]), after(spots[at_b], spots[after_b]);
  const Mitre<Number> mitre_a(before.tx, before.ty, base.tx, base.ty);
  const Mitre<Number> mitre_b(base.tx, base.ty, after.tx, after.ty);
  const CollarFace<Number> face{spots[at_a].x,     spots[at_a].y, spots[at_b].x, spots[at_b].y,
                                base.tx,           base.ty,       base.length,   mitre_a.x,
                                mitre_a.y,         mitre_b.x,     mitre_b.y,     o.depth[a],
                                o.regular_depth[a]};
  CollarCrossings<Number> crossings;
  meet = collar_piece(face, spots[at_p].x, spots[at_p].y, spots[at_q].x, spots[at_q].y, piece,
                      crossings);
}

VertexCoordinates coordinates_of(const OutlineSurfaces& o, size_t first_node, int vertex) {
  const OutlineSurfaces::Body& body = o.bodies[o.body[vertex]];
  if (!body.is_rigid()) {
    const size_t c = first_node + 2 * static_cast<size_t>(o.node[vertex]);
    return {2, {c, c + 1, 0}, {Vec2(1, 0), Vec2(0, 1), Vec2(0, 0)}};
  }
  const size_t c = 3 * static_cast<size_t>(body.rigid);
  const Vec2 turned(-(o.y[vertex] - body.cy), o.x[vertex] - body.cx);
  return {3, {c, c + 1, c + 2}, {Vec2(1, 0), Vec2(0, 1), turned}};
}

void add_tangent_of_forces(const OutlineSurfaces& o, size_t first_node,
                           const std::array<int, MovingEdgeFace::kVertices>& vertex,
                           const std::array<MovingEdgeFace::Spot, 4>& forces, Tangent& tangent) {
  std::array<VertexCoordinates, MovingEdgeFace::kVertices> moves;
  for (size_t i = 0; i < moves.size(); ++i) moves[i] = coordinates_of(o, first_node, vertex[i]);
  for (size_t row = 0; row < forces.size(); ++row) {
    const MovingEdgeFace::Spot& f = forces[row];
    const VertexCoordinates& on = moves[row];
    for (int r = 0; r < on.count; ++r) {
      const Vec2& arm = on.along[static_cast<size_t>(r)];
      const Number component = arm.x() * f.x + arm.y() * f.y;
      for (size_t column = 0; column < moves.size(); ++column) {
        const VertexCoordinates& by = moves[column];
        const double dx = component.d.v[2 * column], dy = component.d.v[2 * column + 1];
        for (int c = 0; c < by.count; ++c) {
          const Vec2& move = by.along[static_cast<size_t>(c)];
          tangent.add(on.coordinate[static_cast<size_t>(r)], by.coordinate[static_cast<size_t>(c)],
                      -(dx * move.x() + dy * move.y()));
        }
      }
      // The arm of a force on a rigid body turns with it.
      if (r == 2) {
        tangent.add(on.coordinate[2], on.coordinate[2], arm.y() * f.x.v - arm.x() * f.y.v);
      }
    }
  }
}

void add_edge_face_tangent(const OutlineSurfaces& o, size_t first_node, int p, int a, double slope,
                           Tangent& tangent) {
  const MovingEdgeFace moving(o, p, a);
  if (!moving.meet) return;
  const auto& [edge, base] = std::tie(moving.edge, moving.base);
  const EdgeFaceForces<Number> force =
      edge_face_forces(moving.piece, Number(slope), edge.length, Number(1.) / base.length);
  add_tangent_of_forces(o, first_node, moving.vertex,
                        {{{-edge.ty * force.edge_start, edge.tx * force.edge_start},
                          {-edge.ty * force.edge_end, edge.tx * force.edge_end},
                          {-base.ty * force.face_start, base.tx * force.face_start},
                          {-base.ty * force.face_end, base.tx * force.face_end}}},
                        tangent);
}

void CoordinateSum::add(const VertexCoordinates& vertex, const Vec2& times) {
  for (int i = 0; i < vertex.count; ++i) {
    const auto k = static_cast<size_t>(i);
    terms_.push_back({vertex.coordinate[k], vertex.along[k].dot(times)});
  }
}

void CoordinateSum::add_square(double k, Tangent& tangent) const {
  for (const Part& row : terms_) {
    for (const Part& column : terms_) {
      tangent.add(row.coordinate, column.coordinate, k * row.value * column.value);
    }
  }
}

}  // namespace apothem
