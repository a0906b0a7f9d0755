#include "apothem/contact/outline_kernel.hpp"

#include <algorithm>
#include <cmath>

#include "apothem/contact/stiffness.hpp"
#include "apothem/geometry/spatial/groups.hpp"

namespace apothem {
namespace {

constexpr double kCandidateTime = 40;  // ns
constexpr double kRound = 1e-9;        // more than the round-off of an area, relative

// A bound of the distance from the boundary over the height in a face, which reaches beyond the end
// of its edge at a reflex vertex.
double depth_ratio(const CollarFace<double>& face) {
  const double beyond = std::max(-face.alpha(), face.beta());
  return beyond > 0 ? std::sqrt(1 + beyond * beyond) : 1;
}

}  // namespace

OutlineKernel::OutlineKernel(const Outlines& outlines, double stiffness, double thickness,
                             const FrictionTable& table, int threads)
    : outlines_(outlines),
      stiffness_(stiffness * thickness),
      thickness_(thickness),
      table_(table),
      threads_(threads),
      onset_(outlines, slope_) {
  const auto n = static_cast<size_t>(outlines.size());
  for (const Outlines::Body& body : outlines.bodies) {
    slope_.resize(static_cast<size_t>(body.end), stiffness_ / body.reference);
  }
  fx_.resize(n), fy_.resize(n), ends_.resize(2 * n), areas_.resize(n);
  if (table.rough()) friction_.emplace(outlines, table, slope_, thickness);
}

void OutlineKernel::take(std::span<const BoxPair> pairs) {
  candidates_.clear();
  for (const auto& [a, b] : pairs) {
    find_candidates(a, b);
    find_candidates(b, a);
  }
  std::sort(candidates_.begin(), candidates_.end());
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
      if (!apart(box, o.face_boxes[*it])) candidates_.push_back({e, *it});
    }
  }
}

void OutlineKernel::evaluate(std::vector<Contact>& contacts) {
  const Outlines& o = outlines_;
  const size_t first = contacts.size();
  contacts_.clear();
  std::fill(ends_.begin(), ends_.end(), 0.);
  std::fill(areas_.begin(), areas_.end(), 0.);
  const int count = static_cast<int>(candidates_.size());
  const auto find_piece = [&](int c, CollarPiece<double>& piece) {
    const auto [e, f] = candidates_[c];
    const int q = o.next[e];
    return collar_piece(o.face(f), o.x[e], o.y[e], o.x[q], o.y[q], piece);
  };
  if (!threads_.worth(count, kCandidateTime)) {
    CollarPiece<double> piece;
    for (int c = 0; c < count; ++c) {
      if (find_piece(c, piece)) add_contact(candidates_[c], piece, contacts);
    }
  } else {
    pieces_.resize(count), met_.resize(count);
    threads_.chunks(count, kCandidateTime, [&](int begin, int end, int) {
      for (int c = begin; c < end; ++c) met_[c] = find_piece(c, pieces_[c]);
    });
    for (int c = 0; c < count; ++c) {
      if (met_[c]) add_contact(candidates_[c], pieces_[c], contacts);
    }
  }
  find_complements(std::span(contacts).subspan(first));
  for (int i = 0; i < o.size(); ++i) {
    const int p = o.previous[i];
    const double own = ends_[2 * i], before = ends_[2 * p + 1];
    fx_[i] = -before * o.ty[p] - own * o.ty[i];
    fy_[i] = before * o.tx[p] + own * o.tx[i];
  }
}

void OutlineKernel::add_contact(const EdgeFace& pair, const CollarPiece<double>& p,
                                std::vector<Contact>& contacts) {
  const Outlines& o = outlines_;
  const auto [e, f] = pair;
  const EdgeFaceForces force = edge_face_forces(p, slope_[f], o.length[e], o.length[f]);
  ends_[2 * e] += force.edge_start;
  ends_[2 * e + 1] += force.edge_end;
  ends_[2 * f] += force.face_start;
  ends_[2 * f + 1] += force.face_end;

  areas_[f] += p.area;
  const double share = p.beyond ? 1 : std::min(1., p.deepest / o.depth[f]);
  if (!(p.deepest <= 0)) {
    contacts_.emplace_back(e, f, p);
    contacts.push_back({outline_kernel, e, f, p.deepest, p.deepest * depth_ratio(o.face(f)), share,
                        slope_[f] * o.length[e] * (p.to - p.from)});
  }
}

// Where a body contains the end of a collar without its outline crossing it, Green's theorem has
// taken the complement: such contacts are beyond the collar as well.
void OutlineKernel::find_complements(std::span<Contact> contacts) const {
  const Outlines& o = outlines_;
  for (Contact& c : contacts) {
    if (areas_[c.b] < -kRound * o.length[c.b] * o.depth[c.b]) c.share = 1;
  }
}

