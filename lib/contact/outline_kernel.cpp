#include "apothem/contact/outline_kernel.hpp"

#include <algorithm>
#include <cmath>

#include "apothem/contact/stiffness.hpp"
#include "apothem/execution/dispatch.hpp"

namespace apothem {
namespace {

constexpr double kCandidateTime = 20;  // ns
constexpr double kInsideTop = 2;       // share of a contact that is not with a face

}  // namespace

OutlineKernel::OutlineKernel(const Outlines& outlines, double thickness, const PairTable& table,
                             const std::vector<double>& inverse_mass, int threads)
    : outlines_(outlines),
      thickness_(thickness),
      table_(table),
      slopes_{outlines, table, thickness},
      threads_(threads),
      found_(static_cast<size_t>(threads_.count())),
      plateaus_(outlines),
      depths_(outlines),
      onset_(outlines, slopes_) {
  const auto n = static_cast<size_t>(outlines.size());
  fx_.resize(n), fy_.resize(n), ends_.resize(n);
  if (table.rough() || table.damped()) {
    friction_.emplace(outlines, table, inverse_mass, threads);
  }
}

void OutlineKernel::take(std::span<const BoxPair> pairs) {
  if (friction_) friction_->take(pairs);
  candidates_.clear();
  laws_.clear();
  std::fill(ends_.begin(), ends_.end(), Ends{0, 0});
  for (std::vector<double>* of_all : {&fx_, &fy_}) std::fill(of_all->begin(), of_all->end(), 0.);
  for (const auto& [a, b] : pairs) {
    find_candidates(a, b);
    if (a != b) find_candidates(b, a);
  }
  std::sort(candidates_.begin(), candidates_.end());
  plateaus_.take(pairs);
}

EdgeFaceLaw OutlineKernel::law_of(BodyIndex edges, BodyIndex faces) const {
  const Friction& friction = table_.between(edges, faces).friction;
  const double spring =
      friction.tangential_stiffness * thickness_ / outlines_.bodies[faces].reference;
  return {slopes_(faces, edges), spring, friction.coefficient,
          friction_ ? friction_->bodies(edges, faces) : 0, edges == faces};
}

// An edge of a body lies on its own face, without a depth, and in those of the edges next to it
// only where these have shrunk to nothing.
bool OutlineKernel::are_neighbours(int edge, int face) const {
  const Outlines& o = outlines_;
  if (edge == face) return true;
  if (o.next[edge] != face && o.previous[edge] != face) return false;
  const Vec2 top = o.top(o.next[face]) - o.top(face);
  return o.tx[face] * top.x() + o.ty[face] * top.y() > 2 * o.growth();
}

// Edges of a, faces of b: sweep along the longer side of the common region.
void OutlineKernel::find_candidates(BodyIndex a, BodyIndex b) {
  const Outlines& o = outlines_;
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

void OutlineKernel::evaluate(std::vector<Contact>& contacts) {
  const Outlines& o = outlines_;
  contacts_.clear();
  depths_.forget();
  o.each_active_vertex([&](int i) { ends_[i] = {0, 0}; });
  plateaus_.begin();
  for (EdgeFaceMeetings& found : found_) found.clear();
  threads_.chunks(static_cast<int>(candidates_.size()), kCandidateTime,
                  [&](int first, int end, int worker) {
                    const auto part =
                        std::span<const EdgeFace>(candidates_)
                            .subspan(static_cast<size_t>(first), static_cast<size_t>(end - first));
                    EdgeFaceMeetings& found = found_[static_cast<size_t>(worker)];
                    with_widest([&](auto /*lanes*/) __attribute__((always_inline)) {
                      find_meetings<kComparedLanes>(o, part, laws_, found);
                      return 0.;
                    });
                  });
  for (EdgeFaceMeetings& found : found_) take(found, contacts);
  add_plateaus(contacts);
  o.each_active_vertex([&](int i) {
    const int p = o.previous[i];
    const double own = ends_[i][0], before = ends_[p][1];
    fx_[i] = -before * o.ty[p] - own * o.ty[i];
    fy_[i] = before * o.tx[p] + own * o.tx[i];
  });
}

void OutlineKernel::take(EdgeFaceMeetings& found, std::vector<Contact>& contacts) {
  for (const EdgeFaceMeetings::Push& push : found.pushes) {
    Ends& edge = ends_[static_cast<size_t>(push.edge)];
    edge[0] += push.force.edge_start;
    edge[1] += push.force.edge_end;
    Ends& face = ends_[static_cast<size_t>(push.face)];
    face[0] += push.force.face_start;
    face[1] += push.force.face_end;
  }
  contacts.insert(contacts.end(), found.records.begin(), found.records.end());
  if (contacts_.empty()) {
    contacts_.swap(found.contacts);
  } else {
    contacts_.insert(contacts_.end(), found.contacts.begin(), found.contacts.end());
  }
  for (const auto& [pair, top] : found.crossings) plateaus_.add(pair, top);
}

// An edge inside the top of a body is a contact with that body, and has the first face of its
// outline for it.
void OutlineKernel::add_plateaus(std::vector<Contact>& contacts) {
  const Outlines& o = outlines_;
  plateaus_.evaluate();
  for (const OutlinePlateaus::Edge& on : plateaus_.edges()) {
    const Outlines::Body& in = o.bodies[on.in];
    const BodyIndex own = o.body[on.edge];
    const double force = slopes_(on.in, own) * in.depth * o.length[on.edge];
    ends_[on.edge][0] += force * (on.sum - on.first);
    ends_[on.edge][1] += force * on.first;
    contacts.push_back({outline_kernel, on.edge, in.first, 0, HUGE_VAL, kInsideTop, 0});
  }
  for (const OutlinePlateaus::Face& on : plateaus_.faces()) {
    const double slope = slopes_(o.body[on.face], on.in);
    const double end = slope * on.moment.along / o.length[on.face];
    ends_[on.face][0] += slope * on.moment.area - end;
    ends_[on.face][1] += end;
    contacts.push_back({outline_kernel, o.bodies[on.in].first, on.face, 0, 0, kInsideTop, 0});
  }
}

const EdgeFaceContact& OutlineKernel::edge_face(const Contact& c) const {
  return *std::lower_bound(contacts_.begin(), contacts_.end(), std::pair(c.a, c.b),
                           [](const EdgeFaceContact& k, const std::pair<int, int>& key) {
                             return std::pair(k.edge, k.face) < key;
                           });
}

double OutlineKernel::penetration(const Contact& c, double floor) {
  return c.share <= 1 ? depths_.of_piece(c.a, c.b, edge_face(c).piece, floor)
                      : depths_.of_edge(c.a, outlines_.body[c.b], floor);
}

double OutlineKernel::slide(const Kinematics& now, double dt, FrictionMemory& memory) {
  return friction_ ? friction_->slide(contacts_, laws_, now, dt, memory) : 0;
}

void OutlineKernel::add_forces(const ForceViews& forces) {
  const Outlines& o = outlines_;
  const VertexForces* const friction = friction_ ? &friction_->friction() : nullptr;
  const VertexForces* const damping =
      friction_ && !friction_->damping().empty() ? &friction_->damping() : nullptr;
  o.each_active_vertex([&](int i) {
    if (o.node[i] < 0) return;
    const size_t vertex = 2 * static_cast<size_t>(i);
    double* const f = &forces.nodes[2 * static_cast<size_t>(o.node[i])];
    f[0] += fx_[i];
    f[1] += fy_[i];
    for (const VertexForces* part : {friction, damping}) {
      if (!part) continue;
      f[0] += (*part)[vertex];
      f[1] += (*part)[vertex + 1];
    }
  });
  for (const BodyIndex b : o.active()) {
    if (!o.bodies[b].is_rigid()) continue;
    const Resultant on = resultant(b);
    double* f = &forces.rigid[3 * static_cast<size_t>(b)];
    f[0] += on.force.x();
    f[1] += on.force.y();
    f[2] += on.moment;
  }
}

template <class Force>
Resultant OutlineKernel::sum(BodyIndex b, const Force& force) const {
  const Outlines& o = outlines_;
  const Outlines::Body& body = o.bodies[b];
  Resultant sum;
  for (int i = body.first; i < body.end; ++i) {
    const Vec2 f = force(static_cast<size_t>(i));
    sum.force += f;
    sum.moment += (o.x[i] - body.cx) * f.y() - (o.y[i] - body.cy) * f.x();
  }
  return sum;
}

Resultant OutlineKernel::resultant(BodyIndex body) const {
  Resultant on = sum(body, [&](size_t i) { return Vec2(fx_[i], fy_[i]); });
  if (!friction_) return on;
  for (const VertexForces* part : {&friction_->friction(), &friction_->damping()}) {
    if (part->empty()) continue;
    const Resultant other = sum(body, [&](size_t i) { return Vec2(&(*part)[2 * i]); });
    on.force += other.force;
    on.moment += other.moment;
  }
  return on;
}

void OutlineKernel::add_force_sizes(std::span<double> of_bodies) const {
  for (const EdgeFaceContact& c : contacts_) {
    const double size = c.slope * c.piece.sum * outlines_.length[c.edge];
    of_bodies[outlines_.body[c.edge]] += size;
    of_bodies[outlines_.body[c.face]] += size;
  }
}

double OutlineKernel::energy() const {
  double sum = 0;
  for (const EdgeFaceContact& c : contacts_) sum += c.slope * c.piece.height;
  for (const OutlinePlateaus::Edge& on : plateaus_.edges()) {
    sum += slopes_(on.in, outlines_.body[on.edge]) * outlines_.bodies[on.in].depth * on.swept;
  }
  for (const OutlinePlateaus::Face& on : plateaus_.faces()) {
    sum += slopes_(outlines_.body[on.face], on.in) *
           (on.moment.height + outlines_.depth[on.face] * on.swept);
  }
  return sum;
}

double OutlineKernel::rate(std::span<const double> node_mass) const {
  const Outlines& o = outlines_;
  // The steepest potential among the others: of the first and second of all.
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
    worst = std::max(worst, node_rate(stiffness, o.bodies[b].slope() + other, o.share(i), mass));
  }
  return worst;
}

void OutlineKernel::add_stiffness(std::span<double> nodes, std::span<double> rigid) const {
  const Outlines& o = outlines_;
  std::vector<double> slope(o.size(), 0);       // of each vertex: 1/r_c + 1/r_t
  std::vector<double> normal(o.size(), 0);      // largest k_n thickness, N/m
  std::vector<double> tangential(o.size(), 0);  // largest k_s thickness, N/m
  std::vector<std::pair<BodyIndex, int>> met;   // rigid bodies and vertices of meshes near them
  for (const EdgeFace& c : candidates_) {
    const BodyIndex own = o.body[c.edge], other = o.body[c.face];
    const double both = o.bodies[own].slope() + o.bodies[other].slope();
    const PairLaw& law = table_.between(own, other);
    const Friction& f = law.friction;
    const double spring = f.coefficient > 0 ? f.tangential_stiffness * thickness_ : 0;
    for (const int i : {c.edge, o.next[c.edge], c.face, o.next[c.face]}) {
      slope[i] = std::max(slope[i], both);
      normal[i] = std::max(normal[i], law.normal_stiffness * thickness_);
      tangential[i] = std::max(tangential[i], spring);
      const BodyIndex partner = o.body[i] == own ? other : own;
      if (o.bodies[partner].is_rigid() && o.node[i] >= 0) met.emplace_back(partner, i);
    }
  }
  // Springs pull along the contact, potentials push across it.
  const auto of_vertex = [&](int i) {
    return node_rate(normal[i] + tangential[i], slope[i], o.share(i));
  };
  for (int i = 0; i < o.size(); ++i) {
    if (o.node[i] >= 0) nodes[o.node[i]] += of_vertex(i);
  }
  std::sort(met.begin(), met.end());
  met.erase(std::unique(met.begin(), met.end()), met.end());
  for (const auto& [b, i] : met) {
    // Displacement and rotation add: k (x + r theta)^2 <= 2 k (x^2 + r^2 theta^2).
    const double stiffness = 2 * of_vertex(i);
    const double x = o.x[i] - o.bodies[b].cx, y = o.y[i] - o.bodies[b].cy;
    double* const of_body = &rigid[3 * static_cast<size_t>(o.bodies[b].rigid)];
    of_body[0] += stiffness;
    of_body[1] += stiffness;
    of_body[2] += stiffness * (x * x + y * y);
  }
}

}  // namespace apothem
