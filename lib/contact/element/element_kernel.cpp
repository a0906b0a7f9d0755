#include "lib/contact/element/element_kernel.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/spatial/groups.hpp"
#include "lib/contact/law/coulomb_spring.hpp"
#include "lib/contact/law/stiffness.hpp"
#include "lib/mesh/locate.hpp"

namespace apothem {

ElementKernel::ElementKernel(const Surfaces& surfaces, const ContactLaw& law,
                             const PairTable& table, double thickness, int threads)
    : surfaces_(surfaces),
      table_(table),
      thickness_(thickness),
      distribution_(law.distribution),
      pairs_(surfaces, threads) {
  tangential_.clear(static_cast<size_t>(surfaces.body_count()));
}

void ElementKernel::set_pairs(std::span<const BoxPair> pairs) { pairs_.set_pairs(pairs); }

std::span<const NodeIndex> ElementKernel::nodes(SurfaceIndex i) const {
  if (surfaces_.is_rigid(i)) return {};
  return surfaces_.elements().nodes(i - surfaces_.rigid_count());
}

bool ElementKernel::convex(SurfaceIndex i) const {
  return surfaces_.is_rigid(i) || surfaces_.elements().convex(i - surfaces_.rigid_count());
}

void ElementKernel::evaluate() {
  pairs_.evaluate([](const PairInTouch&, const PairIntegral&, int) {});
  normal_.clear(static_cast<size_t>(surfaces_.body_count()));
  contacts_.clear();
  touches_.clear();
  largest_force_ = {};
  for (const PairInTouch& pair : pairs_.touching()) {
    const SurfaceIndex a = pair.a, b = pair.b;
    Contact& contact =
        contacts_.emplace_back(pairs_.contact(KernelKind::element_kernel, pair, stiffness(a, b)));
    // The potential measures the depth below borders of the element that are not part of the body's
    // boundary, so it gives no bounds of the penetration.
    contact.depth = 0, contact.at_most = HUGE_VAL;
    if (!convex(a) || !convex(b) || pairs_.too_deep(pair, pairs_.integral(pair))) {
      // The following pairs are not evaluated, as the state is out of range.
      contact.relative_depth = 1;
      return;
    }
    add_touch(pair);
    Touch& touch = touches_.back();
    touch.stiffness = contact.stiffness * std::min(touch.force.norm() / touch.pressure, 1.);
  }
  find_largest_force();
}

ContactSummary ElementKernel::summary() const {
  ContactSummary summary{.count = static_cast<int>(contacts_.size())};
  for (const Contact& contact : contacts_) {
    summary.deepest = HUGE_VAL;
    if (!(contact.relative_depth < 1)) summary.relative_depth = 1;  // a NaN counts as out of range
  }
  return summary;
}

void ElementKernel::visit_contacts(double /*least*/, const ContactVisitor& visit) const {
  for (const Contact& contact : contacts_) visit(contact);
}

void ElementKernel::find_largest_force() {
  body_touches_.clear();
  for (int i = 0; i < static_cast<int>(touches_.size()); ++i) {
    body_touches_.push_back({surfaces_.body(touches_[i].a), surfaces_.body(touches_[i].b), i});
  }
  std::ranges::sort(body_touches_);
  Vec2 force = Vec2::Zero();
  for (size_t i = 0; i < body_touches_.size(); ++i) {
    const auto& [a, b, touch] = body_touches_[i];
    force += touches_[touch].force;
    if (i + 1 < body_touches_.size() && body_touches_[i + 1].a == a && body_touches_[i + 1].b == b)
      continue;
    const double size = hypotenuse(force.x(), force.y());
    if (size > largest_force_.value) largest_force_ = {size, a, b};
    force = Vec2::Zero();
  }
}

double ElementKernel::penetration(const Contact& c, double floor) {
  return convex(c.a) && convex(c.b) ? find_penetration(c.a, c.b, floor, depths_) : floor;
}

// True if an edge of a polygon or element is on the boundary of the body.
bool ElementKernel::outer(SurfaceIndex i, int edge) const {
  return surfaces_.is_rigid(i) || surfaces_.elements().outer(i - surfaces_.rigid_count(), edge);
}

// Calls f(from, to) for the edges of a polygon or element that are on the boundary of the body.
template <class F>
void ElementKernel::each_outer_edge(SurfaceIndex i, const F& f) const {
  const PlacedPotential view = surfaces_.shapes().view(i);
  const Vec2 place = surfaces_.reference(i);
  for (int k = 0; k < view.size; ++k) {
    if (!outer(i, k)) continue;
    const int end = view.end(k);
    f(place + Vec2(view.x[k], view.y[k]), place + Vec2(view.x[end], view.y[end]));
  }
}

// Finds the largest distance of the boundary edges of each body, inside the other polygon, from the
// whole boundary of the other body. The polygon's own edges of that boundary usually decide.
double ElementKernel::find_penetration(SurfaceIndex a, SurfaceIndex b, double floor,
                                       Depths& work) const {
  const PlacedShapes& shapes = surfaces_.shapes();
  contact_patches(shapes.view(a), shapes.view(b), surfaces_.between(a, b), work.workspace,
                  work.segments, work.patches);
  const Vec2 place = surfaces_.reference(a);
  const auto deepest = [&](bool of_a) {
    double most = floor;
    for (const BoundarySegment& segment : work.segments) {
      if (segment.of_a != of_a || !outer(of_a ? a : b, segment.edge)) continue;
      most = work.boundary.largest(place + segment.start, place + segment.end, most);
    }
    return most;
  };
  const auto add_boundary = [&](SurfaceIndex i) {
    each_outer_edge(i, [&](const Vec2& from, const Vec2& to) { work.boundary.add(from, to); });
  };
  double most = floor;
  for (const bool of_a : {true, false}) {
    const SurfaceIndex other = of_a ? b : a;
    work.boundary.clear();
    add_boundary(other);
    if (surfaces_.is_rigid(other)) {
      most = std::max(most, deepest(of_a));
      continue;
    }
    if (!work.boundary.empty() && !(deepest(of_a) > floor)) continue;
    work.boundary.clear();
    for (SurfaceIndex i = surfaces_.rigid_count(); i < surfaces_.size(); ++i) {
      if (surfaces_.body(i) == surfaces_.body(other)) add_boundary(i);
    }
    most = std::max(most, deepest(of_a));
  }
  return most;
}

ContactFault ElementKernel::fault(const Contact& c) const {
  const bool bent = !convex(c.a) || !convex(c.b);
  const SurfaceIndex place = convex(c.a) && !surfaces_.is_rigid(c.b) ? c.b : c.a;
  return {bent ? ContactFault::Kind::not_convex : ContactFault::Kind::element, surfaces_.body(c.a),
          surfaces_.body(c.b), surfaces_.reference(place)};
}

void ElementKernel::add_touch(const PairInTouch& result) {
  const PairIntegral& pair = pairs_.integral(result);
  const SurfaceIndex a = result.a, b = result.b;
  const double k = stiffness(a, b);
  const Vec2 force = k * pair.force;
  Resultant& on_a = normal_.sums[surfaces_.body(a)];
  Resultant& on_b = normal_.sums[surfaces_.body(b)];
  on_a.force += force;
  on_b.force -= force;
  if (surfaces_.is_rigid(a)) on_a.moment += k * pair.moment_a;
  if (surfaces_.is_rigid(b)) on_b.moment += k * pair.moment_b;
  const Vec2 offset = surfaces_.between(a, b);
  const Vec2 point = loading_point(pair);
  touches_.push_back({a, b, force, point, offset, k * pair.weight, pair.depth});
  const auto add = [&](SurfaceIndex i, const Vec2& f, const Vec2& place) {
    find_corners(i, place, of_a_);
    distribute(of_a_, f, normal_);
  };
  if (distribution_ == ForceDistribution::resultant) {
    add(a, force, point);
    add(b, -force, point + offset);
    return;
  }
  const PlacedShapes& shapes = surfaces_.shapes();
  contact_patches(shapes.view(a), shapes.view(b), offset, workspace_, segments_, patches_);
  for (const BoundarySegment& segment : segments_) {
    add(a, k * segment.force, segment.centre);
    add(b, -k * segment.force, segment.centre + offset);
  }
}

// Finds the interpolation weights of the corners at `point`, which is relative to the reference
// point. Rigid bodies have no nodes.
void ElementKernel::find_corners(SurfaceIndex i, const Vec2& point, Corners& corners) const {
  corners.nodes = nodes(i);
  const size_t count = corners.nodes.size();
  if (count == 0) return;
  const PlacedPotential view = surfaces_.shapes().view(i);
  corners.ring.resize(count), corners.weights.resize(count);
  for (size_t k = 0; k < count; ++k) corners.ring[k] = Vec2(view.x[k], view.y[k]) - point;
  interpolation_weights(corners.ring, corners.weights);
}

void ElementKernel::distribute(const Corners& corners, const Vec2& force, Forces& sum) {
  for (size_t k = 0; k < corners.nodes.size(); ++k) {
    sum.nodes.push_back({corners.nodes[k], corners.weights[k] * force});
  }
}

// The velocity of the material at a point.
Vec2 ElementKernel::velocity_at(SurfaceIndex i, const Vec2& point, const Corners& corners,
                                const Kinematics& now) const {
  if (surfaces_.is_rigid(i)) {
    const double* v = &now.pose_rate[3 * static_cast<size_t>(i)];
    return Vec2(v[0], v[1]) + cross(v[2], point);
  }
  Vec2 sum = Vec2::Zero();
  for (size_t k = 0; k < corners.nodes.size(); ++k) {
    const double* v = &now.node_velocity[2 * static_cast<size_t>(corners.nodes[k])];
    sum += corners.weights[k] * Vec2(v[0], v[1]);
  }
  return sum;
}

double ElementKernel::update_friction(const Kinematics& now, double dt, FrictionMemory& memory) {
  if (!table_.rough()) return 0;
  const double power_before = power(tangential_, now);
  ContactWalk<const Spring> walk = memory.before(element_kernel);
  tangential_.clear(static_cast<size_t>(surfaces_.body_count()));
  for (Touch& t : touches_) {
    const PairLaw& law = table_.between(surfaces_.body(t.a), surfaces_.body(t.b));
    if (!law.rough() || !has_direction(t)) continue;
    const Vec2 tangent = tangent_of(t.force), point_b = t.point + t.offset;
    find_corners(t.a, t.point, of_a_);
    find_corners(t.b, point_b, of_b_);
    const Vec2 rate = velocity_at(t.a, t.point, of_a_, now) - velocity_at(t.b, point_b, of_b_, now);
    const ContactKey key{element_kernel, t.a, t.b, 0};
    const std::span<const Spring> before = walk.find(key);
    const Spring old = before.empty() ? Spring() : before[0];
    const double constant = law.friction.tangential_stiffness * thickness_;
    t.spring_stiffness = constant > 0 ? constant : law.friction.stiffness_ratio * t.stiffness;
    const double pressed = t.force.norm() + old.push;
    const double slip = rate.dot(tangent);
    const CoulombSpring<double> spring{
        t.spring_stiffness,
        now.restored ? HUGE_VAL : FrictionLimit<double>::of(law)(pressed, slip)};
    const double kept = old.stiffness > 0 ? std::min(1., spring.stiffness / old.stiffness) : 0;
    t.spring = spring.after(kept * old.force, slip * dt);
    memory.keep({key, t.spring, spring.stiffness, tangent, old.push});
    t.friction = t.spring * tangent;
    const auto add_friction = [&](SurfaceIndex i, const Vec2& f, const Vec2& point,
                                  const Corners& corners) {
      Resultant& sum = tangential_.sums[surfaces_.body(i)];
      sum.force += f;
      if (surfaces_.is_rigid(i)) sum.moment += cross(point, f);
      distribute(corners, f, tangential_);
    };
    add_friction(t.a, t.friction, t.point, of_a_);
    add_friction(t.b, -t.friction, point_b, of_b_);
  }
  return dt / 2 * (power_before + power(tangential_, now));
}

// Sums the touches between each two bodies.
void ElementKernel::find_damped_pairs() {
  damped_pairs_.clear();
  pair_of_.resize(touches_.size());
  std::pair<BodyIndex, BodyIndex> last(-1, -1);
  for (const BodyTouch& body_touch : body_touches_) {
    if (const std::pair bodies(body_touch.a, body_touch.b); bodies != last) {
      damped_pairs_.emplace_back();
      last = bodies;
    }
    DampedPair& pair = damped_pairs_.back();
    const Touch& t = touches_[static_cast<size_t>(body_touch.touch)];
    pair_of_[static_cast<size_t>(body_touch.touch)] = damped_pairs_.size() - 1;
    pair.resistance += t.stiffness, pair.stiffness += t.spring_stiffness;
    pair.force += t.force;
    pair.sizes += t.force.norm();
    pair.places += t.force.norm() * (surfaces_.reference(t.a) + t.point);
  }
}

// The ratio of critical damping refers to the two bodies as rigid ones, with the stiffness of all
// touches between them.
void ElementKernel::add_dashpots(const Kinematics& now, Dashpots& dashpots) {
  find_damped_pairs();
  for (const Touch& t : touches_) {
    const BodyIndex body_a = surfaces_.body(t.a), body_b = surfaces_.body(t.b);
    const PairLaw& law = table_.between(body_a, body_b);
    if (!law.damped() || !has_direction(t) || !(t.stiffness > 0)) continue;
    const DampedPair& pair = damped_pairs_[pair_of_[static_cast<size_t>(&t - touches_.data())]];
    const double all = pair.force.norm(), size = t.force.norm();
    const Vec2 direction = all > 0 ? Vec2(pair.force / all) : Vec2(t.force / size);
    const Vec2 place = pair.places / pair.sizes;
    const auto time = [&](double value, double k, const Vec2& along) {
      return dashpot_time(value, law.damping.are_times, k,
                          surfaces_.mobility(body_a, now, place, along) +
                              surfaces_.mobility(body_b, now, place, along));
    };
    const Vec2 normal = t.force / size, across(-normal.y(), normal.x());
    dashpots.add(
        {body_a,
         body_b,
         normal,
         {Dashpot::Normal::of(t.stiffness * time(law.damping.normal, pair.resistance, direction),
                              size, t.stiffness, t.depth)},
         t.spring_stiffness *
             time(law.damping.tangential, pair.stiffness, Vec2(-direction.y(), direction.x())),
         t.spring,
         FrictionLimit<double>::of(law)});
    const auto add_side = [&](SurfaceIndex i, const Vec2& point, double sign) {
      if (surfaces_.is_rigid(i)) return dashpots.add_point(i, point, sign * normal, sign * across);
      find_corners(i, point, of_a_);
      for (size_t k = 0; k < of_a_.nodes.size(); ++k) {
        const double weight = sign * of_a_.weights[k];
        dashpots.add_node(of_a_.nodes[k], weight * normal, weight * across);
      }
    };
    add_side(t.a, t.point, 1);
    add_side(t.b, t.point + t.offset, -1);
  }
}

void ElementKernel::keep_pushes(const Dashpots& dashpots, size_t& next, FrictionMemory& memory) {
  auto spring = memory.springs_of(element_kernel).begin();
  for (Touch& t : touches_) {
    const PairLaw& law = table_.between(surfaces_.body(t.a), surfaces_.body(t.b));
    if (!law.damped() || !has_direction(t) || !(t.stiffness > 0)) continue;
    const Vec2 normal = t.force / t.force.norm();
    t.push = dashpots.normal_force(next) * normal;
    t.drag = dashpots.tangential_force(next) * Vec2(-normal.y(), normal.x());
    if (law.rough()) {
      while (std::pair(spring->key.a, spring->key.b) < std::pair(t.a, t.b)) ++spring;
      spring->push = dashpots.normal_force(next);
    }
    ++next;
  }
}

// The power of forces on the bodies, W.
double ElementKernel::power(const Forces& forces, const Kinematics& now) const {
  double sum = 0;
  for (const auto& [node, force] : forces.nodes) {
    const double* v = &now.node_velocity[2 * static_cast<size_t>(node)];
    sum += force.x() * v[0] + force.y() * v[1];
  }
  for (RigidIndex i = 0; i < surfaces_.rigid_count(); ++i) {
    const double* v = &now.pose_rate[3 * static_cast<size_t>(i)];
    const Resultant& resultant = forces.sums[i];
    sum += resultant.force.x() * v[0] + resultant.force.y() * v[1] + resultant.moment * v[2];
  }
  return sum;
}

void ElementKernel::add_forces(const ForceViews& forces) {
  for (const Forces* part : {&normal_, &tangential_}) {
    for (const auto& [node, force] : part->nodes) {
      forces.nodes[2 * static_cast<size_t>(node)] += force.x();
      forces.nodes[2 * static_cast<size_t>(node) + 1] += force.y();
    }
  }
  for (RigidIndex i = 0; i < surfaces_.rigid_count(); ++i) {
    double* f = &forces.rigid[3 * static_cast<size_t>(i)];
    for (const Forces* part : {&normal_, &tangential_}) {
      f[0] += part->sums[i].force.x();
      f[1] += part->sums[i].force.y();
      f[2] += part->sums[i].moment;
    }
  }
}

double ElementKernel::rate(std::span<const double> node_mass) const {
  const auto bodies = static_cast<size_t>(surfaces_.body_count());
  const std::vector<double> slope = surfaces_.slopes();
  std::vector<double> other(bodies);  // steepest slope among the other bodies
  for (size_t a = 0; a < bodies; ++a) {
    for (size_t b = 0; b < bodies; ++b) {
      if (a != b) other[a] = std::max(other[a], slope[b]);
    }
  }
  double worst = 0;
  for (const auto& [node, body, length] : surfaces_.elements().tributary_lengths()) {
    const double mass = node_mass[node];
    if (!(mass > 0) || other[body] == 0) continue;
    worst = std::max(
        worst, node_rate(table_.stiffest() * thickness_, slope[body] + other[body], length, mass));
  }
  return worst;
}

// The force of a touch is assigned to the nearest boundary edge of its polygon.
void ElementKernel::add_surfaces(std::vector<SurfaceRecord>& records) const {
  const size_t begin = records.size();
  std::vector<size_t> first;  // first record of each surface
  for (SurfaceIndex i = 0; i < surfaces_.size(); ++i) {
    first.push_back(records.size());
    each_outer_edge(i, [&](const Vec2& from, const Vec2& to) {
      records.push_back({surfaces_.body(i), from, to});
    });
  }
  first.push_back(records.size());
  if (records.size() == begin) return;
  const auto distance = [](const SurfaceRecord& e, const Vec2& p) {
    const Vec2 edge = e.to - e.from;
    const double along = std::clamp((p - e.from).dot(edge) / edge.squaredNorm(), 0., 1.);
    return (e.from + along * edge - p).norm();
  };
  const auto add = [&](SurfaceIndex i, const Vec2& point, const Vec2& force, const Vec2& friction) {
    const Vec2 place = surfaces_.reference(i) + point;
    SurfaceRecord* nearest = &records[first[i]];
    for (size_t r = first[i]; r < first[i + 1]; ++r) {
      if (distance(records[r], place) < distance(*nearest, place)) nearest = &records[r];
    }
    const Vec2 edge = nearest->to - nearest->from;
    const double area = edge.norm() * thickness_;
    nearest->pressure += cross(Vec2(edge / edge.norm()), force) / area;
    nearest->traction += friction.dot(edge) / edge.norm() / area;
  };
  for (const Touch& t : touches_) {
    add(t.a, t.point, t.force, t.friction);
    add(t.b, t.point + t.offset, -t.force, -t.friction);
  }
}

// Groups the touches into patches. Two touches belong together if on both sides the polygons are
// the same or share a node.
std::vector<int> ElementKernel::patches() const {
  const auto adjacent = [&](SurfaceIndex p, SurfaceIndex q) {
    if (p == q) return true;
    const std::span<const NodeIndex> of_p = nodes(p), of_q = nodes(q);
    return std::find_first_of(of_p.begin(), of_p.end(), of_q.begin(), of_q.end()) != of_p.end();
  };
  Groups groups(touches_.size());
  std::vector<std::pair<int, int>> keys;
  std::map<NodeIndex, std::vector<int>> at_node;  // touches of elements at each node
  for (int i = 0; i < static_cast<int>(touches_.size()); ++i) {
    const Touch& t = touches_[i];
    keys.emplace_back(surfaces_.body(t.a), surfaces_.body(t.b));
    for (const NodeIndex node : nodes(surfaces_.is_rigid(t.a) ? t.b : t.a)) {
      for (const int j : at_node[node]) {
        const Touch& u = touches_[j];
        if (keys[j] == keys[i] && adjacent(t.a, u.a) && adjacent(t.b, u.b)) groups.join(i, j);
      }
      at_node[node].push_back(i);
    }
  }
  return groups.numbers(keys);
}

void ElementKernel::add_records(std::vector<ContactRecord>& records) const {
  const std::vector<int> patch = patches();
  const int count = patch.empty() ? 0 : *std::max_element(patch.begin(), patch.end()) + 1;
  std::vector<ContactRecord> found(static_cast<size_t>(count));
  std::vector<double> weights(found.size());
  Depths depths;
  for (size_t i = 0; i < touches_.size(); ++i) {
    const Touch& t = touches_[i];
    const PairIntegral& pair = pairs_.integral(pairs_.touching()[i]);
    ContactRecord& sum = found[static_cast<size_t>(patch[i])];
    sum.a = surfaces_.body(t.a), sum.b = surfaces_.body(t.b);
    sum.normal += t.force;
    sum.damping += t.push;
    sum.tangential += t.friction + t.drag;
    sum.point += pair.weight * (surfaces_.reference(t.a) + t.point);
    sum.penetration = find_penetration(t.a, t.b, sum.penetration, depths);
    sum.phi = std::max(sum.phi, pair.largest_phi);
    weights[static_cast<size_t>(patch[i])] += pair.weight;
  }
  for (size_t i = 0; i < found.size(); ++i) {
    if (weights[i] > 0) found[i].point /= weights[i];
  }
  records.insert(records.end(), found.begin(), found.end());
}

}  // namespace apothem
