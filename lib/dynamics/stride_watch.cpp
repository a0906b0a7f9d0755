#include "lib/dynamics/stride_watch.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/integrals/penetration.hpp"
#include "geometry/potential/inscribed_circle.hpp"
#include "lib/dynamics/time_step.hpp"
#include "lib/execution/dispatch.hpp"
#include "lib/execution/elementary.hpp"
#include "lib/mesh/boundary.hpp"

namespace apothem {
namespace {

constexpr double kStrideTime = 2;  // of a rigid body, ns
constexpr double kNodeTime = .3;   // of a coordinate, ns
constexpr size_t kFewFast = 8;     // bodies: all others are looked through for each of them

double larger(const Vec2& v) { return std::max(std::abs(v.x()), std::abs(v.y())); }

// True if the size of one of the numbers is larger than `limit`.
bool any_beyond(std::span<const double> numbers, double limit) {
  const double* const x = numbers.data();
  const size_t count = numbers.size();
  return with_widest([=](auto /*lanes*/) APOTHEM_LAMBDA {
           std::int64_t beyond = 0;
           for (size_t i = 0; i < count; ++i) beyond |= std::abs(x[i]) > limit;
           return static_cast<double>(beyond);
         }) > 0;
}

// True if a line from p to q has a point in the box.
bool crosses(const Box& box, const Vec2& p, const Vec2& q) {
  if (apart(box, box_of(p, q))) return false;
  const Vec2 half((box.x1 - box.x0) / 2, (box.y1 - box.y0) / 2);
  const Vec2 centre(box.x0 + half.x(), box.y0 + half.y()), along = q - p;
  return !(std::abs(cross(along, Vec2(centre - p))) >
           half.x() * std::abs(along.y()) + half.y() * std::abs(along.x()));
}

}  // namespace

// What a stride is short against: where contact knows the whole body, its inradius; of a mesh with
// potentials of its outermost elements, the depth of these.
StrideWatch::StrideWatch(const Model& model, std::span<const double> inradius, int threads)
    : model_(model),
      rigid_count_(static_cast<RigidIndex>(model.bodies.size())),
      middles_(inradius.size()),
      length_(inradius.begin(), inradius.end()),
      threads_(threads) {
  for (const RigidBody& body : model.bodies) {
    const std::array<double, 3> w = body.inverse_mass();
    responsive_.push_back(w[0] + w[1] + w[2] > 0);
  }
  for (const DeformableBody& body : model.deformables) {
    responsive_.push_back(1);
    Outline& outline = outlines_.emplace_back();
    const Boundary lines = boundary(body.mesh);
    if (model.contact.surface == ContactSurface::element) {
      length_[responsive_.size() - 1] = boundary_inradius(body.mesh, lines);
    }
    for (const BoundaryLoop& loop : lines.loops) {
      const auto first = static_cast<int>(outline.nodes.size());
      for (const int node : loop.nodes) {
        outline.nodes.push_back(body.first_node + node);
        outline.places.push_back(body.mesh.nodes[node]);
        outline.next.push_back(static_cast<int>(outline.nodes.size()));
      }
      outline.next.back() = first;
    }
  }
  shortest_ = *std::ranges::min_element(length_);
  strides_.resize(length_.size());
  is_fast_.resize(static_cast<size_t>(threads_.count()));
}

double StrideWatch::stride(const Step& step, BodyIndex body, const Vec2& frame) const {
  const State& state = step.state;
  if (is_rigid(body)) {
    const State::ConstTriple v = state.pose_rate(body);
    return step.dt *
           (larger(Vec2(v[0], v[1]) - frame) + std::abs(v[2]) * step.before.shapes().radius(body));
  }
  double most = 0;
  for (const NodeIndex node : outline(body).nodes) {
    most = std::max(most, larger(Vec2(state.node_velocity(node)) - frame));
  }
  return step.dt * most;
}

Vec2 StrideWatch::velocity(const Step& step, BodyIndex body) const {
  if (is_rigid(body)) return step.state.pose_rate(body).head<2>();
  Vec2 sum = Vec2::Zero();
  for (const NodeIndex node : outline(body).nodes) sum += step.state.node_velocity(node);
  return sum / static_cast<double>(outline(body).nodes.size());
}

// A box that holds all places of a body in the step, seen from a frame that begins at rest where it
// is and has some velocity.
Box StrideWatch::way(const Step& step, BodyIndex body, const Vec2& frame) const {
  const auto both = [&](Box& box, const Vec2& before, const Vec2& rate) {
    const Vec2 after = before + step.dt * (rate - frame);
    box.include(box_of(before, after));
  };
  Box all;
  if (is_rigid(body)) {
    const Box& box = step.before.shapes().boxes()[static_cast<size_t>(body)];
    const State::ConstTriple v = step.state.pose_rate(body);
    both(all, {box.x0, box.y0}, v.head<2>());
    both(all, {box.x1, box.y1}, v.head<2>());
    // No point turns farther than to the other side.
    const double radius = step.before.shapes().radius(body);
    return all.grown(std::min(step.dt * std::abs(v[2]), 2.) * radius);
  }
  const Outline& o = outline(body);
  for (size_t i = 0; i < o.nodes.size(); ++i) {
    const Vec2 rate = step.state.node_velocity(o.nodes[i]);
    both(all, o.places[i] + step.state.node(o.nodes[i]) - step.dt * rate, rate);
  }
  return all;
}

// True if the way of a body may touch an edge of another one, as this one sees it.
bool StrideWatch::meets(const Step& step, BodyIndex mover, BodyIndex target) const {
  const Vec2 frame = velocity(step, target);
  const Box box = way(step, mover, frame).grown(stride(step, target, frame));
  if (is_rigid(target)) {
    const PlacedPotential polygon = step.before.shapes().view(target);
    const Vec2 place = step.before.reference(target);
    for (int k = 0; k < polygon.size; ++k) {
      const int end = polygon.end(k);
      if (crosses(box, place + Vec2(polygon.x[k], polygon.y[k]),
                  place + Vec2(polygon.x[end], polygon.y[end]))) {
        return true;
      }
    }
    return false;
  }
  const Outline& o = outline(target);
  const auto before = [&](size_t i) -> Vec2 {
    return o.places[i] + step.state.node(o.nodes[i]) -
           step.dt * step.state.node_velocity(o.nodes[i]);
  };
  for (size_t i = 0; i < o.nodes.size(); ++i) {
    if (crosses(box, before(i), before(static_cast<size_t>(o.next[i])))) return true;
  }
  return false;
}

// Bodies that move together are no danger to each other.
void StrideWatch::judge(const Step& step, BodyIndex a, BodyIndex b,
                        std::optional<Fault>& worst) const {
  if (!responsive_[a] && !responsive_[b]) return;
  const double length = std::min(length_[a], length_[b]);
  const BodyIndex fast = strides_[a] >= strides_[b] ? a : b;
  const Vec2 frame = velocity(step, b);
  const double apart = stride(step, a, frame) + stride(step, b, frame);
  const double far = std::min(strides_[fast], apart);
  const double least = worst ? worst->stride / worst->length : kLargestStride;
  if (!(far > least * length)) return;
  if (meets(step, a, b) && meets(step, b, a)) worst = {fast, fast == a ? b : a, far, length};
}

bool StrideWatch::find_ways(const Step& step) {
  ways_.assign(length_.size(), {});
  for (size_t i = 0; i < ways_.size(); ++i) {
    const auto body = static_cast<BodyIndex>(i);
    if (step.state.is_absent(body)) continue;
    ways_[i] = way(step, body, Vec2::Zero());
    if (!std::isfinite(ways_[i].extent())) return false;
  }
  return true;
}

// True if no body moves by more than `least`, m. Of meshes the inner nodes count as well: they
// stand in line.
bool StrideWatch::are_all_slow(const Step& step, double least) {
  std::ranges::fill(is_fast_, 0);
  threads_.chunks(rigid_count_, kStrideTime, [&](int first, int end, int worker) {
    bool fast = false;
    for (RigidIndex i = first; i < end; ++i) fast |= stride(step, i, Vec2::Zero()) > least;
    is_fast_[static_cast<size_t>(worker)] |= fast;
  });
  const auto nodes = step.state.layout.of_nodes(step.state.v);
  threads_.chunks(static_cast<int>(nodes.size()), kNodeTime, [&](int first, int end, int worker) {
    is_fast_[static_cast<size_t>(worker)] |=
        any_beyond(nodes.subspan(static_cast<size_t>(first), static_cast<size_t>(end - first)),
                   least / step.dt);
  });
  return std::ranges::none_of(is_fast_, [](char fast) { return fast != 0; });
}

std::optional<StrideWatch::Fault> StrideWatch::look(const State& state, const Surfaces& before,
                                                    double dt) {
  const Step step{state, before, dt};
  const double least = kLargestStride * shortest_;
  if (are_all_slow(step, least)) return {};
  const auto bodies = static_cast<BodyIndex>(length_.size());
  fast_.clear();
  for (BodyIndex i = 0; i < bodies; ++i) {
    strides_[i] = state.is_absent(i) ? 0 : stride(step, i, Vec2::Zero());
    if (strides_[i] > least) fast_.push_back(i);
  }
  if (fast_.empty()) return {};
  if (!find_ways(step)) return {};  // this is found, and said, where surfaces are placed
  std::optional<Fault> worst;
  if (fast_.size() > kFewFast) {
    grid_.find_pairs(ways_, pairs_, threads_);
    for (const auto& [a, b] : pairs_) {
      if (std::max(strides_[a], strides_[b]) > least) judge(step, a, b, worst);
    }
    return worst;
  }
  for (const BodyIndex a : fast_) {
    for (BodyIndex b = 0; b < bodies; ++b) {
      if (b == a || (b < a && strides_[b] > least)) continue;  // they have been judged
      if (!apart(ways_[a], ways_[b])) judge(step, std::min(a, b), std::max(a, b), worst);
    }
  }
  return worst;
}

StrideWatch::Middle StrideWatch::middle_of(BodyIndex body) const {
  if (is_rigid(body)) {
    const Polygon polygon(polygon_of_rings(model_.bodies[static_cast<size_t>(body)].rings()));
    return {polygon.origin() + largest_inscribed_circle(polygon).centres.front(), {}};
  }
  const DeformableBody& mesh_body = model_.deformables[static_cast<size_t>(body - rigid_count_)];
  const Mesh& mesh = mesh_body.mesh;
  const Outline& o = outline(body);
  BoundaryDistance distance;
  for (size_t i = 0; i < o.nodes.size(); ++i) {
    distance.add(o.places[i], o.places[static_cast<size_t>(o.next[i])]);
  }
  Middle farthest;
  double largest = 0;
  for (ElementIndex e = 0; e < mesh.element_count(); ++e) {
    Vec2 centre = Vec2::Zero();
    for (const int node : mesh.element(e)) centre += mesh.nodes[node];
    centre /= static_cast<double>(mesh.element(e).size());
    const double depth = distance.at(centre);
    if (!(depth > largest)) continue;
    largest = depth;
    farthest = {centre, {}};
    for (const int node : mesh.element(e)) farthest.nodes.push_back(mesh_body.first_node + node);
  }
  return farthest;
}

Vec2 StrideWatch::middle(const State& state, BodyIndex body) {
  std::optional<Middle>& known = middles_[static_cast<size_t>(body)];
  if (!known) known = middle_of(body);
  if (!is_rigid(body)) {
    Vec2 moved = Vec2::Zero();
    for (const NodeIndex node : known->nodes) moved += state.node(node);
    return known->place + moved / static_cast<double>(known->nodes.size());
  }
  const State::ConstTriple x = state.pose(body);
  const SineCosine angle = sine_cosine(x[2]);
  const Vec2& p = known->place;
  return {x[0] + angle.cosine * p.x() - angle.sine * p.y(),
          x[1] + angle.sine * p.x() + angle.cosine * p.y()};
}

bool StrideWatch::contains(const State& state, const Surfaces& now, BodyIndex body,
                           const Vec2& point) const {
  bool inside = false;
  const auto pass = [&](const Vec2& p, const Vec2& q) {
    if ((p.y() > point.y()) == (q.y() > point.y())) return;
    const bool left = cross(Vec2(q - p), Vec2(point - p)) > 0;
    if (left == (q.y() > p.y())) inside = !inside;
  };
  if (is_rigid(body)) {
    const PlacedPotential polygon = now.shapes().view(body);
    const Vec2 place = now.reference(body);
    for (int k = 0; k < polygon.size; ++k) {
      const int end = polygon.end(k);
      pass(place + Vec2(polygon.x[k], polygon.y[k]), place + Vec2(polygon.x[end], polygon.y[end]));
    }
    return inside;
  }
  const Outline& o = outline(body);
  for (size_t i = 0; i < o.nodes.size(); ++i) {
    const auto next = static_cast<size_t>(o.next[i]);
    pass(o.places[i] + state.node(o.nodes[i]), o.places[next] + state.node(o.nodes[next]));
  }
  return inside;
}

bool StrideWatch::are_passing(const State& state, const Surfaces& now, BodyIndex a, BodyIndex b) {
  return contains(state, now, a, middle(state, b)) || contains(state, now, b, middle(state, a));
}

}  // namespace apothem
