#include "apothem/contact/outline_friction.hpp"

#include <algorithm>
#include <cmath>

#include "apothem/contact/kernel.hpp"
#include "apothem/execution/elementary.hpp"

namespace apothem {
namespace {

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
  return {p, q, a, o.next[a], tx, ty, sum - first, first, b - sum, -b, couple, start, rise};
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

void OutlineFriction::find_times(std::span<const EdgeFaceContact> contacts,
                                 std::span<const EdgeFaceLaw> laws, double dt) {
  times_.begin_step();
  for (const EdgeFaceContact& c : contacts) {
    const EdgeFaceLaw& law = laws[static_cast<size_t>(c.pair)];
    DampingTimes::Pair& pair = times_[law.bodies];
    const double length = length_of(outlines_, c);
    pair.normal += c.slope * length;
    pair.tangential += law.spring * length;
  }
  times_.end_step(dt);
}

// Dashpots in the two points of Gauss, which are exact for what is linear along the piece. Returns
// their force against the face.
double OutlineFriction::damp_normal(const EdgeFaceContact& c, const Slip& s, double time) {
  constexpr double kGauss = .57735026918962576451;
  const double from = c.piece.from, part = c.piece.to - from;
  if (!(part > 0 && c.piece.sum > 0)) return 0;
  const double middle = from + part / 2, mean = c.piece.sum / part;  // of u, and of the depth
  const double slope = 12 * (c.piece.first - middle * c.piece.sum) / (part * part * part);
  // How fast the edge closes in on the face, along the inward normal (-ty, tx), is linear in u.
  const double fx = vx_[s.b] - vx_[s.a], fy = vy_[s.b] - vy_[s.a];
  const double x0 = vx_[s.p] - vx_[s.a] - s.start * fx, y0 = vy_[s.p] - vy_[s.a] - s.start * fy;
  const double x1 = vx_[s.q] - vx_[s.p] - s.rise * fx, y1 = vy_[s.q] - vy_[s.p] - s.rise * fy;
  const double at_p = s.tx * y0 - s.ty * x0, change = s.tx * y1 - s.ty * x1;
  const double weight = c.slope * outlines_.length[c.edge] * part / 2;
  double sum = 0, first = 0;  // of the forces, and of the forces times u
  for (const double place : {-kGauss, kGauss}) {
    const double u = middle + place * part / 2;
    const double depth = mean + slope * (u - middle);
    const double force = weight * std::max(time * (at_p + u * change), -depth);
    sum += force;
    first += u * force;
  }
  const auto add = [&](int vertex, double force) {
    damping_.x[vertex] += force * s.ty;
    damping_.y[vertex] -= force * s.tx;
  };
  const double on_b = s.start * sum + s.rise * first;
  add(s.p, sum - first), add(s.q, first), add(s.a, on_b - sum), add(s.b, -on_b);
  return sum;
}

double OutlineFriction::slide(std::span<const EdgeFaceContact> contacts,
                              std::span<const EdgeFaceLaw> laws, const Kinematics& now, double dt,
                              FrictionMemory& memory) {
  const Outlines& o = outlines_;
  find_velocities(now, dt);
  const auto n = static_cast<size_t>(o.size());
  for (VertexForces* forces : {&friction_, &damping_}) forces->x.resize(n), forces->y.resize(n);
  std::swap(friction_, friction_before_);
  const double power_before = power(friction_before_), damping_before = power(damping_);
  friction_.x.assign(n, 0), friction_.y.assign(n, 0);
  // A first look, perhaps with the memory of another run: as springs do, dashpots keep their force.
  const bool dashpots = damped_ && dt > 0;
  if (dashpots) {
    damping_.x.assign(n, 0), damping_.y.assign(n, 0);
    find_times(contacts, laws, dt);
  }
  shares_.assign(contacts.size(), 0);
  pushes_.assign(contacts.size(), 0);
  SpringKey key = contacts.empty() ? SpringKey{} : key_of(o, contacts[0]);
  for (size_t first = 0, end; first < contacts.size(); first = end) {
    const SpringKey own = key;
    const EdgeFaceLaw& law = laws[static_cast<size_t>(contacts[first].pair)];
    slips_.clear();
    for (end = first; end < contacts.size(); ++end) {
      key = key_of(o, contacts[end]);
      if (key != own) break;
      slips_.push_back(slip_of(contacts[end]));
    }
    const DampingTimes::Pair* const pair = dashpots ? &times_[law.bodies] : nullptr;
    double pushes = 0;
    for (size_t i = first; pair && pair->normal_time > 0 && i < end; ++i) {
      pushes_[i] = damp_normal(contacts[i], slips_[i - first], pair->normal_time);
      pushes += pushes_[i];
    }
    if (!(law.friction > 0)) continue;

    Spring spring{own};
    double normal = 0, rate = 0, approach = 0, width = 0, depth = 0;
    for (size_t i = first; i < end; ++i) {
      const EdgeFaceContact& c = contacts[i];
      const Slip& s = slips_[i - first];
      const double length = length_of(o, c);
      normal += s.at_p + s.at_q;
      spring.stiffness += law.spring * length;
      const double x =
          s.at_p * vx_[s.p] + s.at_q * vx_[s.q] + s.at_a * vx_[s.a] + s.at_b * vx_[s.b];
      const double y =
          s.at_p * vy_[s.p] + s.at_q * vy_[s.q] + s.at_a * vy_[s.a] + s.at_b * vy_[s.b];
      rate += s.tx * x + s.ty * y +
              s.couple * (s.tx * (vy_[s.b] - vy_[s.a]) - s.ty * (vx_[s.b] - vx_[s.a]));
      approach += s.tx * y - s.ty * x;
      width += length;
      depth += c.piece.sum * o.length[c.edge];
    }
    const std::span<const Spring> before = memory.before(own.law, own.a, own.b);
    if (!(normal > 0)) continue;
    // Contact that has closed within a long step: what came before is no slip.
    if (now.finite && before.empty() && approach / normal * dt > depth / width) {
      rate *= depth / width / (approach / normal * dt);
    }
    // New contact joins without a slip of its own; contact that ends takes its share along.
    const double force =
        before.empty() ? 0 : before[0].force * std::min(1., spring.stiffness / before[0].stiffness);
    const double limit = law.friction * std::max(normal + pushes, 0.);
    const double slip = rate / normal;  // m/s
    spring.force = apothem::slide(force, slip * dt, spring.stiffness, limit);
    memory.keep(spring);
    double dashpot = 0;
    if (pair && pair->tangential_time > 0) {
      const double resists = spring.force - pair->tangential_time * spring.stiffness * slip;
      dashpot = std::clamp(resists, -limit, limit) - spring.force;
    }
    for (size_t i = first; i < end; ++i) {
      const Slip& s = slips_[i - first];
      apply(s, spring.force / normal, friction_);
      if (dashpot != 0) apply(s, dashpot / normal, damping_);
      shares_[i] = (spring.force + dashpot) / normal * (s.at_p + s.at_q);
    }
  }
  const double damping_now = damped_ ? power(damping_) : 0;
  const double power_now = power(friction_);
  everywhere_ = !(dt > 0);
  if (damped_) memory.damp(-dt / 2 * (damping_before + damping_now));
  return dt / 2 * (power_before + power_now);
}

// The friction force times the coefficients of the slip rate.
void OutlineFriction::apply(const Slip& s, double force, VertexForces& forces) {
  const auto add = [&](int vertex, double along, double across) {
    forces.x[vertex] += force * (along * s.tx + across * s.ty);
    forces.y[vertex] += force * (along * s.ty - across * s.tx);
  };
  add(s.p, s.at_p, 0), add(s.q, s.at_q, 0);
  add(s.a, s.at_a, s.couple), add(s.b, s.at_b, -s.couple);
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
