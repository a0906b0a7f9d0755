#include "lib/contact/mesh/outline_path.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "lib/execution/dispatch.hpp"
#include "lib/execution/elementary.hpp"

namespace apothem {
namespace {

constexpr double kRoundOff = 1e-9;

// A pack with one number for each lane.
template <class F>
PackOf<4> of_lanes(const F& f) {
  return pack_of<4>(f);
}

}  // namespace

void OutlinePath::find(BodyIndex body_a, BodyIndex body_b, int panels,
                       std::span<const EdgeFace> candidates, const Step& step,
                       std::vector<Impulse>& on_nodes, std::vector<Impulse>& on_rigid) {
  list_candidates(body_a, body_b, candidates);
  if (edges_.empty()) return;
  coordinates_.clear(), sides_.clear();
  sides_.push_back(add_side(body_a, step));
  if (body_b != body_a) sides_.push_back(add_side(body_b, step));
  find_kinks(step);
  const auto inside = static_cast<size_t>(find_event_samples(kinks_, panels, samples_));
  for (size_t first = 0; first < samples_.size(); first += kAtOnce) {
    find_loads(step, first, std::min<size_t>(kAtOnce, samples_.size() - first), inside);
  }
  EventResidual rest_a(step.dt), rest_b(step.dt);
  for (size_t i = 0; i < coordinates_.size(); ++i) {
    Coordinate& c = coordinates_[i];
    c.missing = c.force.missing();
    (i < sides_.back().coordinates ? rest_a : rest_b)
        .add(c.force, {c.missing}, step.dynamics.others(c.index, c.force),
             step.dynamics.inverse_mass[c.index], c.velocity);
  }
  rest_a.add(rest_b);
  const double correction = rest_a.correction();
  for (Coordinate& c : coordinates_) c.missing += correction * c.force.mean;
  balance();
  for (const PathBody& side : sides_) keep(side, on_nodes, on_rigid);
}

// Lists the candidates of the two bodies. Candidates ascend by edge, and so by the body of the
// edge.
void OutlinePath::list_candidates(BodyIndex a, BodyIndex b, std::span<const EdgeFace> candidates) {
  const OutlineSurfaces& o = outlines_;
  candidates_.clear(), ends_.clear(), corners_.clear(), edges_.clear(), faces_.clear();
  const auto add = [&](BodyIndex edges, BodyIndex faces) {
    const auto first = std::ranges::lower_bound(candidates, o.bodies[edges].first, {},
                                                [](const EdgeFace& c) { return c.edge; });
    for (auto c = first; c != candidates.end() && c->edge < o.bodies[edges].end; ++c) {
      if (o.body[c->face] == faces) candidates_.push_back(*c);
    }
  };
  add(a, b);
  if (a != b) add(b, a);
  // Every vertex is listed once; listed vertices are marked.
  corner_of_.resize(static_cast<size_t>(o.size()), -1);
  const auto list = [&](int vertex, std::vector<int>& vertices) {
    if (corner_of_[static_cast<size_t>(vertex)] >= 0) return;
    corner_of_[static_cast<size_t>(vertex)] = 0;
    vertices.push_back(vertex);
  };
  for (const auto& [e, f, pair] : candidates_) {
    for (const int i : {e, o.next[e], f, o.next[f]}) list(i, ends_);
  }
  for (const auto& [e, f, pair] : candidates_) {
    for (const int i : {o.previous[f], o.next[o.next[f]]}) list(i, corners_);
  }
  corners_.insert(corners_.end(), ends_.begin(), ends_.end());
  std::ranges::sort(ends_);
  std::ranges::sort(corners_);
  for (size_t k = 0; k < corners_.size(); ++k) {
    corner_of_[static_cast<size_t>(corners_[k])] = static_cast<int>(k);
  }
  const auto corner = [&](int vertex) {
    return static_cast<size_t>(corner_of_[static_cast<size_t>(vertex)]);
  };
  corner_of_end_.clear();
  for (const int i : ends_) corner_of_end_.push_back(corner(i));
  // Each face is listed once, at the corner where it begins.
  face_of_corner_.assign(corners_.size(), -1);
  for (const EdgeFace& c : candidates_) {
    const int f = c.face;
    int& face = face_of_corner_[corner(f)];
    if (face < 0) {
      face = static_cast<int>(faces_.size());
      faces_.push_back({.before = corner(o.previous[f]),
                        .a = corner(f),
                        .b = corner(o.next[f]),
                        .after = corner(o.next[o.next[f]]),
                        .depth = o.depth[f]});
    }
    edges_.push_back(
        {corner(c.edge), corner(o.next[c.edge]), static_cast<size_t>(face), slopes_.of(c)});
  }
  for (const int i : corners_) corner_of_[static_cast<size_t>(i)] = -1;
  for (std::vector<Pack>* v :
       {&corner_values_.x, &corner_values_.y, &corner_values_.fx, &corner_values_.fy})
    v->resize(corners_.size());
}

OutlinePath::PathBody OutlinePath::add_side(BodyIndex body, const Step& step) {
  const OutlineSurfaces& o = outlines_;
  const auto position_in = [](const std::vector<int>& list, int vertex) {
    return static_cast<size_t>(std::ranges::lower_bound(list, vertex) - list.begin());
  };
  const int first = o.bodies[body].first, end = o.bodies[body].end;
  const PathBody side{body,
                      position_in(ends_, first),
                      position_in(ends_, end),
                      position_in(corners_, first),
                      position_in(corners_, end),
                      coordinates_.size()};
  if (o.bodies[body].is_rigid()) {
    for (size_t k = 0; k < 3; ++k) {
      const size_t c = 3 * static_cast<size_t>(o.bodies[body].rigid) + k;
      coordinates_.push_back({c, step.now.pose_rate[c]});
    }
    return side;
  }
  for (size_t i = side.first_end; i < side.end; ++i) {
    for (size_t axis = 0; axis < 2; ++axis) {
      const size_t c = 2 * static_cast<size_t>(o.node[ends_[i]]) + axis;
      coordinates_.push_back({step.now.pose_rate.size() + c, step.now.node_velocity[c]});
    }
  }
  return side;
}

// Moves the corners of a body to their positions at the fractions theta of the drift.
APOTHEM_INLINE void OutlinePath::place(const PathBody& side, const Step& step, const Pack& theta) {
  const OutlineSurfaces& o = outlines_;
  const OutlineSurfaces::Body& body = o.bodies[side.body];
  const Pack back = (Pack(1.) - theta) * Pack(step.dt);
  if (!body.is_rigid()) {
    for (size_t k = side.first_corner; k < side.last_corner; ++k) {
      const int i = corners_[k];
      const double* v = &step.now.node_velocity[2 * static_cast<size_t>(o.node[i])];
      corner_values_.x[k] = Pack(o.x[i]) - back * Pack(v[0]);
      corner_values_.y[k] = Pack(o.y[i]) - back * Pack(v[1]);
    }
    return;
  }
  const double* v = &step.now.pose_rate[3 * static_cast<size_t>(body.rigid)];
  Pack s, c;
  for (int k = 0; k < kAtOnce; ++k) {
    const SineCosine turn = sine_cosine(back.v[k] * v[2]);
    s.v[k] = turn.sine, c.v[k] = turn.cosine;
  }
  for (size_t k = side.first_corner; k < side.last_corner; ++k) {
    const int i = corners_[k];
    const Pack rx(o.x[i] - body.cx), ry(o.y[i] - body.cy);
    corner_values_.x[k] = Pack(body.cx) - back * Pack(v[0]) + (c * rx + s * ry);
    corner_values_.y[k] = Pack(body.cy) - back * Pack(v[1]) + (c * ry - s * rx);
  }
}

// Finds the kinks of the force, where a vertex of one outline crosses an edge of the other one.
// Heights are linear in theta except for small deformations and rotations.
void OutlinePath::find_kinks(const Step& step) {
  const Pack ends = of_lanes([](int k) { return k == 0 ? 0. : 1.; });
  for (const PathBody& side : sides_) place(side, step, ends);
  const auto point = [&](size_t corner, int lane) {
    return Vec2(corner_values_.x[corner].v[lane], corner_values_.y[corner].v[lane]);
  };
  kinks_.clear();
  for (const PathEdge& near : edges_) {
    const size_t e = near.p, f = faces_[near.face].a, g = faces_[near.face].b;
    const auto height = [&](int lane) {
      return cross(point(g, lane) - point(f, lane), point(e, lane) - point(f, lane));
    };
    const double theta = crossing(height(0), height(1));
    if (theta < 0) continue;
    const auto point_at_kink = [&](size_t i) {
      return Vec2(point(i, 0) + theta * (point(i, 1) - point(i, 0)));
    };
    const Vec2 edge = point_at_kink(g) - point_at_kink(f);
    const double along = edge.dot(point_at_kink(e) - point_at_kink(f)) / edge.squaredNorm();
    if (along > -kRoundOff && along < 1 + kRoundOff) kinks_.push_back(theta);
  }
  std::ranges::sort(kinks_);
}

// Finds the forces on all coordinates at up to four samples. Of all samples the first `inside` lie
// within the step.
void OutlinePath::find_loads(const Step& step, size_t first, size_t count, size_t inside) {
  // The remaining lanes are padding, which repeats the last sample.
  const Pack theta = of_lanes(
      [&](int k) { return samples_[first + std::min(static_cast<size_t>(k), count - 1)].theta; });
  forces_.clear();
  forces_.resize(coordinates_.size());
  with_widest([&](auto /*lanes*/) APOTHEM_LAMBDA {
    for (const PathBody& side : sides_) place(side, step, theta);
    find_forces();
    for (const PathBody& side : sides_) add_forces(side, step, theta);
    return 0.;
  });
  for (size_t c = 0; c < coordinates_.size(); ++c) {
    EventForces& f = coordinates_[c].force;
    for (size_t k = 0; k < count; ++k) {
      const double force = forces_[c].v[k];
      f.add(samples_[first + k], force);
      if (first + k == 0) f.first = force;
      if (first + k + 1 == inside) f.last = force;
    }
  }
}

APOTHEM_INLINE void OutlinePath::place(PathFace& face) const {
  struct Direction {
    Pack x, y, length;
  };
  const auto along = [&](size_t start, size_t end) APOTHEM_LAMBDA {
    const Pack x = corner_values_.x[end] - corner_values_.x[start],
               y = corner_values_.y[end] - corner_values_.y[start];
    const Pack length = square_root(x * x + y * y);
    return Direction{x / length, y / length, length};
  };
  const Direction before = along(face.before, face.a), own = along(face.a, face.b),
                  after = along(face.b, face.after);
  const Mitre<Pack> a(before.x, before.y, own.x, own.y);
  const Mitre<Pack> b(own.x, own.y, after.x, after.y);
  face.collar_face = {corner_values_.x[face.a],
                      corner_values_.y[face.a],
                      corner_values_.x[face.b],
                      corner_values_.y[face.b],
                      own.x,
                      own.y,
                      own.length,
                      a.x,
                      a.y,
                      b.x,
                      b.y,
                      Pack(face.depth),
                      Pack(0.)};
  face.collar_face = face.collar_face.with_regular_depth();
  face.placed = true;
}

// Finds the forces of the near edges and faces at the present positions of the corners.
APOTHEM_INLINE void OutlinePath::find_forces() {
  const Pack zero(0.), one(1.);
  for (const size_t k : corner_of_end_) corner_values_.fx[k] = corner_values_.fy[k] = zero;
  for (PathFace& face : faces_) face.placed = false;
  const auto push = [&](size_t i, const Pack& x, const Pack& y, const Pack& force,
                        const Pack::Mask& there) APOTHEM_LAMBDA {
    corner_values_.fx[i] = select(there, corner_values_.fx[i] + force * x, corner_values_.fx[i]);
    corner_values_.fy[i] = select(there, corner_values_.fy[i] + force * y, corner_values_.fy[i]);
  };
  for (const PathEdge& near : edges_) {
    PathFace& face = faces_[near.face];
    const Pack &px = corner_values_.x[near.p], &py = corner_values_.y[near.p];
    const Pack &qx = corner_values_.x[near.q], &qy = corner_values_.y[near.q];
    const Pack &ax = corner_values_.x[face.a], &ay = corner_values_.y[face.a];
    const Pack base_x = corner_values_.x[face.b] - ax, base_y = corner_values_.y[face.b] - ay;
    const Pack::Mask below = (base_x * (py - ay) - base_y * (px - ax) < zero) &
                             (base_x * (qy - ay) - base_y * (qx - ax) < zero);
    if (!any(!below)) continue;
    if (!face.placed) place(face);
    const CollarPieces<Pack> piece = collar_pieces(face.collar_face, px, py, qx, qy);
    const unsigned general = bits(piece.general & !below);
    const Pack::Mask met = piece.met & !below;
    if (any(met)) {
      const Pack x = qx - px, y = qy - py, length = square_root(x * x + y * y);
      const EdgeFaceForces<Pack> force =
          edge_face_forces(piece, Pack(near.slope), length, one / face.collar_face.length);
      const Pack inward_x = -y / length, inward_y = x / length;
      push(near.p, inward_x, inward_y, force.edge_start, met);
      push(near.q, inward_x, inward_y, force.edge_end, met);
      push(face.a, -face.collar_face.ty, face.collar_face.tx, force.face_start, met);
      push(face.b, -face.collar_face.ty, face.collar_face.tx, force.face_end, met);
    }
    for (unsigned rest = general; rest != 0; rest &= rest - 1) {
      add_general(near, face, static_cast<size_t>(std::countr_zero(rest)));
    }
  }
}

// Adds the forces of a candidate that may reach the saturated region of the collar in the lane l.
void OutlinePath::add_general(const PathEdge& near, const PathFace& face, size_t l) {
  const CollarFace<Pack>& f = face.collar_face;
  const CollarFace<double> collar_face{f.ax.v[l],           f.ay.v[l],  f.bx.v[l],     f.by.v[l],
                                       f.tx.v[l],           f.ty.v[l],  f.length.v[l], f.max.v[l],
                                       f.may.v[l],          f.mbx.v[l], f.mby.v[l],    face.depth,
                                       f.regular_depth.v[l]};
  const Vec2 p(corner_values_.x[near.p].v[l], corner_values_.y[near.p].v[l]);
  const Vec2 q(corner_values_.x[near.q].v[l], corner_values_.y[near.q].v[l]);
  CollarPiece<double> piece;
  CollarCrossings<double> crossings;
  if (!general_collar_piece(collar_face, p.x(), p.y(), q.x(), q.y(), piece, crossings)) return;
  const Vec2 edge = q - p;
  const double length = edge.norm();
  const EdgeFaceForces<double> force =
      edge_face_forces(piece, near.slope, length, 1 / collar_face.length);
  const auto push = [&](size_t i, const Vec2& inward, double size) {
    corner_values_.fx[i].v[l] += size * inward.x();
    corner_values_.fy[i].v[l] += size * inward.y();
  };
  const Vec2 from_edge = Vec2(-edge.y(), edge.x()) / length,
             from_face(-collar_face.ty, collar_face.tx);
  push(near.p, from_edge, force.edge_start);
  push(near.q, from_edge, force.edge_end);
  push(face.a, from_face, force.face_start);
  push(face.b, from_face, force.face_end);
}

// Sums the forces on the coordinates of a body.
APOTHEM_INLINE void OutlinePath::add_forces(const PathBody& side, const Step& step,
                                            const Pack& theta) {
  const OutlineSurfaces::Body& body = outlines_.bodies[side.body];
  Pack* force = &forces_[side.coordinates];
  if (!body.is_rigid()) {
    for (size_t i = side.first_end; i < side.end; ++i) {
      *force++ = corner_values_.fx[corner_of_end_[i]];
      *force++ = corner_values_.fy[corner_of_end_[i]];
    }
    return;
  }
  const Pack back = (Pack(1.) - theta) * Pack(step.dt);
  const double* v = &step.now.pose_rate[3 * static_cast<size_t>(body.rigid)];
  const Pack cx = Pack(body.cx) - back * Pack(v[0]), cy = Pack(body.cy) - back * Pack(v[1]);
  Pack x(0.), y(0.), moment(0.);
  for (size_t i = side.first_end; i < side.end; ++i) {
    const size_t k = corner_of_end_[i];
    const Pack &fx = corner_values_.fx[k], &fy = corner_values_.fy[k];
    x += fx, y += fy;
    moment += (corner_values_.x[k] - cx) * fy - (corner_values_.y[k] - cy) * fx;
  }
  force[0] = x, force[1] = y, force[2] = moment;
}

// Moments of forces at earlier positions do not balance at the end of the step. Half of the
// difference goes to each body, so that the angular momentum is conserved.
void OutlinePath::balance() {
  double rest = 0;
  for (const PathBody& side : sides_) rest += moment(side);
  for (const PathBody& side : sides_) turn(side, -rest / static_cast<double>(sides_.size()));
}

// The moment of the missing impulses on a body about the first vertex of ends_, at the end of the
// step.
double OutlinePath::moment(const PathBody& side) const {
  const OutlineSurfaces& o = outlines_;
  const OutlineSurfaces::Body& body = o.bodies[side.body];
  const Vec2 origin = o.point(ends_.front());
  const Coordinate* c = &coordinates_[side.coordinates];
  if (body.is_rigid()) {
    const Vec2 centre(body.cx, body.cy);
    return cross(centre - origin, Vec2(c[0].missing, c[1].missing)) + c[2].missing;
  }
  double sum = 0;
  for (size_t i = side.first_end; i < side.end; ++i, c += 2) {
    sum += cross(o.point(ends_[i]) - origin, Vec2(c[0].missing, c[1].missing));
  }
  return sum;
}

// Adds a moment to the missing impulses of a body. On a mesh this is done by the smallest forces on
// those vertices that have a missing impulse already.
void OutlinePath::turn(const PathBody& side, double moment) {
  const OutlineSurfaces& o = outlines_;
  Coordinate* const first = &coordinates_[side.coordinates];
  if (o.bodies[side.body].is_rigid()) {
    first[2].missing += moment;
    return;
  }
  const auto each = [&](auto&& f) {
    Coordinate* c = first;
    for (size_t i = side.first_end; i < side.end; ++i, c += 2) {
      if (c[0].missing != 0 || c[1].missing != 0) f(o.point(ends_[i]), c[0], c[1]);
    }
  };
  Vec2 centre = Vec2::Zero();
  double count = 0, spread = 0;
  each([&](const Vec2& p, Coordinate&, Coordinate&) { centre += p, ++count; });
  if (count == 0) return;
  centre /= count;
  each([&](const Vec2& p, Coordinate&, Coordinate&) { spread += (p - centre).squaredNorm(); });
  if (!(spread > 0)) return;
  each([&](const Vec2& p, Coordinate& x, Coordinate& y) {
    const Vec2 arm = (p - centre) * (moment / spread);
    x.missing -= arm.y();
    y.missing += arm.x();
  });
}

void OutlinePath::keep(const PathBody& side, std::vector<Impulse>& on_nodes,
                       std::vector<Impulse>& on_rigid) const {
  const OutlineSurfaces& o = outlines_;
  const Coordinate* c = &coordinates_[side.coordinates];
  if (o.bodies[side.body].is_rigid()) {
    for (size_t k = 0; k < 3; ++k) {
      on_rigid.push_back({3 * static_cast<size_t>(o.bodies[side.body].rigid) + k, c[k].missing});
    }
    return;
  }
  for (size_t i = side.first_end; i < side.end; ++i) {
    for (size_t k = 0; k < 2; ++k) {
      on_nodes.push_back({2 * static_cast<size_t>(o.node[ends_[i]]) + k, (c++)->missing});
    }
  }
}

}  // namespace apothem