const EdgeFaceContact& OutlineKernel::edge_face(const Contact& c) const {
  return *std::lower_bound(contacts_.begin(), contacts_.end(), std::pair(c.a, c.b),
                           [](const EdgeFaceContact& k, const std::pair<int, int>& key) {
                             return std::pair(k.edge, k.face) < key;
                           });
}

void OutlineKernel::add_boundary(BodyIndex b, BoundaryDistance& boundary) const {
  const Outlines& o = outlines_;
  for (int i = o.bodies[b].first; i < o.bodies[b].end; ++i) {
    boundary.add(o.point(i), o.point(o.next[i]));
  }
}

double OutlineKernel::deepest_in(const EdgeFaceContact& c, double floor,
                                 BoundaryDistance& boundary) const {
  const Vec2 start = outlines_.point(c.edge);
  const Vec2 along = outlines_.point(outlines_.next[c.edge]) - start;
  return boundary.largest(start + c.piece.from * along, start + c.piece.to * along, floor);
}

double OutlineKernel::penetration(const Contact& c, double floor) {
  boundary_.clear();
  add_boundary(outlines_.body[c.b], boundary_);
  return deepest_in(edge_face(c), floor, boundary_);
}

ContactFault OutlineKernel::fault(const Contact& c) const {
  const Outlines& o = outlines_;
  const CollarPiece<double>& piece = edge_face(c).piece;
  const double u = (piece.from + piece.to) / 2;
  return {ContactFault::Kind::collar,
          o.body[c.a],
          o.body[c.b],
          o.point(c.a) + u * (o.point(o.next[c.a]) - o.point(c.a)),
          0,
          o.depth[c.b]};
}

double OutlineKernel::slide(const Kinematics& now, double dt, FrictionMemory& memory) {
  return friction_ ? friction_->slide(contacts_, now, dt, memory) : 0;
}

void OutlineKernel::add_forces(const ForceViews& forces) {
  const Outlines& o = outlines_;
  const auto add_to_nodes = [&](std::span<const double> fx, std::span<const double> fy) {
    for (int i = 0; i < o.size(); ++i) {
      if (o.node[i] < 0) continue;
      forces.nodes[2 * static_cast<size_t>(o.node[i])] += fx[i];
      forces.nodes[2 * static_cast<size_t>(o.node[i]) + 1] += fy[i];
    }
  };
  add_to_nodes(fx_, fy_);
  if (friction_) add_to_nodes(friction_->fx(), friction_->fy());
  for (BodyIndex b = 0; b < static_cast<BodyIndex>(o.bodies.size()); ++b) {
    if (!o.bodies[b].is_rigid()) continue;
    const Resultant on = resultant(b);
    double* f = &forces.rigid[3 * static_cast<size_t>(b)];
    f[0] += on.force.x();
    f[1] += on.force.y();
    f[2] += on.moment;
  }
}

Resultant OutlineKernel::sum(BodyIndex b, std::span<const double> fx,
                             std::span<const double> fy) const {
  const Outlines& o = outlines_;
  const Outlines::Body& body = o.bodies[b];
  Resultant sum;
  for (int i = body.first; i < body.end; ++i) {
    sum.force += Vec2(fx[i], fy[i]);
    sum.moment += (o.x[i] - body.cx) * fy[i] - (o.y[i] - body.cy) * fx[i];
  }
  return sum;
}

Resultant OutlineKernel::resultant(BodyIndex body) const {
  Resultant on = sum(body, fx_, fy_);
  if (!friction_) return on;
  const Resultant tangential = sum(body, friction_->fx(), friction_->fy());
  on.force += tangential.force;
  on.moment += tangential.moment;
  return on;
}

void OutlineKernel::add_force_sizes(std::span<double> of_bodies) const {
  for (const EdgeFaceContact& c : contacts_) {
    const double size = slope_[c.face] * c.piece.sum * outlines_.length[c.edge];
    of_bodies[outlines_.body[c.edge]] += size;
    of_bodies[outlines_.body[c.face]] += size;
  }
}

double OutlineKernel::energy() const {
  double sum = 0;
  for (const EdgeFaceContact& c : contacts_) sum += slope_[c.face] * c.piece.height;
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
  double worst = 0;
  for (int i = 0; i < o.size(); ++i) {
    const double mass = o.node[i] < 0 ? 0 : node_mass[o.node[i]];
    const BodyIndex b = o.body[i];
    const double other = b == steepest ? second : first;
    if (!(mass > 0) || other == 0) continue;
    worst = std::max(worst, node_rate(stiffness_, o.bodies[b].slope() + other, o.share(i), mass));
  }
  return worst;
}

