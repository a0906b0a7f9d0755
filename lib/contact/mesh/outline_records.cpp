#include "lib/contact/mesh/outline_records.hpp"

#include <algorithm>
#include <limits>
#include <map>

#include "geometry/spatial/groups.hpp"
#include "lib/contact/mesh/outline_depths.hpp"

namespace apothem {
namespace {

// The sums over a contact patch. Where a body touches itself, the side of the first edge is called
// a, and that of its face b.
struct PatchSum {
  ContactRecord record;
  double weight = 0, deepest = 0;
  double moment = 0;         // moment of the normal force on a about the origin, N m
  int edge = -1, face = -1;  // the first edge and its face

  /// Adds a force that acts on a.
  void add(const Vec2& point, const Vec2& force) {
    record.normal += force;
    moment += cross(point, force);
  }
  /// Adds the pressure on an edge at a point, with the given magnitude (N) and depth (m).
  void press(const Vec2& point, double size, double depth) {
    record.point += size * point;
    weight += size;
    deepest = std::max(deepest, depth);
  }
};

// The mean point of the pressure on the edges, moved across the force onto its line of action. If
// the forces nearly cancel, there is no line of action, and the result is the mean point.
Vec2 loading_point(const PatchSum& patch) {
  if (!(patch.weight > 0)) return patch.record.point;
  const Vec2 force = patch.record.normal;
  Vec2 mean = patch.record.point / patch.weight;
  const double squared = force.squaredNorm();
  if (!(squared > 1e-6 * patch.weight * patch.weight)) return mean;
  return mean + (patch.moment - cross(mean, force)) / squared * Vec2(force.y(), -force.x());
}

// Groups the contacts, and then the edges and faces of saturated regions, into patches. The
// boundary of an overlap continues in the next face, at a vertex, on the other outline where the
// two cross, or inside the saturated region.
class PatchGroups {
 public:
  explicit PatchGroups(const OutlineState& state)
      : o_(state.outlines()),
        contacts_(state.contacts),
        edges_(state.saturated.edges()),
        faces_(state.saturated.faces()),
        first_face_(contacts_.size() + edges_.size()),
        groups_(first_face_ + faces_.size()) {
    for (size_t i = 0; i < contacts_.size(); ++i) join_contact(i);
    join_saturated();
  }
  /// The patch number of each contact, then of each saturated edge and face. The numbers ascend
  /// with the pairs of bodies.
  std::vector<int> numbers() { return groups_.numbers(keys_); }

 private:
  [[nodiscard]] size_t from(int edge, int face) const {
    return static_cast<size_t>(
        std::lower_bound(contacts_.begin(), contacts_.end(), std::pair(edge, face),
                         [](const EdgeFaceContact& c, const std::pair<int, int>& key) {
                           return std::pair(c.edge, c.face) < key;
                         }) -
        contacts_.begin());
  }
  // Calls f(index) for the contacts of an edge with the faces of a body.
  template <class F>
  void each(int edge, BodyIndex body, const F& f) const {
    const OutlineSurfaces::Body& vertices = o_.bodies[body];
    for (size_t k = from(edge, vertices.first);
         k < contacts_.size() && contacts_[k].edge == edge && contacts_[k].face < vertices.end;
         ++k) {
      f(k);
    }
  }
  void join(size_t i, size_t k) { groups_.join(static_cast<int>(i), static_cast<int>(k)); }

  void join_contact(size_t i) {
    const EdgeFaceContact& c = contacts_[i];
    keys_.push_back(std::minmax(o_.body[c.edge], o_.body[c.face]));
    const size_t back = from(c.face, c.edge);
    if (back < contacts_.size() && contacts_[back].edge == c.face &&
        contacts_[back].face == c.edge) {
      join(i, back);
    }
    each(c.edge, o_.body[c.face], [&](size_t k) {
      const EdgeFaceContact& d = contacts_[k];
      if ((d.face == o_.next[c.face] || d.face == o_.previous[c.face]) &&
          d.piece.from <= c.piece.to && c.piece.from <= d.piece.to) {
        join(i, k);
      }
    });
    if (c.piece.to < 1) return;
    each(o_.next[c.edge], o_.body[c.face], [&](size_t k) {
      if (contacts_[k].piece.from <= 0) join(i, k);
    });
  }

