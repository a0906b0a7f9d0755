#include "apothem/contact/outline_onset.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "apothem/execution/elementary.hpp"

namespace apothem {
namespace {

constexpr double kSuddenLength = .1;  // change of the boundary inside, of the smaller r
constexpr double kRoundOff = 1e-9;

// Sums of these tell sets of vertices apart.
std::uint64_t scrambled(int vertex) {
  std::uint64_t z = (static_cast<std::uint64_t>(vertex) + 1) * 0x9e3779b97f4a7c15ULL;
  z = (z ^ (z >> 31)) * 0xbf58476d1ce4e5b9ULL;
  return z ^ (z >> 29);
}

}  // namespace

struct OutlineOnset::Step {
  const Kinematics& now;
  const Dynamics& dynamics;
  double dt;
};

// One entry for each run of contacts of a pair, then one for each pair.
void OutlineOnset::find_touching(const EdgeFaceBlocks& blocks, const OutlinePlateaus& plateaus,
                                 bool at_first) {
  const Outlines& o = outlines_;
  std::vector<TouchingPair>& list = watch_.begin_step();
  blocks.each_contact([&](size_t i, size_t lane) {
    const EdgeFaceTouch& touch = blocks.touches()[i];
    const int edge = blocks.blocks()[i].p[lane], face = blocks.blocks()[i].a[lane];
    if (at_first && touch.deepest[lane] < kRoundOff * o.length[edge]) return;
    const auto [a, b] = std::minmax({o.body[edge], o.body[face]});
    const TouchingPair pair{a, b, 0, 0, 0};
    if (list.empty() || !list.back().same_pair(pair)) list.push_back(pair);
    if (touch.from[lane] == 0) list.back().inside_a += scrambled(edge);
    list.back().length += (touch.to[lane] - touch.from[lane]) * o.length[edge];
  });
  const auto add_deep = [&](int own, BodyIndex in) {
    const auto [a, b] = std::minmax(o.body[own], in);
    const TouchingPair pair{a, b, 0, 0, 0, true};
    if (list.empty() || !list.back().same_pair(pair) || !list.back().deep) list.push_back(pair);
  };
  for (const OutlinePlateaus::Edge& on : plateaus.edges()) add_deep(on.edge, on.in);
  for (const OutlinePlateaus::Face& on : plateaus.faces()) add_deep(on.face, on.in);
  std::ranges::sort(list, std::less<>());
  size_t last = 0;
  for (size_t i = 1; i < list.size(); ++i) {
    if (list[i].same_pair(list[last])) {
      list[last].inside_a += list[i].inside_a;
      list[last].length += list[i].length;
      list[last].deep = list[last].deep || list[i].deep;
    } else {
      list[++last] = list[i];
    }
  }
  list.resize(std::min(list.size(), last + 1));
}

bool OutlineOnset::find(std::span<const EdgeFace> candidates, const EdgeFaceBlocks& blocks,
                        const OutlinePlateaus& plateaus, const Kinematics& now,
                        const Dynamics& dynamics, double dt) {
  find_touching(blocks, plateaus, !(dt > 0));
  on_nodes_.clear(), on_rigid_.clear();
  if (!(dt > 0)) return false;
  const std::vector<Outlines::Body>& bodies = outlines_.bodies;
  watch_.compare(
      [&](BodyIndex a, BodyIndex b) {
        return kSuddenLength * std::min(bodies[a].reference, bodies[b].reference);
      },
      [&](BodyIndex a, BodyIndex b, int panels) {
        find_pair(a, b, panels, candidates, {now, dynamics, dt});
      });
  return !on_nodes_.empty();
}

void OutlineOnset::find_pair(BodyIndex body_a, BodyIndex body_b, int panels,
                             std::span<const EdgeFace> candidates, const Step& step) {
  take_near(body_a, body_b, candidates);
  if (near_.empty()) return;
  coordinates_.clear(), sides_.clear();
  sides_.push_back(take_side(body_a, step));
  if (body_b != body_a) sides_.push_back(take_side(body_b, step));
  find_events(step);
  const int inside = find_onset_samples(events_, panels, samples_);
  for (int i = 0; i < static_cast<int>(samples_.size()); ++i) {
    for (const Side& side : sides_) place(side.body, step, samples_[i].theta);
    find_forces();
    forces_.clear();
    for (const Side& side : sides_) add_forces(side, step, samples_[i].theta);
    for (size_t c = 0; c < coordinates_.size(); ++c) {
      OnsetForces& f = coordinates_[c].force;
      f.add(samples_[i], forces_[c]);
      if (i == 0) f.first = forces_[c];
      if (i + 1 == inside) f.last = forces_[c];
    }
  }
  OnsetRest rest_a(step.dt), rest_b(step.dt);
  for (size_t i = 0; i < coordinates_.size(); ++i) {
    Coordinate& c = coordinates_[i];
    c.missing = c.force.missing();
    (i < sides_.back().coordinates ? rest_a : rest_b)
        .add(c.force, c.missing, step.dynamics.others(c.index, c.force),
             step.dynamics.inverse_mass[c.index], c.velocity);
  }
  rest_a.add(rest_b);
  const double share = rest_a.share();
  for (Coordinate& c : coordinates_) c.missing += share * c.force.mean;
  balance();
  for (const Side& side : sides_) keep(side);
}

// The candidates of the two bodies; candidates ascend by edge, and so by the body of the edge.
void OutlineOnset::take_near(BodyIndex a, BodyIndex b, std::span<const EdgeFace> candidates) {
  const Outlines& o = outlines_;
  near_.clear(), ends_.clear(), corners_.clear();
  const auto take = [&](BodyIndex edges, BodyIndex faces) {
    const auto first = std::ranges::lower_bound(candidates, o.bodies[edges].first, {},
                                                [](const EdgeFace& c) { return c.edge; });
    for (auto c = first; c != candidates.end() && c->edge < o.bodies[edges].end; ++c) {
      if (o.body[c->face] == faces) near_.push_back(*c);
    }
  };
  take(a, b);
  if (a != b) take(b, a);
  for (const auto& [e, f, pair] : near_) {
    for (const int i : {e, o.next[e], f, o.next[f]}) ends_.push_back(i);
    for (const int i : {o.previous[f], o.next[o.next[f]]}) corners_.push_back(i);
  }
  const auto tidy = [](std::vector<int>& list) {
    std::ranges::sort(list);
    list.erase(std::unique(list.begin(), list.end()), list.end());
  };
  tidy(ends_);
  corners_.insert(corners_.end(), ends_.begin(), ends_.end());
  tidy(corners_);
  for (std::vector<double>* v : {&x_, &y_, &fx_, &fy_}) v->resize(static_cast<size_t>(o.size()));
  start_.resize(static_cast<size_t>(o.size()));
}

OutlineOnset::Side OutlineOnset::take_side(BodyIndex body, const Step& step) {
  const Outlines& o = outlines_;
  const auto at = [&](int vertex) {
    return static_cast<size_t>(std::ranges::lower_bound(ends_, vertex) - ends_.begin());
  };
  const Side side{body, at(o.bodies[body].first), at(o.bodies[body].end), coordinates_.size()};
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

// Moves the corners of a body to a place of the path.
void OutlineOnset::place(BodyIndex b, const Step& step, double theta) {
  const Outlines& o = outlines_;
  const Outlines::Body& body = o.bodies[b];
  const double back = (1 - theta) * step.dt;
  const auto first = std::ranges::lower_bound(corners_, body.first);
  const auto each = [&](auto&& move) {
    for (auto i = first; i != corners_.end() && *i < body.end; ++i) move(*i);
  };
  if (!body.is_rigid()) {
    each([&](int i) {
      const double* v = &step.now.node_velocity[2 * static_cast<size_t>(o.node[i])];
      x_[i] = o.x[i] - back * v[0];
      y_[i] = o.y[i] - back * v[1];
    });
    return;
  }
  const double* v = &step.now.pose_rate[3 * static_cast<size_t>(body.rigid)];
  const auto [s, c] = sine_cosine(back * v[2]);
  each([&](int i) {
    const double rx = o.x[i] - body.cx, ry = o.y[i] - body.cy;
    x_[i] = body.cx - back * v[0] + (c * rx + s * ry);
    y_[i] = body.cy - back * v[1] + (c * ry - s * rx);
  });
}

// Where a vertex of one outline crosses an edge of the other one: heights are linear in theta, but
// for small deformations and rotations.
void OutlineOnset::find_events(const Step& step) {
  const Outlines& o = outlines_;
  const auto place_all = [&](double theta) {
    for (const Side& side : sides_) place(side.body, step, theta);
  };
  place_all(0);
  for (const int i : ends_) start_[i] = point(i);
  place_all(1);
  events_.clear();
  for (const auto& [e, f, pair] : near_) {
    const int g = o.next[f];
    const double h0 = cross(start_[g] - start_[f], start_[e] - start_[f]);
    const double h1 = cross(point(g) - point(f), point(e) - point(f));
    const double theta = crossing(h0, h1);
    if (theta < 0) continue;
    const auto at = [&](int i) { return Vec2(start_[i] + theta * (point(i) - start_[i])); };
    const Vec2 edge = at(g) - at(f);
    const double along = edge.dot(at(e) - at(f)) / edge.squaredNorm();
    if (along > -kRoundOff && along < 1 + kRoundOff) events_.push_back(theta);
  }
  std::ranges::sort(events_);
}

CollarFace<double> OutlineOnset::face(int i) const {
  const Outlines& o = outlines_;
  const int p = o.previous[i], j = o.next[i];
  const auto tangent = [&](int k) { return Vec2((point(o.next[k]) - point(k)).normalized()); };
  const Vec2 before = tangent(p), own = tangent(i), after = tangent(j);
  const Mitre<double> a(before.x(), before.y(), own.x(), own.y());
  const Mitre<double> b(own.x(), own.y(), after.x(), after.y());
  const CollarFace<double> face{
      x_[i], y_[i], x_[j], y_[j], own.x(),    own.y(), (point(j) - point(i)).norm(),
      a.x,   a.y,   b.x,   b.y,   o.depth[i], 0};
  return face.with_plain();
}

// Of the near edges and faces, where the corners are.
void OutlineOnset::find_forces() {
  const Outlines& o = outlines_;
  for (const int i : ends_) fx_[i] = fy_[i] = 0;
  const auto push = [&](int i, const Vec2& inward, double force) {
    fx_[i] += force * inward.x();
    fy_[i] += force * inward.y();
  };
  CollarPiece<double> piece;
  for (const auto& [e, f, pair] : near_) {
    CollarCrossings<double> top;
    const int q = o.next[e];
    const Vec2 base = point(o.next[f]) - point(f);
    if (cross(base, point(e) - point(f)) < 0 && cross(base, point(q) - point(f)) < 0) continue;
    const CollarFace<double> face_f = face(f);
    if (!collar_piece(face_f, x_[e], y_[e], x_[q], y_[q], piece, top)) continue;
    const Vec2 edge = point(q) - point(e);
    const double length = edge.norm();
    const EdgeFaceForces<double> force =
        edge_face_forces(piece, slopes_.of({e, f}), length, 1 / face_f.length);
    const Vec2 from_edge = Vec2(-edge.y(), edge.x()) / length;
    push(e, from_edge, force.edge_start);
    push(q, from_edge, force.edge_end);
    const Vec2 from_face(-face_f.ty, face_f.tx);
    push(f, from_face, force.face_start);
    push(o.next[f], from_face, force.face_end);
  }
}

// Appends the forces on the coordinates of a body.
void OutlineOnset::add_forces(const Side& side, const Step& step, double theta) {
  const Outlines::Body& body = outlines_.bodies[side.body];
  if (!body.is_rigid()) {
    for (size_t i = side.first_end; i < side.end; ++i) {
      forces_.push_back(fx_[ends_[i]]);
      forces_.push_back(fy_[ends_[i]]);
    }
    return;
  }
  const double back = (1 - theta) * step.dt;
  const double* v = &step.now.pose_rate[3 * static_cast<size_t>(body.rigid)];
  const Vec2 centre(body.cx - back * v[0], body.cy - back * v[1]);
  Vec2 force = Vec2::Zero();
  double moment = 0;
  for (size_t i = side.first_end; i < side.end; ++i) {
    const Vec2 f(fx_[ends_[i]], fy_[ends_[i]]);
    force += f;
    moment += cross(point(ends_[i]) - centre, f);
  }
  forces_.insert(forces_.end(), {force.x(), force.y(), moment});
}

// Moments of forces at earlier positions do not balance at the end of the step. What is left over
// goes to both bodies in equal parts, so that the angular momentum is kept.
void OutlineOnset::balance() {
  double rest = 0;
  for (const Side& side : sides_) rest += moment(side);
  for (const Side& side : sides_) turn(side, -rest / static_cast<double>(sides_.size()));
}

// Of what is missing, about the first end, where the bodies are at the end of the step.
double OutlineOnset::moment(const Side& side) const {
  const Outlines& o = outlines_;
  const Outlines::Body& body = o.bodies[side.body];
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

// Adds a moment: on a mesh, the smallest forces on the ends that have one already.
void OutlineOnset::turn(const Side& side, double moment) {
  const Outlines& o = outlines_;
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

void OutlineOnset::keep(const Side& side) {
  const Outlines& o = outlines_;
  const Coordinate* c = &coordinates_[side.coordinates];
  if (o.bodies[side.body].is_rigid()) {
    for (size_t k = 0; k < 3; ++k) {
      on_rigid_.push_back({3 * static_cast<size_t>(o.bodies[side.body].rigid) + k, c[k].missing});
    }
    return;
  }
  for (size_t i = side.first_end; i < side.end; ++i) {
    for (size_t k = 0; k < 2; ++k) {
      on_nodes_.push_back({2 * static_cast<size_t>(o.node[ends_[i]]) + k, (c++)->missing});
    }
  }
}

void OutlineOnset::add(double scale, const ForceViews& forces) const {
  for (const Impulse& i : on_nodes_) forces.nodes[i.coordinate] += scale * i.mean;
  for (const Impulse& i : on_rigid_) forces.rigid[i.coordinate] += scale * i.mean;
}

}  // namespace apothem
