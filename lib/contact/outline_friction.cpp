#include "apothem/contact/outline_friction.hpp"

#include <algorithm>
#include <cmath>

#include "apothem/contact/kernel.hpp"

namespace apothem {
namespace {

// Of the spring that a contact belongs to: an edge has one for each body that it touches. Edges of
// rigid bodies are long: they have one for each face, which the face takes with it.
SpringKey key_of(const Outlines& o, const EdgeFaceContact& c) {
  return {outline_kernel, c.edge, o.bodies[o.body[c.edge]].is_rigid() ? c.face : o.body[c.face], 0};
}

double spring_stiffness(const Outlines& o, const EdgeFaceContact& c, const Friction& friction,
                        double thickness) {
  return friction.tangential_stiffness * thickness / o.bodies[o.body[c.face]].reference *
         (c.piece.to - c.piece.from) * o.length[c.edge];
}

}  // namespace

// Of t at both ends of the edge and of the face, and of n at the ends of the face.
struct OutlineFriction::SlipRate {
  double p, q, a, b, couple;
};

OutlineFriction::SlipRate OutlineFriction::slip_rate(const EdgeFaceContact& c,
                                                     double weight) const {
  const Outlines& o = outlines_;
  const int e = c.edge, e1 = o.next[e], f = c.face;
  const double tx = o.tx[f], ty = o.ty[f], length = o.length[f];
  const double px = o.x[e] - o.x[f], py = o.y[e] - o.y[f];
  const double dx = o.x[e1] - o.x[e], dy = o.y[e1] - o.y[e];
  const double sum = weight * c.piece.sum, first = weight * c.piece.first;
  const double b = ((tx * px + ty * py) * sum + (tx * dx + ty * dy) * first) / length;
  const double couple = ((tx * py - ty * px) * sum + (tx * dy - ty * dx) * first) / length;
  return {sum - first, first, b - sum, -b, couple};
}

void OutlineFriction::find_velocities(const Kinematics& now, double dt) {
  const Outlines& o = outlines_;
  vx_.resize(o.size()), vy_.resize(o.size());
  for (const Outlines::Body& body : o.bodies) {
    for (int i = body.first; i < body.end; ++i) {
      if (body.is_rigid()) {
        const double* v = now.pose_rate.data() + 3 * static_cast<size_t>(body.rigid);
        vx_[i] = v[0] - v[2] * (o.y[i] - body.cy);
        vy_[i] = v[1] + v[2] * (o.x[i] - body.cx);
        if (!now.finite) continue;
        // From where the vertex was, along the chord of its arc.
        const double angle = v[2] * dt, half = std::sin(angle / 2);
        const double turned = std::sin(angle) / dt - v[2], drawn = 2 * half * half / dt;
        vx_[i] += drawn * (o.x[i] - body.cx) - turned * (o.y[i] - body.cy);
        vy_[i] += drawn * (o.y[i] - body.cy) + turned * (o.x[i] - body.cx);
      } else {
        vx_[i] = now.node_velocity[2 * static_cast<size_t>(o.node[i])];
        vy_[i] = now.node_velocity[2 * static_cast<size_t>(o.node[i]) + 1];
      }
    }
  }
}

void OutlineFriction::find_times(const std::vector<EdgeFaceContact>& contacts, double dt) {
  const Outlines& o = outlines_;
  times_.begin_step();
  for (const EdgeFaceContact& c : contacts) {
    DampingTimes::Pair& pair = times_.of(o.body[c.edge], o.body[c.face]);
    pair.normal += c.slope * (c.piece.to - c.piece.from) * o.length[c.edge];
    const Friction& friction = table_.between(pair.a, pair.b).friction;
    pair.tangential += spring_stiffness(o, c, friction, thickness_);
  }
  times_.end_step(dt);
}

// Dashpots in the two points of Gauss, which are exact for what is linear along the piece.
void OutlineFriction::damp_normal(const EdgeFaceContact& c, double time, double& push) {
  constexpr double kGauss = .57735026918962576451;
  const Outlines& o = outlines_;
  const int p = c.edge, q = o.next[p], a = c.face, b = o.next[a];
  const double from = c.piece.from, part = c.piece.to - from;
  if (!(part > 0 && c.piece.sum > 0)) return;
  const double tx = o.tx[a], ty = o.ty[a];
  const double middle = from + part / 2, mean = c.piece.sum / part;  // of u, and of the depth
  const double rise = 12 * (c.piece.first - middle * c.piece.sum) / (part * part * part);
  for (const double place : {-kGauss, kGauss}) {
    const double u = middle + place * part / 2;
    const double depth = mean + rise * (u - middle);
    const double x = o.x[p] + u * (o.x[q] - o.x[p]), y = o.y[p] + u * (o.y[q] - o.y[p]);
    const double s = (tx * (x - o.x[a]) + ty * (y - o.y[a])) / o.length[a];
    const double vx = (1 - u) * vx_[p] + u * vx_[q] - (1 - s) * vx_[a] - s * vx_[b];
    const double vy = (1 - u) * vy_[p] + u * vy_[q] - (1 - s) * vy_[a] - s * vy_[b];
    const double closing = tx * vy - ty * vx;  // along the inward normal (-ty, tx)
    const double pressure = std::max(time * closing, -depth);
    const double force = c.slope * o.length[p] * part / 2 * pressure;
    push += force;
    const auto add = [&](int vertex, double share) {
      damping_.x[vertex] += share * force * ty;
      damping_.y[vertex] -= share * force * tx;
    };
    add(p, 1 - u), add(q, u), add(a, s - 1), add(b, -s);
  }
}

double OutlineFriction::slide(const std::vector<EdgeFaceContact>& contacts, const Kinematics& now,
                              double dt, FrictionMemory& memory) {
  const Outlines& o = outlines_;
  const bool damped = table_.damped();
  find_velocities(now, dt);
  const auto n = static_cast<size_t>(o.size());
  for (VertexForces* forces : {&friction_, &damping_}) forces->x.resize(n), forces->y.resize(n);
  std::swap(friction_, friction_before_);
  const double power_before = power(friction_before_), damping_before = power(damping_);
  friction_.x.assign(n, 0), friction_.y.assign(n, 0);
  // A first look, perhaps with the memory of another run: as springs do, dashpots keep their force.
  const bool dashpots = damped && dt > 0;
  if (dashpots) {
    damping_.x.assign(n, 0), damping_.y.assign(n, 0);
    find_times(contacts, dt);
  }
  shares_.assign(contacts.size(), 0);
  pushes_.assign(contacts.size(), 0);
  for (size_t first = 0, end; first < contacts.size(); first = end) {
    const SpringKey key = key_of(o, contacts[first]);
    end = first + 1;
    while (end < contacts.size() && key_of(o, contacts[end]) == key) ++end;
    const BodyIndex body = o.body[contacts[first].edge], other = o.body[contacts[first].face];
    const DampingTimes::Pair* const pair = dashpots ? &times_.of(body, other) : nullptr;
    double pushes = 0;
    for (size_t i = first; pair && pair->normal_time > 0 && i < end; ++i) {
      damp_normal(contacts[i], pair->normal_time, pushes_[i]);
      pushes += pushes_[i];
    }
    const Friction& friction = table_.between(body, other).friction;
    if (!(friction.coefficient > 0)) continue;

    Spring spring{key};
    double normal = 0, rate = 0, approach = 0, width = 0, depth = 0;
    for (size_t i = first; i < end; ++i) {
      const EdgeFaceContact& c = contacts[i];
      const double weight = c.slope * o.length[c.edge];
      const double length = (c.piece.to - c.piece.from) * o.length[c.edge];
      normal += weight * c.piece.sum;
      spring.stiffness += spring_stiffness(o, c, friction, thickness_);
      const SlipRate k = slip_rate(c, weight);
      const int p = c.edge, q = o.next[p], a = c.face, b = o.next[a];
      const double x = k.p * vx_[p] + k.q * vx_[q] + k.a * vx_[a] + k.b * vx_[b];
      const double y = k.p * vy_[p] + k.q * vy_[q] + k.a * vy_[a] + k.b * vy_[b];
      rate += o.tx[a] * x + o.ty[a] * y +
              k.couple * (o.tx[a] * (vy_[b] - vy_[a]) - o.ty[a] * (vx_[b] - vx_[a]));
      approach += o.tx[a] * y - o.ty[a] * x;
      width += length;
      depth += c.piece.sum * o.length[c.edge];
    }
    const std::span<const Spring> before = memory.before(key.law, key.a, key.b);
    if (!(normal > 0)) continue;
    // Contact that has closed within a long step: what came before is no slip.
    if (now.finite && before.empty() && approach / normal * dt > depth / width) {
      rate *= depth / width / (approach / normal * dt);
    }
    // New contact joins without a slip of its own; contact that ends takes its share along.
    const double force =
        before.empty() ? 0 : before[0].force * std::min(1., spring.stiffness / before[0].stiffness);
    const double limit = friction.coefficient * std::max(normal + pushes, 0.);
    const double slip = rate / normal;  // m/s
    spring.force = apothem::slide(force, slip * dt, spring.stiffness, limit);
    memory.keep(spring);
    double dashpot = 0;
    if (pair && pair->tangential_time > 0) {
      const double resists = spring.force - pair->tangential_time * spring.stiffness * slip;
      dashpot = std::clamp(resists, -limit, limit) - spring.force;
    }
    for (size_t i = first; i < end; ++i) {
      const EdgeFaceContact& c = contacts[i];
      const double weight = c.slope * o.length[c.edge] / normal;
      apply(c, weight * spring.force, friction_);
      if (dashpot != 0) apply(c, weight * dashpot, damping_);
      shares_[i] = (spring.force + dashpot) * weight * c.piece.sum;
    }
  }
  if (damped) memory.damp(-dt / 2 * (damping_before + power(damping_)));
  return dt / 2 * (power_before + power(friction_));
}

// The friction force times the coefficients of the slip rate.
void OutlineFriction::apply(const EdgeFaceContact& c, double weight, VertexForces& forces) const {
  const Outlines& o = outlines_;
  const SlipRate k = slip_rate(c, weight);
  const int p = c.edge, q = o.next[p], a = c.face, b = o.next[a];
  const double tx = o.tx[a], ty = o.ty[a];
  forces.x[p] += k.p * tx, forces.y[p] += k.p * ty;
  forces.x[q] += k.q * tx, forces.y[q] += k.q * ty;
  forces.x[a] += k.a * tx + k.couple * ty, forces.y[a] += k.a * ty - k.couple * tx;
  forces.x[b] += k.b * tx - k.couple * ty, forces.y[b] += k.b * ty + k.couple * tx;
}

// Of the forces on the bodies, W.
double OutlineFriction::power(const VertexForces& forces) const {
  double sum = 0;
  for (size_t i = 0; i < forces.x.size(); ++i) {
    sum += forces.x[i] * vx_[i] + forces.y[i] * vy_[i];
  }
  return sum;
}

}  // namespace apothem
