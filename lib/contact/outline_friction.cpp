#include "apothem/contact/outline_friction.hpp"

#include <algorithm>
#include <cmath>

#include "apothem/contact/kernel.hpp"
#include "apothem/execution/elementary.hpp"

namespace apothem {
namespace {

constexpr double kFollowTime = 80, kGatherTime = 25;  // of a contact, ns

// Of the spring that a contact belongs to: an edge has one for each body that it touches. Edges of
// rigid bodies are long: they have one for each face, which the face takes with it.
SpringKey key_of(const Outlines& o, const EdgeFaceContact& c) {
  return {outline_kernel, c.edge, o.bodies[o.body[c.edge]].is_rigid() ? c.face : o.body[c.face], 0};
}

double length_of(const Outlines& o, const EdgeFaceContact& c) {
  return (c.piece.to - c.piece.from) * o.length[c.edge];
}

}  // namespace

OutlineFriction::Slip OutlineFriction::slip_of(const EdgeFaceContact& c) const {
  const Outlines& o = outlines_;
  const int p = c.edge, q = o.next[p], a = c.face;
  const double tx = o.tx[a], ty = o.ty[a];
  const double scale = 1 / o.length[a];
  const double px = (o.x[p] - o.x[a]) * scale, py = (o.y[p] - o.y[a]) * scale;
  const double dx = (o.x[q] - o.x[p]) * scale, dy = (o.y[q] - o.y[p]) * scale;
  const double start = tx * px + ty * py, rise = tx * dx + ty * dy;
  const double weight = c.slope * o.length[p];
  const double sum = weight * c.piece.sum, first = weight * c.piece.first;
  const double b = start * sum + rise * first;
  const double couple = (tx * py - ty * px) * sum + (tx * dy - ty * dx) * first;
  return {p, q, a, o.next[a], tx, ty, sum - first, first, b - sum, -b, couple, start, rise, 0, 0};
}

void OutlineFriction::find_velocities(const Kinematics& now, double dt) {
  const Outlines& o = outlines_;
  vx_.resize(o.size()), vy_.resize(o.size());
  const auto find = [&](const Outlines::Body& body) {
    for (int i = body.first; i < body.end; ++i) {
      if (body.is_rigid()) {
        const double* v = now.pose_rate.data() + 3 * static_cast<size_t>(body.rigid);
        vx_[i] = v[0] - v[2] * (o.y[i] - body.cy);
        vy_[i] = v[1] + v[2] * (o.x[i] - body.cx);
        if (!now.finite) continue;
        // From where the vertex was, along the chord of its arc.
        const double angle = v[2] * dt, half = sine_cosine(angle / 2).sine;
        const double turned = sine_cosine(angle).sine / dt - v[2], drawn = 2 * half * half / dt;
        vx_[i] += drawn * (o.x[i] - body.cx) - turned * (o.y[i] - body.cy);
        vy_[i] += drawn * (o.y[i] - body.cy) + turned * (o.x[i] - body.cx);
      } else {
        vx_[i] = now.node_velocity[2 * static_cast<size_t>(o.node[i])];
        vy_[i] = now.node_velocity[2 * static_cast<size_t>(o.node[i]) + 1];
      }
    }
  };
  if (everywhere_) {
    std::ranges::for_each(o.bodies, find);
  } else {
    for (const BodyIndex b : o.active()) find(o.bodies[b]);
  }
}

void OutlineFriction::find_times(const Step& step) {
  times_.begin_step();
  for (const EdgeFaceContact& c : step.contacts) {
    const EdgeFaceLaw& law = step.laws[static_cast<size_t>(c.pair)];
    DampingTimes::Pair& pair = times_[law.bodies];
    const double length = length_of(outlines_, c);
    pair.normal += c.slope * length;
    pair.tangential += law.spring * length;
  }
  times_.end_step(step.dt);
}

void OutlineFriction::find_groups(const Step& step, FrictionMemory& memory) {
  groups_.clear();
  for (size_t i = 0; i < step.contacts.size(); ++i) {
    const SpringKey key = key_of(outlines_, step.contacts[i]);
    if (!groups_.empty() && groups_.back().spring.key == key) {
      groups_.back().end = i + 1;
      continue;
    }
    Group& group = groups_.emplace_back(Group{i, i + 1, nullptr, {key}, false, 0, 0});
    if (!(step.laws[static_cast<size_t>(step.contacts[i].pair)].friction > 0)) continue;
    const std::span<const Spring> before = memory.before(key.law, key.a, key.b);
    if (!before.empty()) group.before = before.data();
  }
}

// Dashpots in the two points of Gauss, which are exact for what is linear along the piece.
void OutlineFriction::damp_normal(const EdgeFaceContact& c, double time, Slip& s) const {
  constexpr double kGauss = .57735026918962576451;
  const double from = c.piece.from, part = c.piece.to - from;
  if (!(part > 0 && c.piece.sum > 0)) return;
  const double middle = from + part / 2, mean = c.piece.sum / part;  // of u, and of the depth
  const double slope = 12 * (c.piece.first - middle * c.piece.sum) / (part * part * part);
  // How fast the edge closes in on the face, along the inward normal (-ty, tx), is linear in u.
  const double fx = vx_[s.b] - vx_[s.a], fy = vy_[s.b] - vy_[s.a];
  const double x0 = vx_[s.p] - vx_[s.a] - s.start * fx, y0 = vy_[s.p] - vy_[s.a] - s.start * fy;
  const double x1 = vx_[s.q] - vx_[s.p] - s.rise * fx, y1 = vy_[s.q] - vy_[s.p] - s.rise * fy;
  const double at_p = s.tx * y0 - s.ty * x0, change = s.tx * y1 - s.ty * x1;
  const double weight = c.slope * outlines_.length[c.edge] * part / 2;
  for (const double place : {-kGauss, kGauss}) {
    const double u = middle + place * part / 2;
    const double depth = mean + slope * (u - middle);
    const double force = weight * std::max(time * (at_p + u * change), -depth);
    s.push += force;
    s.push_at_q += u * force;
  }
}

// Finds the slips, the spring and the dashpots of the contacts of a spring.
void OutlineFriction::follow(const Step& step, Group& group) {
  const Outlines& o = outlines_;
  const EdgeFaceLaw& law = step.laws[static_cast<size_t>(step.contacts[group.first].pair)];
  const DampingTimes::Pair* const pair = step.dashpots ? &times_[law.bodies] : nullptr;
  Spring& spring = group.spring;
  double pushes = 0, normal = 0, rate = 0, approach = 0, width = 0, depth = 0;
  for (size_t i = group.first; i < group.end; ++i) {
    const EdgeFaceContact& c = step.contacts[i];
    Slip& s = slips_[i] = slip_of(c);
    if (pair && pair->normal_time > 0) damp_normal(c, pair->normal_time, s);
    pushes_[i] = s.push;
    pushes += s.push;
    const double length = length_of(o, c);
    normal += s.at_p + s.at_q;
    spring.stiffness += law.spring * length;
    const double x = s.at_p * vx_[s.p] + s.at_q * vx_[s.q] + s.at_a * vx_[s.a] + s.at_b * vx_[s.b];
    const double y = s.at_p * vy_[s.p] + s.at_q * vy_[s.q] + s.at_a * vy_[s.a] + s.at_b * vy_[s.b];
    rate += s.tx * x + s.ty * y +
            s.couple * (s.tx * (vy_[s.b] - vy_[s.a]) - s.ty * (vx_[s.b] - vx_[s.a]));
    approach += s.tx * y - s.ty * x;
    width += length;
    depth += c.piece.sum * o.length[c.edge];
  }
  if (!(law.friction > 0 && normal > 0)) return;
  group.slides = true;
  // Contact that has closed within a long step: what came before is no slip.
  const Spring* const before = group.before;
  if (step.finite && !before && approach / normal * step.dt > depth / width) {
    rate *= depth / width / (approach / normal * step.dt);
  }
  // New contact joins without a slip of its own; contact that ends takes its share along.
  const double force =
      before ? before->force * std::min(1., spring.stiffness / before->stiffness) : 0;
  const double limit = law.friction * std::max(normal + pushes, 0.);
  const double slip = rate / normal;  // m/s
  spring.force = apothem::slide(force, slip * step.dt, spring.stiffness, limit);
  double dashpot = 0;
  if (pair && pair->tangential_time > 0) {
    const double resists = spring.force - pair->tangential_time * spring.stiffness * slip;
    dashpot = std::clamp(resists, -limit, limit) - spring.force;
  }
  group.friction = spring.force / normal;
  group.dashpot = dashpot / normal;
  for (size_t i = group.first; i < group.end; ++i) {
    shares_[i] = (spring.force + dashpot) / normal * (slips_[i].at_p + slips_[i].at_q);
  }
}

// Adds the forces on the vertices from `first` to `end` - 1, those of whole bodies, for every
// vertex in the order of the contacts. The force along a face times the coefficients of the slip
// rate acts on the vertices.
void OutlineFriction::add_forces(int first, int end) {
  for (const Group& group : groups_) {
    for (size_t i = group.first; i < group.end; ++i) {
      const Slip& s = slips_[i];
      const auto add = [&](VertexForces& forces, int vertex, double along, double across) {
        forces.x[vertex] += along * s.tx + across * s.ty;
        forces.y[vertex] += along * s.ty - across * s.tx;
      };
      const bool edge = s.p >= first && s.p < end, face = s.a >= first && s.a < end;
      const auto drag = [&](VertexForces& forces, double force) {
        if (edge) add(forces, s.p, force * s.at_p, 0), add(forces, s.q, force * s.at_q, 0);
        if (!face) return;
        add(forces, s.a, force * s.at_a, force * s.couple);
        add(forces, s.b, force * s.at_b, -force * s.couple);
      };
      if (group.slides) drag(friction_, group.friction);
      if (group.dashpot != 0) drag(damping_, group.dashpot);
      if (s.push == 0 && s.push_at_q == 0) continue;
      if (edge) add(damping_, s.p, 0, s.push - s.push_at_q), add(damping_, s.q, 0, s.push_at_q);
      if (!face) continue;
      const double on_b = s.start * s.push + s.rise * s.push_at_q;
      add(damping_, s.a, 0, on_b - s.push), add(damping_, s.b, 0, -on_b);
    }
  }
}

double OutlineFriction::slide(std::span<const EdgeFaceContact> contacts,
                              std::span<const EdgeFaceLaw> laws, const Kinematics& now, double dt,
                              FrictionMemory& memory) {
  const Outlines& o = outlines_;
  // A first look, perhaps with the memory of another run: as springs do, dashpots keep their force.
  const Step step{contacts, laws, dt, now.finite, damped_ && dt > 0};
  find_velocities(now, dt);
  const auto n = static_cast<size_t>(o.size());
  for (VertexForces* forces : {&friction_, &damping_}) forces->x.resize(n), forces->y.resize(n);
  std::swap(friction_, friction_before_);
  const double power_before = power(friction_before_), damping_before = power(damping_);
  friction_.x.assign(n, 0), friction_.y.assign(n, 0);
  if (step.dashpots) {
    damping_.x.assign(n, 0), damping_.y.assign(n, 0);
    find_times(step);
  }
  shares_.assign(contacts.size(), 0);
  pushes_.assign(contacts.size(), 0);
  slips_.resize(contacts.size());
  find_groups(step, memory);
  threads_.chunks(static_cast<int>(groups_.size()), kFollowTime, [&](int first, int end, int) {
    for (int g = first; g < end; ++g) follow(step, groups_[static_cast<size_t>(g)]);
  });
  for (const Group& group : groups_) {
    if (group.slides) memory.keep(group.spring);
  }
  const std::span<const BodyIndex> active = o.active();
  const int bodies = static_cast<int>(active.size());
  threads_.chunks(bodies, kGatherTime * static_cast<double>(contacts.size()) / std::max(bodies, 1),
                  [&](int first, int end, int) {
                    if (first == end) return;
                    add_forces(o.bodies[active[first]].first, o.bodies[active[end - 1]].end);
                  });
  const double damping_now = damped_ ? power(damping_) : 0;
  const double power_now = power(friction_);
  everywhere_ = !(dt > 0);
  if (damped_) memory.damp(-dt / 2 * (damping_before + damping_now));
  return dt / 2 * (power_before + power_now);
}

// Of the forces on the bodies, W.
double OutlineFriction::power(const VertexForces& forces) const {
  double sum = 0;
  const auto add = [&](int i) { sum += forces.x[i] * vx_[i] + forces.y[i] * vy_[i]; };
  if (everywhere_) {
    for (int i = 0; i < outlines_.size(); ++i) add(i);
  } else {
    outlines_.each_active_vertex(add);
  }
  return sum;
}

}  // namespace apothem
