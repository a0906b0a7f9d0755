#include "lib/contact/mesh/outline_records.hpp"

#include <algorithm>
#include <limits>
#include <map>

#include "geometry/spatial/groups.hpp"
#include "lib/contact/mesh/outline_depths.hpp"

namespace apothem {
namespace {

// A contact patch while it is summed. Where a body touches itself, the side of the first edge is
// called a, and that of its face b.
struct PatchSum {
  ContactRecord record;
  double weight = 0, deepest = 0;
  double moment = 0;         // of the normal force on a, about the origin, N m
  int edge = -1, face = -1;  // first ones

  /// A force that acts on a.
  void add(const Vec2& point, const Vec2& force) {
    record.normal += force;
    moment += cross(point, force);
  }
};

// The mean of where edges are pushed, moved across the force until the force has the moment there
// that it has. Where forces nearly cancel there is no line of action, and the mean stays.
Vec2 loading_point(const PatchSum& patch) {
  if (!(patch.weight > 0)) return patch.record.point;
  const Vec2 force = patch.record.normal;
  Vec2 mean = patch.record.point / patch.weight;
  const double squared = force.squaredNorm();
  if (!(squared > 1e-6 * patch.weight * patch.weight)) return mean;
  return mean + (patch.moment - cross(mean, force)) / squared * Vec2(force.y(), -force.x());
}

// The boundary of an overlap goes on in the next face or at a vertex, or crosses over to the other
// outline, or goes on inside the top.
// The number of the patch of each contact, then of each edge and each face of the plateaus;
// ascending pairs of bodies.
std::vector<int> patches_of(const OutlineState& state) {
  const Outlines& o = state.outlines();
  const std::vector<EdgeFaceContact>& contacts = state.contacts;
  const auto from = [&](int edge, int face) {
    return std::lower_bound(contacts.begin(), contacts.end(), std::pair(edge, face),
                            [](const EdgeFaceContact& c, const std::pair<int, int>& key) {
                              return std::pair(c.edge, c.face) < key;
                            });
  };
  const std::vector<OutlinePlateaus::Edge>& edges = state.plateaus.edges();
  const std::vector<OutlinePlateaus::Face>& faces = state.plateaus.faces();
  const int first_edge = static_cast<int>(contacts.size());
  const int first_face = first_edge + static_cast<int>(edges.size());
  Groups groups(contacts.size() + edges.size() + faces.size());
  std::vector<std::pair<int, int>> keys;
  const auto each = [&](int edge, BodyIndex in, auto&& f) {
    const Outlines::Body& body = o.bodies[in];
    for (auto it = from(edge, body.first);
         it != contacts.end() && it->edge == edge && it->face < body.end; ++it) {
      f(static_cast<int>(it - contacts.begin()));
    }
  };
  for (int i = 0; i < first_edge; ++i) {
    const EdgeFaceContact& c = contacts[i];
    keys.push_back(std::minmax(o.body[c.edge], o.body[c.face]));
    const auto back = from(c.face, c.edge);
    if (back != contacts.end() && back->edge == c.face && back->face == c.edge) {
      groups.join(i, static_cast<int>(back - contacts.begin()));
    }
    each(c.edge, o.body[c.face], [&](int k) {
      const EdgeFaceContact& d = contacts[k];
      if ((d.face == o.next[c.face] || d.face == o.previous[c.face]) &&
          d.piece.from <= c.piece.to && c.piece.from <= d.piece.to) {
        groups.join(i, k);
      }
    });
    if (c.piece.to >= 1) {
      each(o.next[c.edge], o.body[c.face], [&](int k) {
        if (contacts[k].piece.from <= 0) groups.join(i, k);
      });
    }
  }
  // Inside tops: by the numbers of edges and faces, and the body they are in.
  std::map<std::pair<int, BodyIndex>, int> edge_at, face_at;
  for (int i = first_edge; i < first_face; ++i) {
    const OutlinePlateaus::Edge& on = edges[i - first_edge];
    keys.push_back(std::minmax(o.body[on.edge], on.in));
    edge_at[{on.edge, on.in}] = i;
    each(on.edge, on.in, [&](int k) { groups.join(i, k); });
  }
  for (size_t k = 0; k < faces.size(); ++k) {
    const OutlinePlateaus::Face& on = faces[k];
    keys.push_back(std::minmax(o.body[on.face], on.in));
    face_at[{on.face, on.in}] = first_face + static_cast<int>(k);
  }
  const auto join_at = [&](const auto& at, int i, int number, BodyIndex in) {
    if (const auto it = at.find({number, in}); it != at.end()) groups.join(i, it->second);
  };
  for (int i = first_edge; i < first_face; ++i) {
    const OutlinePlateaus::Edge& on = edges[i - first_edge];
    join_at(edge_at, i, o.next[on.edge], on.in);
    join_at(face_at, i, on.edge, on.in);
  }
  for (size_t k = 0; k < faces.size(); ++k) {
    join_at(face_at, first_face + static_cast<int>(k), o.next[faces[k].face], faces[k].in);
  }
  if (!face_at.empty()) {
    for (int i = 0; i < first_edge; ++i) {
      join_at(face_at, i, contacts[i].face, o.body[contacts[i].edge]);
    }
  }
  return groups.numbers(keys);
}

// How far apart two vertices of a closed line are, in edges.
int steps_between(const Outlines& outlines, int vertex, int other) {
  const std::vector<Outlines::Loop>& loops = outlines.loops;
  const auto loop = std::prev(std::ranges::upper_bound(loops, vertex, {}, &Outlines::Loop::first));
  if (other < loop->first || other >= loop->end) return std::numeric_limits<int>::max() / 2;
  const int steps = std::abs(vertex - other);
  return std::min(steps, loop->end - loop->first - steps);
}

// At the part u of an edge.
Vec2 point_of(const Outlines& outlines, int edge, double u) {
  const Vec2 start = outlines.point(edge);
  return start + u * (outlines.point(outlines.next[edge]) - start);
}

bool is_a(const Outlines& outlines, const PatchSum& patch, int edge) {
  if (patch.record.a != patch.record.b) return outlines.body[edge] == patch.record.a;
  return steps_between(outlines, edge, patch.edge) <= steps_between(outlines, edge, patch.face);
}

}  // namespace

void add_patch_records(const OutlineState& state, std::vector<ContactRecord>& records) {
  const Outlines& o = state.outlines();
  const OutlineSlopes& slopes = state.slopes;
  const std::vector<EdgeFaceContact>& contacts = state.contacts;
  const std::vector<int> patch = patches_of(state);
  OutlineDepths depths(o);
  const int count = patch.empty() ? 0 : *std::max_element(patch.begin(), patch.end()) + 1;
  std::vector<PatchSum> found(static_cast<size_t>(count));
  for (size_t i = 0; i < contacts.size(); ++i) {
    const auto& [edge, face, slope, p, drag, push] = contacts[i];
    PatchSum& of_patch = found[static_cast<size_t>(patch[i])];
    ContactRecord& sum = of_patch.record;
    std::tie(sum.a, sum.b) = std::minmax(o.body[edge], o.body[face]);
    if (of_patch.edge < 0) of_patch.edge = edge, of_patch.face = face;
    sum.penetration = depths.of_piece(edge, face, p, sum.penetration);
    const bool own_is_a = is_a(o, of_patch, edge);
    const double force = slope * p.sum * o.length[edge];
    const Vec2 inward(-o.ty[edge], o.tx[edge]);
    const double area = slope * p.area;
    const Vec2 gives(-o.ty[face], o.tx[face]);
    const Vec2 on_edge = point_of(o, edge, p.sum > 0 ? p.first / p.sum : 0);
    if (own_is_a) {
      of_patch.add(on_edge, force * inward);
    } else {
      of_patch.add(point_of(o, face, p.area > 0 ? p.along / (p.area * o.length[face]) : 0),
                   area * gives);
    }
    sum.point += force * on_edge;
    of_patch.weight += force;
    of_patch.deepest = std::max(of_patch.deepest, p.deepest);
    sum.tangential += own_is_a ? drag : Vec2(-drag);
    sum.damping += own_is_a ? push : Vec2(-push);
  }
  size_t next = contacts.size();
  for (const OutlinePlateaus::Edge& on : state.plateaus.edges()) {
    PatchSum& of_patch = found[static_cast<size_t>(patch[next++])];
    ContactRecord& sum = of_patch.record;
    std::tie(sum.a, sum.b) = std::minmax(o.body[on.edge], on.in);
    if (of_patch.edge < 0) of_patch.edge = on.edge;
    const double depth = o.bodies[on.in].depth;
    const double force = slopes(on.in, o.body[on.edge]) * depth * on.sum * o.length[on.edge];
    const Vec2 inward(-o.ty[on.edge], o.tx[on.edge]);
    const Vec2 on_edge = point_of(o, on.edge, on.sum > 0 ? on.first / on.sum : 0);
    if (is_a(o, of_patch, on.edge)) of_patch.add(on_edge, force * inward);
    sum.point += force * on_edge;
    of_patch.weight += force;
    of_patch.deepest = std::max(of_patch.deepest, depth);
    sum.penetration = depths.of_edge(on.edge, on.in, sum.penetration);
  }
  for (const OutlinePlateaus::Face& on : state.plateaus.faces()) {
    PatchSum& of_patch = found[static_cast<size_t>(patch[next++])];
    ContactRecord& sum = of_patch.record;
    std::tie(sum.a, sum.b) = std::minmax(o.body[on.face], on.in);
    if (!is_a(o, of_patch, on.face)) continue;
    const double area = on.moment.area;
    of_patch.add(point_of(o, on.face, area > 0 ? on.moment.along / (area * o.length[on.face]) : 0),
                 slopes(o.body[on.face], on.in) * area * Vec2(-o.ty[on.face], o.tx[on.face]));
  }
  for (PatchSum& sum : found) {
    sum.record.point = loading_point(sum);
    const BodyIndex a = sum.record.a, b = sum.record.b;
    sum.record.phi = sum.deepest * std::max(o.bodies[a].slope(), o.bodies[b].slope());
    records.push_back(sum.record);
  }
}

void add_surface_records(const OutlineState& state, std::vector<SurfaceRecord>& records) {
  const Outlines& o = state.outlines();
  const OutlineSlopes& slopes = state.slopes;
  const double thickness = slopes.thickness;
  const size_t first = records.size();
  for (int i = 0; i < o.size(); ++i) records.push_back({o.body[i], o.point(i), o.point(o.next[i])});
  SurfaceRecord* const record = records.data() + first;
  for (const auto& [edge, face, slope, piece, drag, push] : state.contacts) {
    record[edge].pressure += slope / thickness * piece.sum;
    record[face].pressure += slope / thickness * piece.area / o.length[face];
    for (const int k : {edge, face}) {  // the faces look the other way
      record[k].traction -= drag.dot(Vec2(o.tx[face], o.ty[face])) / (o.length[k] * thickness);
    }
  }
  for (const OutlinePlateaus::Edge& on : state.plateaus.edges()) {
    const double slope = slopes(on.in, o.body[on.edge]);
    record[on.edge].pressure += slope * o.bodies[on.in].depth / thickness * on.sum;
  }
  for (const OutlinePlateaus::Face& on : state.plateaus.faces()) {
    const double slope = slopes(o.body[on.face], on.in);
    record[on.face].pressure += slope / thickness * on.moment.area / o.length[on.face];
  }
}

}  // namespace apothem