void OutlineKernel::add_stiffness(std::span<double> nodes, std::span<double> rigid) const {
  const Outlines& o = outlines_;
  std::vector<double> slope(o.size(), 0);       // of each vertex: 1/r_c + 1/r_t
  std::vector<double> tangential(o.size(), 0);  // largest k_s thickness, N/m
  std::vector<std::pair<BodyIndex, int>> met;   // rigid bodies and vertices of meshes near them
  for (const EdgeFace& c : candidates_) {
    const BodyIndex own = o.body[c.edge], other = o.body[c.face];
    const double both = o.bodies[own].slope() + o.bodies[other].slope();
    const Friction& f = table_.between(own, other);
    const double spring = f.coefficient > 0 ? f.tangential_stiffness * thickness_ : 0;
    for (const int i : {c.edge, o.next[c.edge], c.face, o.next[c.face]}) {
      slope[i] = std::max(slope[i], both);
      tangential[i] = std::max(tangential[i], spring);
      const BodyIndex partner = o.body[i] == own ? other : own;
      if (o.bodies[partner].is_rigid() && o.node[i] >= 0) met.emplace_back(partner, i);
    }
  }
  // Springs pull along the contact, potentials push across it.
  const auto of_vertex = [&](int i) {
    return node_rate(stiffness_ + tangential[i], slope[i], o.share(i));
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

void OutlineKernel::add_surfaces(std::vector<SurfaceRecord>& records) const {
  const Outlines& o = outlines_;
  const size_t first = records.size();
  for (int i = 0; i < o.size(); ++i) records.push_back({o.body[i], o.point(i), o.point(o.next[i])});
  SurfaceRecord* const record = records.data() + first;
  for (size_t i = 0; i < contacts_.size(); ++i) {
    const auto& [edge, face, piece] = contacts_[i];
    record[edge].pressure += slope_[face] / thickness_ * piece.sum;
    record[face].pressure += slope_[face] / thickness_ * piece.area / o.length[face];
    if (!friction_) continue;
    for (const int k : {edge, face}) {  // the faces look the other way
      record[k].traction -= friction_->shares()[i] / (o.length[k] * thickness_);
    }
  }
}

// The boundary of an overlap goes on in the next face or at a vertex, or crosses over to the other
// outline.
std::vector<int> OutlineKernel::patches() const {
  const Outlines& o = outlines_;
  const auto from = [&](int edge, int face) {
    return std::lower_bound(contacts_.begin(), contacts_.end(), std::pair(edge, face),
                            [](const EdgeFaceContact& c, const std::pair<int, int>& key) {
                              return std::pair(c.edge, c.face) < key;
                            });
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

void OutlineKernel::add_records(const FrictionMemory& /*memory*/,
                                std::vector<ContactRecord>& records) const {
  const Outlines& o = outlines_;
  const std::vector<int> patch = patches();
  const int count = patch.empty() ? 0 : *std::max_element(patch.begin(), patch.end()) + 1;
  std::vector<ContactRecord> found(static_cast<size_t>(count));
  std::vector<double> weights(found.size()), deepest(found.size());
  std::vector<BoundaryDistance> boundaries(o.bodies.size());
  for (size_t i = 0; i < contacts_.size(); ++i) {
    const auto& [edge, face, p] = contacts_[i];
    ContactRecord& sum = found[static_cast<size_t>(patch[i])];
    const BodyIndex own = o.body[edge];
    BoundaryDistance& boundary = boundaries[static_cast<size_t>(o.body[face])];
    if (boundary.empty()) add_boundary(o.body[face], boundary);
    sum.penetration = deepest_in(contacts_[i], sum.penetration, boundary);
    std::tie(sum.a, sum.b) = std::minmax(own, o.body[face]);
    const double force = slope_[face] * p.sum * o.length[edge];
    const Vec2 inward(-o.ty[edge], o.tx[edge]);
    const double area = slope_[face] * p.area;
    const Vec2 gives(-o.ty[face], o.tx[face]);
    // What the edge of a feels, or what the face of a gives.
    sum.normal += own == sum.a ? Vec2(force * inward) : Vec2(area * gives);
    const double u = p.sum > 0 ? p.first / p.sum : 0;
    sum.point += force * (o.point(edge) + u * (o.point(o.next[edge]) - o.point(edge)));
    weights[static_cast<size_t>(patch[i])] += force;
    double& deep = deepest[static_cast<size_t>(patch[i])];
    deep = std::max(deep, p.deepest);
    if (friction_) {
      const double along = friction_->shares()[i];
      sum.tangential += (own == sum.a ? along : -along) * Vec2(o.tx[face], o.ty[face]);
    }
  }
  for (size_t i = 0; i < found.size(); ++i) {
    ContactRecord& sum = found[i];
    if (weights[i] > 0) sum.point /= weights[i];
    sum.phi = deepest[i] * std::max(o.bodies[sum.a].slope(), o.bodies[sum.b].slope());
  }
  records.insert(records.end(), found.begin(), found.end());
}

}  // namespace apothem
