#include "apothem/contact/deformable_contact.hpp"

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <tuple>

#include "apothem/contact/groups.hpp"
#include "apothem/geometry/potential/inscribed_circle.hpp"

namespace apothem {
namespace {

// Below this many candidates the threads cost more than they give.
constexpr int kCandidatesWorthThreads = 10000;

// More than the round-off of an area, relative.
constexpr double kRound = 1e-9;

void include(Box& box, const Box& other) {
  box.include(other.x0, other.y0);
  box.include(other.x1, other.y1);
}

}  // namespace

std::vector<double> inradii(const Mesh& mesh, const BoundaryLoop& loop) {
  std::vector<double> radii;
  for (const int element : loop.elements) {
    std::vector<Vec2> corners;
    for (const int n : mesh.element(element)) corners.push_back(mesh.nodes[n]);
    const Polygon polygon(corners);
    radii.push_back(polygon.is_convex() ? inscribed_circle(polygon).radius
                                        : largest_inscribed_circle(polygon).radius);
  }
  return radii;
}

double boundary_inradius(const Mesh& mesh, const Boundary& boundary) {
  double smallest = std::numeric_limits<double>::infinity();
  for (const BoundaryLoop& loop : boundary.loops) {
    for (const double r : inradii(mesh, loop)) smallest = std::min(smallest, r);
  }
  return smallest;
}

int DeformableContact::add_deformable(const Mesh& mesh, const Boundary& boundary, int first_node,
                                      std::optional<double> reference) {
  const int first = outlines_.size();
  double r = std::numeric_limits<double>::infinity();
  std::vector<Vec2> places;
  std::vector<int> nodes;
  for (const BoundaryLoop& loop : boundary.loops) {
    places.clear(), nodes.clear();
    for (const int n : loop.nodes) {
      places.push_back(mesh.nodes[n]);
      nodes.push_back(first_node + n);
    }
    const std::vector<double> caps =
        reference ? std::vector<double>(nodes.size(), *reference) : inradii(mesh, loop);
    r = std::min(r, *std::min_element(caps.begin(), caps.end()));
    add_loop(places, nodes, caps);
  }
  close_body({first, outlines_.size(), -1, r});
  return static_cast<int>(outlines_.bodies.size()) - 1;
}

int DeformableContact::add_rigid(const std::vector<Vec2>& vertices, int entry, double reference) {
  const int first = outlines_.size();
  add_loop(vertices, {}, std::vector<double>(vertices.size(), reference));
  close_body({first, outlines_.size(), entry, reference});
  return static_cast<int>(outlines_.bodies.size()) - 1;
}

void DeformableContact::add_loop(const std::vector<Vec2>& places, std::span<const int> nodes,
                                 std::span<const double> caps) {
  Outlines& o = outlines_;
  const int first = o.size();
  const int n = static_cast<int>(places.size());
  o.cap.insert(o.cap.end(), caps.begin(), caps.end());
  for (int i = 0; i < n; ++i) {
    o.x0.push_back(places[i].x());
    o.y0.push_back(places[i].y());
    o.node.push_back(nodes.empty() ? -1 : nodes[i]);
    o.next.push_back(first + (i + 1 == n ? 0 : i + 1));
    o.previous.push_back(first + (i == 0 ? n - 1 : i - 1));
    o.body.push_back(static_cast<int>(o.bodies.size()));
  }
  o.x.resize(o.x0.size()), o.y.resize(o.x0.size());
}

void DeformableContact::close_body(const Outlines::Body& body) {
  Outlines& o = outlines_;
  o.bodies.push_back(body);
  const size_t n = o.x.size();
  for (std::vector<double>* v : {&o.mx, &o.my, &o.tx, &o.ty, &o.length, &o.depth}) v->resize(n);
  o.clearance.insert(o.clearance.end(), o.cap.begin() + body.first, o.cap.end());
  slope_.resize(n, stiffness_ / body.reference);
  body_stiffness_.resize(o.bodies.size());
  fx_.resize(n), fy_.resize(n);
  ends_.resize(2 * n);
  events_.resize(n), areas_.resize(n);
  kept_.clear();  // search anew
}

void DeformableContact::update(std::span<const double> displacement,
                               std::span<const double> position) {
  place(displacement, position);
  find_edges();
  find_depths();
  if (stale()) search();
}

void DeformableContact::place(std::span<const double> displacement,
                              std::span<const double> position) {
  Outlines& o = outlines_;
  double all = 0;
  for (Outlines::Body& body : o.bodies) {
    if (body.rigid()) {
      const double* q = position.data() + 3 * static_cast<size_t>(body.entry);
      const double c = std::cos(q[2]), s = std::sin(q[2]);
      body.cx = q[0], body.cy = q[1];
      for (int i = body.first; i < body.end; ++i) {
        o.x[i] = q[0] + (c * o.x0[i] - s * o.y0[i]);
        o.y[i] = q[1] + (s * o.x0[i] + c * o.y0[i]);
      }
    } else {
      for (int i = body.first; i < body.end; ++i) {
        const double* u = displacement.data() + 2 * static_cast<size_t>(o.node[i]);
        o.x[i] = o.x0[i] + u[0];
        o.y[i] = o.y0[i] + u[1];
      }
    }
    for (int i = body.first; i < body.end; ++i) all += 0 * o.x[i] + 0 * o.y[i];
  }
  if (all != 0) throw std::domain_error("a vertex of a body is not at a finite place");
}

void DeformableContact::find_edges() {
  Outlines& o = outlines_;
  const int n = o.size();
  for (int i = 0; i < n; ++i) {
    const double dx = o.x[o.next[i]] - o.x[i], dy = o.y[o.next[i]] - o.y[i];
    o.length[i] = std::sqrt(dx * dx + dy * dy);
    const double scale = 1 / o.length[i];
    o.tx[i] = dx * scale;
    o.ty[i] = dy * scale;
  }
  for (int i = 0; i < n; ++i) {
    const int p = o.previous[i];
    const Mitre<double> m(o.tx[p], o.ty[p], o.tx[i], o.ty[i]);
    o.mx[i] = m.x, o.my[i] = m.y;
  }
}

// An edge's face ends where it shrinks to a point or another front arrives, there or at a
// neighbour; the second neighbours count as well because events follow each other.
void DeformableContact::find_depths() {
  Outlines& o = outlines_;
  const int n = o.size();
  for (int i = 0; i < n; ++i) {
    const int j = o.next[i];
    const double alpha = o.mx[i] * o.tx[i] + o.my[i] * o.ty[i];
    const double beta = o.mx[j] * o.tx[i] + o.my[j] * o.ty[i];
    events_[i] = std::min(o.clearance[i], collar_event(o.length[i], alpha, beta));
  }
  for (int i = 0; i < n; ++i) {
    const int p = o.previous[i], q = o.next[i];
    o.depth[i] =
        std::min({events_[o.previous[p]], events_[p], events_[i], events_[q], events_[o.next[q]]});
  }
}

void DeformableContact::find_boxes() {
  const Outlines& o = outlines_;
  const int n = o.size();
  edge_boxes_.resize(n), face_boxes_.resize(n);
  for (int i = 0; i < n; ++i) {
    const int j = o.next[i];
    Box box;
    box.include(o.x[i], o.y[i]);
    box.include(o.x[j], o.y[j]);
    edge_boxes_[i] = box;
    const Corners c = corners(i);
    box.include(c[2], c[3]);
    box.include(c[4], c[5]);
    face_boxes_[i] = box;
  }
}

// Where the outline and the ends of the collar are.
DeformableContact::Corners DeformableContact::corners(int i) const {
  const Outlines& o = outlines_;
  const int j = o.next[i];
  const double h = o.depth[i];
  return {o.x[i],
          o.y[i],
          o.x[i] + h * o.mx[i],
          o.y[i] + h * o.my[i],
          o.x[j] + h * o.mx[j],
          o.y[j] + h * o.my[j]};
}

// A candidate list serves as long as no corner has moved through half the skin.
bool DeformableContact::stale() const {
  const int n = outlines_.size();
  if (static_cast<int>(kept_.size()) != n) return true;
  for (int i = 0; i < n; ++i) {
    const Corners now = corners(i);
    double moved = 0;
    for (size_t k = 0; k < now.size(); ++k) moved = std::max(moved, std::abs(now[k] - kept_[i][k]));
    if (!(moved <= skin_ / 2)) return true;
  }
  return false;
}

void DeformableContact::search() {
  const Outlines& o = outlines_;
  ++searches_;
  self_contact_.reset();
  find_boxes();
  const int bodies = static_cast<int>(o.bodies.size());
  for (int b = 0; b < bodies; ++b) {
    if (!o.bodies[b].rigid() || b >= measured_) find_clearance(b);
  }
  measured_ = bodies;
  find_depths();
  find_boxes();

  kept_.clear(), kept_edges_.clear(), kept_faces_.clear();
  body_boxes_.assign(bodies, {});
  for (int i = 0; i < o.size(); ++i) {
    kept_.push_back(corners(i));
    kept_edges_.push_back(edge_boxes_[i].grown(skin_ / 2));
    kept_faces_.push_back(face_boxes_[i].grown(skin_ / 2));
    include(body_boxes_[o.body[i]], kept_edges_[i]);
    include(body_boxes_[o.body[i]], kept_faces_[i]);
  }
  candidates_.clear();
  grid_.find_pairs(body_boxes_, pairs_);
  for (const auto& [a, b] : pairs_) {
    if (o.bodies[a].rigid() && o.bodies[b].rigid()) continue;
    find_candidates(a, b);
    find_candidates(b, a);
  }
  std::sort(candidates_.begin(), candidates_.end());
}

// Edges of a, faces of b: sweep along the longer side of the common region.
void DeformableContact::find_candidates(int a, int b) {
  const Outlines& o = outlines_;
  near_edges_.clear(), near_faces_.clear();
  Box common;
  for (int i = o.bodies[a].first; i < o.bodies[a].end; ++i) {
    if (apart(kept_edges_[i], body_boxes_[b])) continue;
    near_edges_.push_back(i);
    include(common, kept_edges_[i]);
  }
  for (int i = o.bodies[b].first; i < o.bodies[b].end; ++i) {
    if (!apart(kept_faces_[i], body_boxes_[a])) near_faces_.push_back(i);
  }
  const bool across = common.x1 - common.x0 >= common.y1 - common.y0;
  const auto low = [&](const Box& box) { return across ? box.x0 : box.y0; };
  const auto high = [&](const Box& box) { return across ? box.x1 : box.y1; };
  std::sort(near_faces_.begin(), near_faces_.end(), [&](int i, int j) {
    return std::pair(low(kept_faces_[i]), i) < std::pair(low(kept_faces_[j]), j);
  });
  double widest = 0;
  for (const int i : near_faces_) {
    widest = std::max(widest, high(kept_faces_[i]) - low(kept_faces_[i]));
  }
  for (const int e : near_edges_) {
    const Box& box = kept_edges_[e];
    auto it = std::lower_bound(near_faces_.begin(), near_faces_.end(), low(box) - widest,
                               [&](int i, double x) { return low(kept_faces_[i]) < x; });
    for (; it != near_faces_.end() && low(kept_faces_[*it]) <= high(box); ++it) {
      if (!apart(box, kept_faces_[*it])) candidates_.push_back({e, *it});
    }
  }
}

// The time at which the inward-moving front of an edge f meets a vertex v of the same body that
// moves along its bisector: h_f(v) / (1 - m_v . n_f), if v arrives within the front. Also finds
// edges that cross.
void DeformableContact::find_clearance(int b) {
  Outlines& o = outlines_;
  const Outlines::Body& body = o.bodies[b];
  // A vertex and a front come within the cap of each other from farther away than twice the cap,
  // the more so the sharper the reflex corner: here from three times the larger cap of the two, no
  // cap being smaller than r.
  std::vector<Box>& boxes = body_boxes_;
  boxes.clear();
  for (int i = body.first; i < body.end; ++i) {
    o.clearance[i] = o.cap[i];
    boxes.push_back(edge_boxes_[i].grown(3 * o.cap[i] - 1.5 * body.reference));
  }
  grid_.find_pairs(boxes, pairs_);
  const auto meet = [&](int v, int f) {  // vertex v, front f
    if (f == v || f == o.previous[v]) return;
    const double px = o.x[v] - o.x[f], py = o.y[v] - o.y[f];
    const double h = o.tx[f] * py - o.ty[f] * px;
    const double closing = 1 - (o.tx[f] * o.my[v] - o.ty[f] * o.mx[v]);
    if (!(h > 0) || !(closing > 0)) return;
    const double time = h / closing;
    if (time >= std::max({o.clearance[f], o.clearance[v], o.clearance[o.previous[v]]})) return;
    const CollarFace<double> face = o.face(f);
    const double tau =
        o.tx[f] * (px + time * o.mx[v]) + o.ty[f] * (py + time * o.my[v]) - face.length / 2;
    const double left = face.alpha() * time, right = face.beta() * time;
    if (tau < left - face.length || tau > right + face.length) return;
    for (const int k : {f, v, o.previous[v]}) o.clearance[k] = std::min(o.clearance[k], time);
  };
  const auto side = [&](int e, int v) {
    return o.tx[e] * (o.y[v] - o.y[e]) - o.ty[e] * (o.x[v] - o.x[e]);
  };
  for (auto [i, j] : pairs_) {
    i += body.first, j += body.first;
    const int in = o.next[i], jn = o.next[j];
    meet(i, j), meet(in, j), meet(j, i), meet(jn, i);
    if (i == jn || j == in || self_contact_) continue;
    const double p = side(i, j), q = side(i, jn);
    if (p * q < 0 && side(j, i) * side(j, in) < 0) {
      const double u = p / (p - q);
      self_contact_ = {b, {o.x[j] + u * (o.x[jn] - o.x[j]), o.y[j] + u * (o.y[jn] - o.y[j])}};
    }
  }
}

void DeformableContact::evaluate() {
  const Outlines& o = outlines_;
  contacts_.clear();
  depth_ = {};
  std::fill(ends_.begin(), ends_.end(), 0.);
  std::fill(areas_.begin(), areas_.end(), 0.);
  std::fill(body_stiffness_.begin(), body_stiffness_.end(), 0.);
  const int count = static_cast<int>(candidates_.size());
  const auto find_piece = [&](int c, CollarPiece<double>& piece) {
    const auto [e, f] = candidates_[c];
    const int q = o.next[e];
    return collar_piece(o.face(f), o.x[e], o.y[e], o.x[q], o.y[q], piece);
  };
  if (threads_ == 1 || count < kCandidatesWorthThreads) {
    CollarPiece<double> piece;
    for (int c = 0; c < count; ++c) {
      if (find_piece(c, piece)) add_contact(candidates_[c], piece);
    }
  } else {
    pieces_.resize(count), touching_.resize(count);
#pragma omp parallel for schedule(static) num_threads(threads_)
    for (int c = 0; c < count; ++c) touching_[c] = find_piece(c, pieces_[c]);
    for (int c = 0; c < count; ++c) {
      if (touching_[c]) add_contact(candidates_[c], pieces_[c]);
    }
  }
  // Where a body contains the end of a collar without its outline crossing it, Green's theorem has
  // taken the complement.
  for (const auto& [e, f, p] : contacts_) {
    if (depth_.ratio < 1 && areas_[f] < -kRound * o.length[f] * o.depth[f])
      note_depth(1, e, f, (p.from + p.to) / 2);
  }
  for (int i = 0; i < o.size(); ++i) {
    const int p = o.previous[i];
    const double own = ends_[2 * i], before = ends_[2 * p + 1];
    fx_[i] = -before * o.ty[p] - own * o.ty[i];
    fy_[i] = before * o.tx[p] + own * o.tx[i];
  }
}

// The edge gets the pressure against its outward normal, and the face gives way along its inward
// normal: both along the inward normals, on the two ends.
void DeformableContact::add_contact(const EdgeFacePair& pair, const CollarPiece<double>& p) {
  const Outlines& o = outlines_;
  const auto [e, f] = pair;
  const double k = slope_[f], on_edge = k * o.length[e];
  ends_[2 * e] += on_edge * (p.sum - p.first);
  ends_[2 * e + 1] += on_edge * p.first;
  const double b = k * p.along / o.length[f];
  ends_[2 * f] += k * p.area - b;
  ends_[2 * f + 1] += b;

  areas_[f] += p.area;
  if (!(p.deepest <= 0)) contacts_.emplace_back(e, f, p);
  const double stiffness = on_edge * (p.to - p.from);
  body_stiffness_[o.body[e]] += stiffness;
  body_stiffness_[o.body[f]] += stiffness;
  depth_.largest = std::max(depth_.largest, p.deepest);
  if (p.deepest < depth_.ratio * o.depth[f] && !p.beyond) return;
  const double ratio = p.beyond ? 1 : std::min(1., p.deepest / o.depth[f]);
  if (ratio > depth_.ratio) note_depth(ratio, e, f, (p.from + p.to) / 2);
}

void DeformableContact::note_depth(double ratio, int e, int f, double u) {
  const Outlines& o = outlines_;
  const int q = o.next[e];
  depth_.ratio = ratio;
  depth_.body = o.body[f];
  depth_.other = o.body[e];
  depth_.place = {o.x[e] + u * (o.x[q] - o.x[e]), o.y[e] + u * (o.y[q] - o.y[e])};
  depth_.limit = o.depth[f];
}

void DeformableContact::add_forces(std::span<double> node_force) const {
  const Outlines& o = outlines_;
  for (int i = 0; i < o.size(); ++i) {
    if (o.node[i] < 0) continue;
    node_force[2 * static_cast<size_t>(o.node[i])] += fx_[i];
    node_force[2 * static_cast<size_t>(o.node[i]) + 1] += fy_[i];
  }
}

DeformableContact::Resultant DeformableContact::resultant(int b) const {
  return resultant(b, fx_, fy_);
}

DeformableContact::Resultant DeformableContact::resultant(int b, std::span<const double> fx,
                                                          std::span<const double> fy) const {
  const Outlines& o = outlines_;
  const Outlines::Body& body = o.bodies[b];
  Resultant sum{Vec2::Zero(), 0};
  for (int i = body.first; i < body.end; ++i) {
    sum.force += Vec2(fx[i], fy[i]);
    sum.moment += (o.x[i] - body.cx) * fy[i] - (o.y[i] - body.cy) * fx[i];
  }
  return sum;
}

double DeformableContact::energy() const {
  double sum = 0;
  for (const EdgeFaceContact& c : contacts_) sum += slope(c) * c.piece.height;
  return sum;
}

DeformableContact::Rate DeformableContact::rate(std::span<const double> node_mass) const {
  const Outlines& o = outlines_;
  // The steepest potential among the others: of the first and second of all.
  double first = 0, second = 0;
  int steepest = -1;
  for (int b = 0; b < static_cast<int>(o.bodies.size()); ++b) {
    const double slope = 1 / o.bodies[b].reference;
    if (slope > first) {
      second = first, first = slope, steepest = b;
    } else {
      second = std::max(second, slope);
    }
  }
  Rate worst;
  for (int i = 0; i < o.size(); ++i) {
    const double mass = o.node[i] < 0 ? 0 : node_mass[o.node[i]];
    const int b = o.body[i];
    const double other = b == steepest ? second : first;
    if (!(mass > 0) || other == 0) continue;
    const double share = (o.length[i] + o.length[o.previous[i]]) / 2;
    const double value = 2 * stiffness_ * (1 / o.bodies[b].reference + other) * share / mass;
    if (value > worst.value) worst = {value, b};
  }
  return worst;
}

void DeformableContact::add_stiffness(std::span<double> node_stiffness) const {
  const Outlines& o = outlines_;
  std::vector<double> slope(o.size(), 0);  // of each vertex: 1/r_c + 1/r_t
  for (const EdgeFacePair& c : candidates_) {
    const double both =
        1 / o.bodies[o.body[c.edge]].reference + 1 / o.bodies[o.body[c.face]].reference;
    for (const int i : {c.edge, o.next[c.edge], c.face, o.next[c.face]}) {
      slope[i] = std::max(slope[i], both);
    }
  }
  for (int i = 0; i < o.size(); ++i) {
    if (o.node[i] < 0) continue;
    const double share = (o.length[i] + o.length[o.previous[i]]) / 2;
    node_stiffness[o.node[i]] += 2 * stiffness_ * slope[i] * share;
  }
}

void DeformableContact::pressures(std::vector<double>& pressure) const {
  const Outlines& o = outlines_;
  pressure.assign(o.size(), 0);
  for (const EdgeFaceContact& c : contacts_) {
    pressure[c.edge] += slope(c) / thickness_ * c.piece.sum;
    pressure[c.face] += slope(c) / thickness_ * c.piece.area / o.length[c.face];
  }
}

// The boundary of an overlap goes on in the next face or at a vertex, or crosses over to the other
// outline.
std::vector<int> DeformableContact::patches() const {
  const Outlines& o = outlines_;
  const auto before = [](const EdgeFaceContact& c, const std::pair<int, int>& key) {
    return std::pair(c.edge, c.face) < key;
  };
  const auto from = [&](int edge, int face) {
    return std::lower_bound(contacts_.begin(), contacts_.end(), std::pair(edge, face), before);
  };
  Groups groups(contacts_.size());
  std::vector<std::pair<int, int>> keys;
  for (int i = 0; i < static_cast<int>(contacts_.size()); ++i) {
    const EdgeFaceContact& c = contacts_[i];
    keys.push_back(std::minmax(o.body[c.edge], o.body[c.face]));
    const auto join = [&](auto other) {
      groups.join(i, static_cast<int>(other - contacts_.begin()));
    };
    const auto back = from(c.face, c.edge);
    if (back != contacts_.end() && back->edge == c.face && back->face == c.edge) join(back);
    const Outlines::Body& body = o.bodies[o.body[c.face]];
    const auto each = [&](int edge, auto&& goes_on) {
      for (auto it = from(edge, body.first);
           it != contacts_.end() && it->edge == edge && it->face < body.end; ++it) {
        if (goes_on(*it)) join(it);
      }
    };
    const bool to_end = c.piece.to >= 1;
    each(c.edge, [&](const EdgeFaceContact& d) {
      return (d.face == o.next[c.face] || d.face == o.previous[c.face]) &&
             d.piece.from <= c.piece.to && c.piece.from <= d.piece.to;
    });
    if (to_end) {
      each(o.next[c.edge], [](const EdgeFaceContact& d) { return d.piece.from <= 0; });
    }
  }
  return groups.numbers(keys);
}

std::vector<BodyContact> DeformableContact::body_contacts() const {
  const Outlines& o = outlines_;
  const std::vector<int> patch = patches();
  std::vector<BodyContact> result(
      patch.empty() ? 0 : *std::max_element(patch.begin(), patch.end()) + 1);
  std::vector<double> weights(result.size());
  for (size_t i = 0; i < contacts_.size(); ++i) {
    const EdgeFaceContact& c = contacts_[i];
    BodyContact& sum = result[patch[i]];
    const int own = o.body[c.edge];
    std::tie(sum.a, sum.b) = std::minmax(own, o.body[c.face]);
    const CollarPiece<double>& p = c.piece;
    const double force = slope(c) * p.sum * o.length[c.edge];
    const Vec2 inward(-o.ty[c.edge], o.tx[c.edge]);
    const double area = slope(c) * p.area;
    const Vec2 gives(-o.ty[c.face], o.tx[c.face]);
    // What the edge of a feels, or what the face of a gives.
    sum.force += own == sum.a ? Vec2(force * inward) : Vec2(area * gives);
    const int q = o.next[c.edge];
    const double u = p.sum > 0 ? p.first / p.sum : 0;
    sum.point += force * Vec2(o.x[c.edge] + u * (o.x[q] - o.x[c.edge]),
                              o.y[c.edge] + u * (o.y[q] - o.y[c.edge]));
    weights[patch[i]] += force;
    sum.penetration = std::max(sum.penetration, p.deepest);
  }
  for (size_t i = 0; i < result.size(); ++i) {
    if (weights[i] > 0) result[i].point /= weights[i];
  }
  return result;
}

}  // namespace apothem
