#include "apothem/contact/outline_kernel.hpp"

#include <algorithm>
#include <cmath>

#include "apothem/contact/stiffness.hpp"
#include "apothem/geometry/spatial/groups.hpp"

namespace apothem {
namespace {

constexpr double kCandidateTime = 40;  // ns
constexpr double kInsideTop = 2;       // share of a contact that is not with a face
constexpr double kSurelyDepth = .5;    // of a collar: up to here h is a depth, unless the body is
                                       // squeezed to less than the collar

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
      threads_(threads),
      plateaus_(outlines),
      onset_(outlines, slope_) {
  const auto n = static_cast<size_t>(outlines.size());
  for (const Outlines::Body& body : outlines.bodies) {
    slope_.resize(static_cast<size_t>(body.end), stiffness_ / body.reference);
  }
  fx_.resize(n), fy_.resize(n), ends_.resize(2 * n);
  if (table.rough()) friction_.emplace(outlines, table, slope_, thickness);
}

void OutlineKernel::take(std::span<const BoxPair> pairs) {
  candidates_.clear();
  for (const auto& [a, b] : pairs) {
    find_candidates(a, b);
    find_candidates(b, a);
  }
  std::sort(candidates_.begin(), candidates_.end());
  plateaus_.take(pairs);
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
  contacts_.clear();
  std::fill(ends_.begin(), ends_.end(), 0.);
  plateaus_.begin();
  const int count = static_cast<int>(candidates_.size());
  const auto find = [&](int c, Met& found) {
    const auto [e, f] = candidates_[c];
    const int q = o.next[e];
    found.top.count = 0;
    found.met = collar_piece(o.face(f), o.x[e], o.y[e], o.x[q], o.y[q], found.piece, found.top);
  };
  const auto use = [&](int c, const Met& found) {
    if (!found.met) return;
    add_contact(candidates_[c], found.piece, contacts);
    plateaus_.add(candidates_[c], found.top);
  };
  if (!threads_.worth(count, kCandidateTime)) {
    Met found;
    for (int c = 0; c < count; ++c) find(c, found), use(c, found);
  } else {
    met_.resize(count);
    threads_.chunks(count, kCandidateTime, [&](int begin, int end, int) {
      for (int c = begin; c < end; ++c) find(c, met_[c]);
    });
    for (int c = 0; c < count; ++c) use(c, met_[c]);
  }
  add_plateaus(contacts);
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

  if (!(p.deepest <= 0)) {
    const double surely = std::min(p.deepest, kSurelyDepth * o.depth[f]);
    contacts_.emplace_back(e, f, p);
    contacts.push_back({outline_kernel, e, f, surely, p.deepest * depth_ratio(o.face(f)),
                        std::min(1., p.deepest / o.depth[f]),
                        slope_[f] * o.length[e] * (p.to - p.from)});
  }
}

// An edge inside the top of a body is a contact with that body, and has the first face of its
// outline for it.
void OutlineKernel::add_plateaus(std::vector<Contact>& contacts) {
  const Outlines& o = outlines_;
  plateaus_.evaluate();
  for (const OutlinePlateaus::Edge& on : plateaus_.edges()) {
    const int f = o.bodies[on.in].first;
    const double force = slope_[f] * o.depth[f] * o.length[on.edge];
    ends_[2 * on.edge] += force * (on.sum - on.first);
    ends_[2 * on.edge + 1] += force * on.first;
    contacts.push_back({outline_kernel, on.edge, f, 0, HUGE_VAL, kInsideTop, 0});
  }
  for (const OutlinePlateaus::Face& on : plateaus_.faces()) {
    const double end = slope_[on.face] * on.moment.along / o.length[on.face];
    ends_[2 * on.face] += slope_[on.face] * on.moment.area - end;
    ends_[2 * on.face + 1] += end;
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

double OutlineKernel::deepest_in(int edge, double from, double to, double floor,
                                 BoundaryDistance& boundary) const {
  const Vec2 start = outlines_.point(edge);
  const Vec2 along = outlines_.point(outlines_.next[edge]) - start;
  return boundary.largest(start + from * along, start + to * along, floor);
}

double OutlineKernel::penetration(const Contact& c, double floor) {
  boundary_.clear();
  add_boundary(outlines_.body[c.b], boundary_);
  if (c.share <= 1) {
    const CollarPiece<double>& piece = edge_face(c).piece;
    return deepest_in(c.a, piece.from, piece.to, floor, boundary_);
  }
  double deepest = floor;
  for (const OutlinePlateaus::Edge& on : plateaus_.edges()) {
    if (on.edge != c.a || on.in != outlines_.body[c.b]) continue;
    deepest = deepest_in(on.edge, on.from, on.to, deepest, boundary_);
  }
  return deepest;
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

double OutlineKernel::energy() const {
  double sum = 0;
  for (const EdgeFaceContact& c : contacts_) sum += slope_[c.face] * c.piece.height;
  for (const OutlinePlateaus::Edge& on : plateaus_.edges()) {
    const int f = outlines_.bodies[on.in].first;
    sum += slope_[f] * outlines_.depth[f] * on.swept;
  }
  for (const OutlinePlateaus::Face& on : plateaus_.faces()) {
    sum += slope_[on.face] * (on.moment.height + outlines_.depth[on.face] * on.swept);
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

void OutlineKernel::add_node_stiffness(std::span<double> stiffness) const {
  const Outlines& o = outlines_;
  std::vector<double> slope(o.size(), 0);  // of each vertex: 1/r_c + 1/r_t
  for (const EdgeFace& c : candidates_) {
    const double both = o.bodies[o.body[c.edge]].slope() + o.bodies[o.body[c.face]].slope();
    for (const int i : {c.edge, o.next[c.edge], c.face, o.next[c.face]}) {
      slope[i] = std::max(slope[i], both);
    }
  }
  for (int i = 0; i < o.size(); ++i) {
    if (o.node[i] >= 0) stiffness[o.node[i]] += node_rate(stiffness_, slope[i], o.share(i));
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
  for (const OutlinePlateaus::Edge& on : plateaus_.edges()) {
    const int f = o.bodies[on.in].first;
    record[on.edge].pressure += slope_[f] * o.depth[f] / thickness_ * on.sum;
  }
  for (const OutlinePlateaus::Face& on : plateaus_.faces()) {
    record[on.face].pressure += slope_[on.face] / thickness_ * on.moment.area / o.length[on.face];
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

// Each edge and face inside a top belongs to the patch of a contact of its own, or else to that of
// the last one before it along the outline, or else to the first one of both bodies.
void OutlineKernel::add_plateau_records(std::span<const int> patch, std::vector<PatchSum>& found,
                                        std::vector<BoundaryDistance>& boundaries) const {
  const Outlines& o = outlines_;
  int last = -1;
  BodyIndex last_own = -1, last_in = -1;
  const auto patch_of = [&](int own, BodyIndex in, bool edge) {
    int first = -1;
    for (size_t i = 0; i < contacts_.size(); ++i) {
      const auto [e, f] = edge ? std::pair(contacts_[i].edge, contacts_[i].face)
                               : std::pair(contacts_[i].face, contacts_[i].edge);
      if (e == own && o.body[f] == in) return patch[i];
      if (first < 0 && std::minmax(o.body[e], o.body[f]) == std::minmax(o.body[own], in)) {
        first = patch[i];
      }
    }
    if (last >= 0 && last_own == o.body[own] && last_in == in) return last;
    if (first >= 0) return first;
    for (size_t i = 0; i < found.size(); ++i) {
      const ContactRecord& r = found[i].record;
      if (std::minmax(r.a, r.b) == std::minmax(o.body[own], in)) return static_cast<int>(i);
    }
    found.emplace_back();
    std::tie(found.back().record.a, found.back().record.b) = std::minmax(o.body[own], in);
    return static_cast<int>(found.size()) - 1;
  };
  const auto sum_of = [&](int own, BodyIndex in, bool edge) -> PatchSum& {
    last = patch_of(own, in, edge);
    last_own = o.body[own], last_in = in;
    return found[static_cast<size_t>(last)];
  };
  for (const OutlinePlateaus::Edge& on : plateaus_.edges()) {
    PatchSum& sum = sum_of(on.edge, on.in, true);
    const int f = o.bodies[on.in].first;
    const double force = slope_[f] * o.depth[f] * on.sum * o.length[on.edge];
    const Vec2 inward(-o.ty[on.edge], o.tx[on.edge]);
    if (o.body[on.edge] == sum.record.a) sum.record.normal += force * inward;
    const double u = on.sum > 0 ? on.first / on.sum : 0;
    const Vec2 start = o.point(on.edge);
    sum.record.point += force * (start + u * (o.point(o.next[on.edge]) - start));
    sum.weight += force;
    sum.deepest = std::max(sum.deepest, o.depth[f]);
    BoundaryDistance& boundary = boundaries[static_cast<size_t>(on.in)];
    if (boundary.empty()) add_boundary(on.in, boundary);
    sum.record.penetration = deepest_in(on.edge, on.from, on.to, sum.record.penetration, boundary);
  }
  last = -1;
  for (const OutlinePlateaus::Face& on : plateaus_.faces()) {
    PatchSum& sum = sum_of(on.face, on.in, false);
    if (o.body[on.face] != sum.record.a) continue;
    sum.record.normal += slope_[on.face] * on.moment.area * Vec2(-o.ty[on.face], o.tx[on.face]);
  }
}

void OutlineKernel::add_records(const FrictionMemory& /*memory*/,
                                std::vector<ContactRecord>& records) const {
  const Outlines& o = outlines_;
  const std::vector<int> patch = patches();
  const int count = patch.empty() ? 0 : *std::max_element(patch.begin(), patch.end()) + 1;
  std::vector<PatchSum> found(static_cast<size_t>(count));
  std::vector<BoundaryDistance> boundaries(o.bodies.size());
  for (size_t i = 0; i < contacts_.size(); ++i) {
    const auto& [edge, face, p] = contacts_[i];
    PatchSum& of_patch = found[static_cast<size_t>(patch[i])];
    ContactRecord& sum = of_patch.record;
    const BodyIndex own = o.body[edge];
    BoundaryDistance& boundary = boundaries[static_cast<size_t>(o.body[face])];
    if (boundary.empty()) add_boundary(o.body[face], boundary);
    sum.penetration = deepest_in(edge, p.from, p.to, sum.penetration, boundary);
    std::tie(sum.a, sum.b) = std::minmax(own, o.body[face]);
    const double force = slope_[face] * p.sum * o.length[edge];
    const Vec2 inward(-o.ty[edge], o.tx[edge]);
    const double area = slope_[face] * p.area;
    const Vec2 gives(-o.ty[face], o.tx[face]);
    // What the edge of a feels, or what the face of a gives.
    sum.normal += own == sum.a ? Vec2(force * inward) : Vec2(area * gives);
    const double u = p.sum > 0 ? p.first / p.sum : 0;
    sum.point += force * (o.point(edge) + u * (o.point(o.next[edge]) - o.point(edge)));
    of_patch.weight += force;
    of_patch.deepest = std::max(of_patch.deepest, p.deepest);
    if (friction_) {
      const double along = friction_->shares()[i];
      sum.tangential += (own == sum.a ? along : -along) * Vec2(o.tx[face], o.ty[face]);
    }
  }
  add_plateau_records(patch, found, boundaries);
  std::ranges::stable_sort(
      found, {}, [](const PatchSum& sum) { return std::pair(sum.record.a, sum.record.b); });
  for (PatchSum& sum : found) {
    if (sum.weight > 0) sum.record.point /= sum.weight;
    const BodyIndex a = sum.record.a, b = sum.record.b;
    sum.record.phi = sum.deepest * std::max(o.bodies[a].slope(), o.bodies[b].slope());
    records.push_back(sum.record);
  }
}

}  // namespace apothem
