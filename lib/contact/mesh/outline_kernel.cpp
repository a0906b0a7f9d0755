#include "lib/contact/mesh/outline_kernel.hpp"

#include <algorithm>
#include <cmath>

#include "lib/contact/law/stiffness.hpp"
#include "lib/contact/mesh/outline_tangent.hpp"
#include "lib/execution/dispatch.hpp"

namespace apothem {
namespace {

constexpr double kMeetTime = 80, kForceTime = 4;  // ns
// Relative depth of a contact inside a saturated region, which is not with a face.
constexpr double kSaturated = 2;
constexpr double kAbove = 1 + 1e-9;  // factor that makes bounds safe against round-off

}  // namespace

OutlineKernel::OutlineKernel(const Surfaces& surfaces, double thickness, const PairTable& table,
                             int threads)
    : outlines_(surfaces.outlines()),
      thickness_(thickness),
      table_(table),
      slopes_{outlines_, table, thickness},
      threads_(threads),
      blocks_(outlines_),
      workers_(static_cast<size_t>(threads_.count())),
      saturated_(outlines_),
      depths_(outlines_),
      events_(outlines_, slopes_, threads) {
  ends_.resize(static_cast<size_t>(outlines_.size()));
  if (table.rough() || table.damped()) friction_.emplace(surfaces, table, threads);
}

void OutlineKernel::set_pairs(std::span<const BoxPair> pairs) {
  if (friction_) friction_->set_pair_count(pairs.size());
  candidates_.clear();
  laws_.clear();
  pair_forces_.clear();
  for (const BoxPair& pair : pairs) pair_forces_.push_back({pair, Vec2::Zero()});
  std::ranges::sort(pair_forces_, {}, &BodyPairForce::bodies);
  std::fill(ends_.begin(), ends_.end(), EndForces{0, 0});
  for (const auto& [a, b] : pairs) {
    find_candidates(a, b);
    if (a != b) find_candidates(b, a);
  }
  std::sort(candidates_.begin(), candidates_.end());
  blocks_.set_candidates(candidates_, laws_);
  blocks_.divide(threads_);
  saturated_.set_pairs(pairs);
}

EdgeFaceLaw OutlineKernel::law_of(BodyIndex edges, BodyIndex faces) const {
  return {slopes_(faces, edges), &table_.between(edges, faces), edges == faces,
          pair_number(edges, faces)};
}

std::int32_t OutlineKernel::pair_number(BodyIndex a, BodyIndex b) const {
  const auto [low, high] = std::minmax(a, b);
  const auto position =
      std::ranges::lower_bound(pair_forces_, BoxPair{low, high}, {}, &BodyPairForce::bodies);
  return static_cast<std::int32_t>(position - pair_forces_.begin());
}

// The force of a pair is summed over the edges and faces of the body with the lower number. The
// force of a body on itself does not count.
void OutlineKernel::find_largest_force() {
  const OutlineSurfaces& o = outlines_;
  for (BodyPairForce& pair : pair_forces_) pair.force = Vec2::Zero();
  const std::span<const EdgeFaceLaw> laws = blocks_.laws();
  for (size_t i = 0; i < laws.size(); ++i) {
    pair_forces_[static_cast<size_t>(laws[i].pair)].force += blocks_.forces()[i];
  }
  const auto add = [&](int line, BodyIndex other, double force) {
    if (o.body[line] > other) return;
    pair_forces_[static_cast<size_t>(pair_number(o.body[line], other))].force +=
        force * Vec2(-o.ty[line], o.tx[line]);
  };
  for (const SaturatedEdge& saturated : saturated_.edges()) {
    add(saturated.edge, saturated.body,
        slopes_(saturated.body, o.body[saturated.edge]) * o.bodies[saturated.body].depth *
            saturated.sum * o.length[saturated.edge]);
  }
  for (const SaturatedFace& saturated : saturated_.faces()) {
    add(saturated.face, saturated.body,
        slopes_(o.body[saturated.face], saturated.body) * saturated.moment.area);
  }
  largest_force_ = {};
  for (const auto& [bodies, force] : pair_forces_) {
    if (bodies.first == bodies.second) continue;
    const double size = hypotenuse(force.x(), force.y());
    if (size > largest_force_.value) largest_force_ = {size, bodies.first, bodies.second};
  }
}

// An edge lies on its own face without a depth, and in the faces of its neighbours only where these
// have shrunk to nothing.
bool OutlineKernel::are_neighbours(int edge, int face) const {
  const OutlineSurfaces& o = outlines_;
  if (edge == face) return true;
  if (o.next[edge] != face && o.previous[edge] != face) return false;
  const Vec2 offset_edge = o.offset_point(o.next[face]) - o.offset_point(face);
  return o.tx[face] * offset_edge.x() + o.ty[face] * offset_edge.y() > 2 * o.growth();
}

// Finds the candidates of the edges of a and the faces of b, by a sweep along the longer side of
// the region that they share.
void OutlineKernel::find_candidates(BodyIndex a, BodyIndex b) {
  const OutlineSurfaces& o = outlines_;
  near_edges_.clear(), near_faces_.clear();
  Box common;
  for (int i = o.bodies[a].first; i < o.bodies[a].end; ++i) {
    const Box& box = o.edge_boxes[i];
    if (apart(box, o.body_boxes[b])) continue;
    near_edges_.push_back(i);
    common.include(box.x0, box.y0);
    common.include(box.x1, box.y1);
  }
  for (int i = o.bodies[b].first; i < o.bodies[b].end; ++i) {
    if (!apart(o.face_boxes[i], o.body_boxes[a])) near_faces_.push_back(i);
  }
  if (near_edges_.empty() || near_faces_.empty()) return;
  const auto pair = static_cast<std::int32_t>(laws_.size());
  laws_.push_back(law_of(a, b));
  const bool across = common.x1 - common.x0 >= common.y1 - common.y0;
  const auto low = [&](const Box& box) { return across ? box.x0 : box.y0; };
  const auto high = [&](const Box& box) { return across ? box.x1 : box.y1; };
  std::sort(near_faces_.begin(), near_faces_.end(), [&](int i, int j) {
    return std::pair(low(o.face_boxes[i]), i) < std::pair(low(o.face_boxes[j]), j);
  });
  double widest = 0;
  for (const int i : near_faces_) {
    widest = std::max(widest, high(o.face_boxes[i]) - low(o.face_boxes[i]));
  }
  for (const int e : near_edges_) {
    const Box& box = o.edge_boxes[e];
    auto it = std::lower_bound(near_faces_.begin(), near_faces_.end(), low(box) - widest,
                               [&](int i, double x) { return low(o.face_boxes[i]) < x; });
    for (; it != near_faces_.end() && low(o.face_boxes[*it]) <= high(box); ++it) {
      if (apart(box, o.face_boxes[*it])) continue;
      if (a == b && are_neighbours(e, *it)) continue;
      candidates_.push_back({e, *it, pair});
    }
  }
}

void OutlineKernel::evaluate() {
  const OutlineSurfaces& o = outlines_;
  listed_ = false;
  depths_.forget();
  o.each_active_vertex([&](int i) { ends_[i] = {0, 0}; });
  saturated_.begin();
  for (EvaluationWorkspace& worker : workers_) worker.crossings.clear(), worker.deferred.clear();
  const std::span<EdgeFaceUnit> units = blocks_.units();
  const auto count = static_cast<int>(units.size());
  const double of_unit =
      kMeetTime * static_cast<double>(blocks_.blocks().size()) / std::max(count, 1);
  const bool divided = threads_.worth(count, of_unit);
  threads_.chunks(count, of_unit, [&](int first, int end, int number) {
    EvaluationWorkspace& worker = workers_[static_cast<size_t>(number)];
    const auto push = [&](std::int32_t i, const EdgeFacePushes& pushes) APOTHEM_LAMBDA {
      const EdgeFaceBlock& block = blocks_.blocks()[i];
      const auto add_at_once = [&](std::int32_t edge, const EndForces& force)
                                   APOTHEM_LAMBDA { add(force, ends_[edge]); };
      if (!divided || !blocks_.has_shared(i)) {
        each_push(block, pushes, add_at_once);
        return;
      }
      each_push(block, pushes, [&](std::int32_t edge, const EndForces& force) APOTHEM_LAMBDA {
        if (blocks_.is_shared(edge)) {
          worker.deferred.emplace_back(edge, force);
        } else {
          add_at_once(edge, force);
        }
      });
    };
    with_widest([&](auto /*lanes*/) APOTHEM_LAMBDA {
      for (int u = first; u < end; ++u) {
        find_meetings(o, blocks_, units[static_cast<size_t>(u)], worker.crossings, push);
      }
      return 0.;
    });
  });
  // Deferred forces are added in the order of the units, as if one thread had worked on all of
  // them.
  for (const EvaluationWorkspace& worker : workers_) {
    for (const auto& [edge, force] : worker.deferred) add(force, ends_[edge]);
    for (const auto& [pair, crossings] : worker.crossings) saturated_.add(pair, crossings);
  }
  add_saturated();
  find_largest_force();
}

// Adds the forces of saturated regions. An edge inside the saturated region of a body is a contact
// with that body.
void OutlineKernel::add_saturated() {
  const OutlineSurfaces& o = outlines_;
  saturated_.evaluate();
  for (const SaturatedEdge& saturated : saturated_.edges()) {
    const OutlineSurfaces::Body& other = o.bodies[saturated.body];
    const BodyIndex own = o.body[saturated.edge];
    const double force = slopes_(saturated.body, own) * other.depth * o.length[saturated.edge];
    ends_[saturated.edge][0] += force * (saturated.sum - saturated.first);
    ends_[saturated.edge][1] += force * saturated.first;
  }
  for (const SaturatedFace& saturated : saturated_.faces()) {
    const double slope = slopes_(o.body[saturated.face], saturated.body);
    const double end = slope * saturated.moment.along / o.length[saturated.face];
    ends_[saturated.face][0] += slope * saturated.moment.area - end;
    ends_[saturated.face][1] += end;
  }
}

// Contacts of outlines are never out of range.
ContactSummary OutlineKernel::summary() const {
  size_t count = saturated_.edges().size() + saturated_.faces().size();
  double square = 0;
  for (const EdgeFaceUnit& unit : blocks_.units()) {
    count += static_cast<size_t>(unit.touching);
    square = std::max(square, unit.deepest);
  }
  const double deepest = saturated_.edges().empty() ? kAbove * std::sqrt(square) : HUGE_VAL;
  return {.count = static_cast<int>(count), .deepest = deepest};
}

// In a contact with a saturated region, the partner is the first face, or the first edge, of its
// body.
void OutlineKernel::visit_contacts(double least, const ContactVisitor& visit) const {
  const OutlineSurfaces& o = outlines_;
  blocks_.each_contact([&](size_t i, size_t lane) {
    const EdgeFaceBlock& block = blocks_.blocks()[i];
    const EdgeFaceTouch& touch = blocks_.touches()[i];
    const std::int32_t edge = block.p[lane], a = block.a[lane];
    const CollarFace<double> face = o.face(a);
    const double deepest = touch.deepest[lane], relative_depth = deepest / face.depth;
    const double surely = deepest <= sure_depth(face.regular_depth, face.depth) ? deepest : 0;
    // Where a face reaches beyond the end of its edge, at a reflex vertex, the distance from the
    // boundary may exceed the height in the face. This factor bounds their ratio.
    const double beyond = std::max(0., std::max(-face.alpha(), face.beta()));
    const bool known = o.body[edge] == o.body[a] && surely > 0;
    const double at_most = known ? surely : deepest * std::sqrt(1 + beyond * beyond);
    if (at_most <= least) return;
    visit({outline_kernel, edge, a, surely, at_most, std::min(relative_depth, 1.),
           block.slope[lane] * o.length[edge] * (touch.to[lane] - touch.from[lane])});
  });
  for (const SaturatedEdge& saturated : saturated_.edges()) {
    visit({outline_kernel, saturated.edge, o.bodies[saturated.body].first, 0, HUGE_VAL, kSaturated,
           0});
  }
  if (least >= 0) return;  // contacts of saturated faces have no depth
  for (const SaturatedFace& saturated : saturated_.faces()) {
    visit({outline_kernel, o.bodies[saturated.body].first, saturated.face, 0, 0, kSaturated, 0});
  }
}

// An evaluation does not store the pieces of the contacts; they are computed again.
const std::vector<EdgeFaceContact>& OutlineKernel::edge_faces() const {
  if (listed_) return edge_faces_;
  const OutlineSurfaces& o = outlines_;
  edge_faces_.clear();
  blocks_.each_contact([&](size_t i, size_t lane) {
    const EdgeFaceBlock& block = blocks_.blocks()[i];
    const std::int32_t p = block.p[lane], q = block.q[lane], a = block.a[lane];
    CollarPiece<double> piece;
    CollarCrossings<double> crossings;
    collar_piece(o.face(a), o.x[p], o.y[p], o.x[q], o.y[q], piece, crossings);
    edge_faces_.push_back({p, a, block.slope[lane], piece});
  });
  if (friction_) friction_->add_to(blocks_, edge_faces_);
  listed_ = true;
  return edge_faces_;
}

double OutlineKernel::penetration(const Contact& c, double floor) {
  const OutlineSurfaces& o = outlines_;
  if (c.relative_depth > 1) return depths_.of_edge(c.a, o.body[c.b], floor);
  const int q = o.next[c.a];
  CollarPiece<double> piece;
  CollarCrossings<double> crossings;
  collar_piece(o.face(c.b), o.x[c.a], o.y[c.a], o.x[q], o.y[q], piece, crossings);
  return depths_.of_piece(c.a, c.b, piece, floor);
}

double OutlineKernel::update_friction(const Kinematics& now, double dt, FrictionMemory& memory) {
  listed_ = false;
  return friction_ ? friction_->update_friction(blocks_, now, dt, memory) : 0;
}

Vec2 OutlineKernel::normal_force(int i) const {
  const OutlineSurfaces& o = outlines_;
  const int p = o.previous[i];
  const double own = ends_[i][0], before = ends_[p][1];
  return {-before * o.ty[p] - own * o.ty[i], before * o.tx[p] + own * o.tx[i]};
}

Vec2 OutlineKernel::force(int vertex) const {
  const Vec2 normal = normal_force(vertex);
  return friction_ ? Vec2(normal + friction_->force(vertex)) : normal;
}

void OutlineKernel::add_forces(const ForceViews& forces) {
  const OutlineSurfaces& o = outlines_;
  const std::span<const BodyIndex> active = o.active();
  const int bodies = static_cast<int>(active.size());
  threads_.chunks(bodies, kForceTime * o.size() / std::max(bodies, 1),
                  [&](int first, int end, int) {
                    for (int k = first; k < end; ++k) {
                      const OutlineSurfaces::Body& body = o.bodies[active[k]];
                      if (body.is_rigid()) {
                        const Resultant sum = resultant(active[k]);
                        double* const f = &forces.rigid[3 * static_cast<size_t>(body.rigid)];
                        f[0] += sum.force.x();
                        f[1] += sum.force.y();
                        f[2] += sum.moment;
                        continue;
                      }
                      for (int i = body.first; i < body.end; ++i) {
                        const Vec2 vertex_force = force(i);
                        double* const f = &forces.nodes[2 * static_cast<size_t>(o.node[i])];
                        f[0] += vertex_force.x();
                        f[1] += vertex_force.y();
                      }
                    }
                  });
}

Resultant OutlineKernel::resultant(BodyIndex b) const {
  const OutlineSurfaces& o = outlines_;
  const OutlineSurfaces::Body& body = o.bodies[b];
  Resultant sum;
  for (int i = body.first; i < body.end; ++i) {
    const Vec2 f = force(i);
    sum.force += f;
    sum.moment += (o.x[i] - body.cx) * f.y() - (o.y[i] - body.cy) * f.x();
  }
  return sum;
}

// Every block in which an edge meets a face has forces, also where that is no contact.
bool OutlineKernel::add_tangent(size_t first_node, Tangent& tangent) const {
  for (size_t i = 0; i < blocks_.blocks().size(); ++i) {
    if (blocks_.met()[i] == 0) continue;
    const EdgeFaceBlock& block = blocks_.blocks()[i];
    for (unsigned m = block.lanes; m != 0; m &= m - 1) {
      const auto lane = static_cast<size_t>(std::countr_zero(m));
      add_edge_face_tangent(outlines_, first_node, block.p[lane], block.a[lane], block.slope[lane],
                            tangent);
    }
  }
  if (friction_) friction_->add_tangent(blocks_, first_node, tangent);
  return true;
}

void OutlineKernel::add_force_sizes(std::span<double> of_bodies) const {
  for (const EdgeFaceContact& c : edge_faces()) {
    const double size = c.slope * c.piece.sum * outlines_.length[c.edge];
    of_bodies[outlines_.body[c.edge]] += size;
    of_bodies[outlines_.body[c.face]] += size;
  }
}

double OutlineKernel::energy() const {
  double sum = 0;
  for (const EdgeFaceContact& c : edge_faces()) sum += c.slope * c.piece.height;
  for (const SaturatedEdge& saturated : saturated_.edges()) {
    sum += slopes_(saturated.body, outlines_.body[saturated.edge]) *
           outlines_.bodies[saturated.body].depth * saturated.swept;
  }
  for (const SaturatedFace& saturated : saturated_.faces()) {
    sum += slopes_(outlines_.body[saturated.face], saturated.body) *
           (saturated.moment.height + outlines_.depth[saturated.face] * saturated.swept);
  }
  return sum;
}

double OutlineKernel::rate(std::span<const double> node_mass) const {
  const OutlineSurfaces& o = outlines_;
  // `first` and `second` are the two steepest slopes of all bodies. The partner of the steepest
  // body has at most the second one.
  double first = 0, second = 0;
  BodyIndex steepest = -1;
  for (BodyIndex b = 0; b < static_cast<BodyIndex>(o.bodies.size()); ++b) {
    const double slope = o.bodies[b].slope();
    if (slope > first) {
      second = first, first = slope, steepest = b;
    } else {
      second = std::max(second, slope);
    }
  }
  const double stiffness = table_.stiffest() * thickness_;
  double worst = 0;
  for (int i = 0; i < o.size(); ++i) {
    const double mass = o.node[i] < 0 ? 0 : node_mass[o.node[i]];
    const BodyIndex b = o.body[i];
    const double other = b == steepest && !table_.self() ? second : first;
    if (!(mass > 0) || other == 0) continue;
    worst = std::max(
        worst, node_rate(stiffness, o.bodies[b].slope() + other, o.tributary_length(i), mass));
  }
  return worst;
}

void OutlineKernel::add_stiffness(std::span<double> nodes, std::span<double> rigid) const {
  const OutlineSurfaces& o = outlines_;
  std::vector<double> slope(o.size(), 0);       // largest 1/r_c + 1/r_t at each vertex
  std::vector<double> normal(o.size(), 0);      // largest k_n thickness, N/m
  std::vector<double> tangential(o.size(), 0);  // largest k_s thickness, N/m
  // Pairs of a rigid body and a vertex of a mesh near it.
  std::vector<std::pair<BodyIndex, int>> met;
  for (const EdgeFace& c : candidates_) {
    const BodyIndex own = o.body[c.edge], other = o.body[c.face];
    const double both = o.bodies[own].slope() + o.bodies[other].slope();
    const PairLaw& law = table_.between(own, other);
    const double spring = law.rough() ? law.one_stiffness() * thickness_ : 0;
    for (const int i : {c.edge, o.next[c.edge], c.face, o.next[c.face]}) {
      slope[i] = std::max(slope[i], both);
      normal[i] = std::max(normal[i], law.normal_stiffness * thickness_);
      tangential[i] = std::max(tangential[i], spring);
      const BodyIndex partner = o.body[i] == own ? other : own;
      if (o.bodies[partner].is_rigid() && o.node[i] >= 0) met.emplace_back(partner, i);
    }
  }
  // Friction springs act along the contact, potentials across it.
  const auto of_vertex = [&](int i) {
    return node_rate(normal[i] + tangential[i], slope[i], o.tributary_length(i));
  };
  for (int i = 0; i < o.size(); ++i) {
    if (o.node[i] >= 0) nodes[o.node[i]] += of_vertex(i);
  }
  std::sort(met.begin(), met.end());
  met.erase(std::unique(met.begin(), met.end()), met.end());
  for (const auto& [b, i] : met) {
    // Displacement and rotation add up: k (x + r theta)^2 <= 2 k (x^2 + r^2 theta^2).
    const double stiffness = 2 * of_vertex(i);
    const double x = o.x[i] - o.bodies[b].cx, y = o.y[i] - o.bodies[b].cy;
    double* const of_body = &rigid[3 * static_cast<size_t>(o.bodies[b].rigid)];
    of_body[0] += stiffness;
    of_body[1] += stiffness;
    of_body[2] += stiffness * (x * x + y * y);
  }
}

}  // namespace apothem