  // Joins edges and faces of saturated regions by their numbers and by the body whose saturated
  // region they are in.
  void join_saturated() {
    std::map<std::pair<int, BodyIndex>, size_t> edge_at, face_at;
    for (size_t k = 0; k < edges_.size(); ++k) {
      const SaturatedEdge& saturated = edges_[k];
      keys_.push_back(std::minmax(o_.body[saturated.edge], saturated.body));
      const size_t i = edge_at[{saturated.edge, saturated.body}] = contacts_.size() + k;
      each(saturated.edge, saturated.body, [&](size_t contact) { join(i, contact); });
    }
    for (size_t k = 0; k < faces_.size(); ++k) {
      const SaturatedFace& saturated = faces_[k];
      keys_.push_back(std::minmax(o_.body[saturated.face], saturated.body));
      face_at[{saturated.face, saturated.body}] = first_face_ + k;
    }
    const auto join_at = [&](const auto& numbers, size_t i, int number, BodyIndex body) {
      if (const auto it = numbers.find({number, body}); it != numbers.end()) join(i, it->second);
    };
    for (size_t k = 0; k < edges_.size(); ++k) {
      const SaturatedEdge& saturated = edges_[k];
      join_at(edge_at, contacts_.size() + k, o_.next[saturated.edge], saturated.body);
      join_at(face_at, contacts_.size() + k, saturated.edge, saturated.body);
    }
    for (size_t k = 0; k < faces_.size(); ++k) {
      join_at(face_at, first_face_ + k, o_.next[faces_[k].face], faces_[k].body);
    }
    if (face_at.empty()) return;
    for (size_t i = 0; i < contacts_.size(); ++i) {
      join_at(face_at, i, contacts_[i].face, o_.body[contacts_[i].edge]);
    }
  }

  const OutlineSurfaces& o_;
  const std::vector<EdgeFaceContact>& contacts_;
  const std::vector<SaturatedEdge>& edges_;
  const std::vector<SaturatedFace>& faces_;
  size_t first_face_;
  Groups groups_;
  std::vector<std::pair<int, int>> keys_;
};

// The number of edges between two vertices of a closed line.
int steps_between(const OutlineSurfaces& outlines, int vertex, int other) {
  const std::vector<OutlineSurfaces::Loop>& loops = outlines.loops;
  const auto loop =
      std::prev(std::ranges::upper_bound(loops, vertex, {}, &OutlineSurfaces::Loop::first));
  if (other < loop->first || other >= loop->end) return std::numeric_limits<int>::max() / 2;
  const int steps = std::abs(vertex - other);
  return std::min(steps, loop->end - loop->first - steps);
}

// The point at the fraction u of an edge.
Vec2 point_of(const OutlineSurfaces& outlines, int edge, double u) {
  const Vec2 start = outlines.point(edge);
  return start + u * (outlines.point(outlines.next[edge]) - start);
}

bool is_a(const OutlineSurfaces& outlines, const PatchSum& patch, int edge) {
  if (patch.record.a != patch.record.b) return outlines.body[edge] == patch.record.a;
  return steps_between(outlines, edge, patch.edge) <= steps_between(outlines, edge, patch.face);
}

// Sums contacts into the patches.
class PatchSums {
 public:
  PatchSums(const OutlineState& state, int patches)
      : o_(state.outlines()),
        slopes_(state.slopes),
        depths_(o_),
        found_(static_cast<size_t>(patches)) {}

  void add(int patch, const EdgeFaceContact& contact) {
    const auto& [edge, face, slope, p, drag, push] = contact;
    PatchSum& sum = of(patch, o_.body[edge], o_.body[face], edge, face);
    const double force = slope * p.sum * o_.length[edge];
    const Vec2 on_edge = point_of(o_, edge, p.sum > 0 ? p.first / p.sum : 0);
    const bool own_is_a = is_a(o_, sum, edge);
    if (own_is_a) {
      sum.add(on_edge, force * inward(edge));
    } else {
      sum.add(point_of(o_, face, p.area > 0 ? p.along / (p.area * o_.length[face]) : 0),
              slope * p.area * inward(face));
    }
    sum.press(on_edge, force, p.deepest);
    sum.record.penetration = depths_.of_piece(edge, face, p, sum.record.penetration);
    sum.record.tangential += own_is_a ? drag : Vec2(-drag);
    sum.record.damping += own_is_a ? push : Vec2(-push);
  }

  void add(int patch, const SaturatedEdge& saturated) {
    PatchSum& sum = of(patch, o_.body[saturated.edge], saturated.body, saturated.edge, -1);
    const double depth = o_.bodies[saturated.body].depth;
    const double force = slopes_(saturated.body, o_.body[saturated.edge]) * depth * saturated.sum *
                         o_.length[saturated.edge];
    const Vec2 on_edge =
        point_of(o_, saturated.edge, saturated.sum > 0 ? saturated.first / saturated.sum : 0);
    if (is_a(o_, sum, saturated.edge)) sum.add(on_edge, force * inward(saturated.edge));
    sum.press(on_edge, force, depth);
    sum.record.penetration =
        depths_.of_edge(saturated.edge, saturated.body, sum.record.penetration);
  }

  void add(int patch, const SaturatedFace& saturated) {
    PatchSum& sum = found_[static_cast<size_t>(patch)];
    std::tie(sum.record.a, sum.record.b) = std::minmax(o_.body[saturated.face], saturated.body);
    if (!is_a(o_, sum, saturated.face)) return;
    const double area = saturated.moment.area;
    sum.add(point_of(o_, saturated.face,
                     area > 0 ? saturated.moment.along / (area * o_.length[saturated.face]) : 0),
            slopes_(o_.body[saturated.face], saturated.body) * area * inward(saturated.face));
  }

  void finish(std::vector<ContactRecord>& records) {
    for (PatchSum& sum : found_) {
      sum.record.point = loading_point(sum);
      const BodyIndex a = sum.record.a, b = sum.record.b;
      sum.record.phi = sum.deepest * std::max(o_.bodies[a].slope(), o_.bodies[b].slope());
      records.push_back(sum.record);
    }
  }

 private:
  PatchSum& of(int patch, BodyIndex body, BodyIndex other, int edge, int face) {
    PatchSum& sum = found_[static_cast<size_t>(patch)];
    std::tie(sum.record.a, sum.record.b) = std::minmax(body, other);
    if (sum.edge < 0) sum.edge = edge, sum.face = face;
    return sum;
  }
  [[nodiscard]] Vec2 inward(int edge) const { return {-o_.ty[edge], o_.tx[edge]}; }

  const OutlineSurfaces& o_;
  const OutlineSlopes& slopes_;
  OutlineDepths depths_;
  std::vector<PatchSum> found_;
};

}  // namespace

void add_patch_records(const OutlineState& state, std::vector<ContactRecord>& records) {
  const std::vector<int> patch = PatchGroups(state).numbers();
  PatchSums sums(state, patch.empty() ? 0 : *std::ranges::max_element(patch) + 1);
  auto next = patch.begin();
  for (const EdgeFaceContact& contact : state.contacts) sums.add(*next++, contact);
  for (const SaturatedEdge& saturated : state.saturated.edges()) sums.add(*next++, saturated);
  for (const SaturatedFace& saturated : state.saturated.faces()) sums.add(*next++, saturated);
  sums.finish(records);
}

void add_surface_records(const OutlineState& state, std::vector<SurfaceRecord>& records) {
  const OutlineSurfaces& o = state.outlines();
  const OutlineSlopes& slopes = state.slopes;
  const double thickness = slopes.thickness;
  const size_t first = records.size();
  for (int i = 0; i < o.size(); ++i) records.push_back({o.body[i], o.point(i), o.point(o.next[i])});
  SurfaceRecord* const record = records.data() + first;
  for (const auto& [edge, face, slope, piece, drag, push] : state.contacts) {
    record[edge].pressure += slope / thickness * piece.sum;
    record[face].pressure += slope / thickness * piece.area / o.length[face];
    for (const int k :
         {edge, face}) {  // force and tangent of the face are both opposite to the edge's
      record[k].traction -= drag.dot(Vec2(o.tx[face], o.ty[face])) / (o.length[k] * thickness);
    }
  }
  for (const SaturatedEdge& saturated : state.saturated.edges()) {
    const double slope = slopes(saturated.body, o.body[saturated.edge]);
    record[saturated.edge].pressure +=
        slope * o.bodies[saturated.body].depth / thickness * saturated.sum;
  }
  for (const SaturatedFace& saturated : state.saturated.faces()) {
    const double slope = slopes(o.body[saturated.face], saturated.body);
    record[saturated.face].pressure +=
        slope / thickness * saturated.moment.area / o.length[saturated.face];
  }
}

}  // namespace apothem
