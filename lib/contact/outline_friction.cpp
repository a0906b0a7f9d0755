#include "apothem/contact/outline_friction.hpp"

#include <algorithm>
#include <cmath>

#include "apothem/contact/kernel.hpp"

namespace apothem {
namespace {

// Pressure-weighted coefficients of the slip rate: of t at both ends of the edge and of the face,
// and of n at the ends of the face.
struct SlipRate {
  double p, q, a, b, couple;
};

SlipRate slip_rate(const Outlines& o, const EdgeFaceContact& c, double weight) {
  const int e = c.edge, e1 = o.next[e], f = c.face;
  const double tx = o.tx[f], ty = o.ty[f], length = o.length[f];
  const double px = o.x[e] - o.x[f], py = o.y[e] - o.y[f];
  const double dx = o.x[e1] - o.x[e], dy = o.y[e1] - o.y[e];
  const double sum = weight * c.piece.sum, first = weight * c.piece.first;
  const double b = ((tx * px + ty * py) * sum + (tx * dx + ty * dy) * first) / length;
  const double couple = ((tx * py - ty * px) * sum + (tx * dy - ty * dx) * first) / length;
  return {sum - first, first, b - sum, -b, couple};
}

// Of the spring that a contact belongs to: an edge has one for each body that it touches. Edges of
// rigid bodies are long: they have one for each face, which the face takes with it.
SpringKey key_of(const Outlines& o, const EdgeFaceContact& c) {
  return {outline_kernel, c.edge, o.bodies[o.body[c.edge]].is_rigid() ? c.face : o.body[c.face], 0};
}

}  // namespace

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

double OutlineFriction::slide(const std::vector<EdgeFaceContact>& contacts, const Kinematics& now,
                              double dt, FrictionMemory& memory) {
  const Outlines& o = outlines_;
  find_velocities(now, dt);
  fx_.swap(fx_before_), fy_.swap(fy_before_);
  const double power_before = power(fx_before_, fy_before_);
  fx_.assign(o.size(), 0), fy_.assign(o.size(), 0);
  shares_.assign(contacts.size(), 0);
  for (size_t first = 0, end; first < contacts.size(); first = end) {
    const SpringKey key = key_of(o, contacts[first]);
    end = first + 1;
    while (end < contacts.size() && key_of(o, contacts[end]) == key) ++end;
    const BodyIndex body = o.body[contacts[first].edge], other = o.body[contacts[first].face];
    const Friction& friction = table_.between(body, other);
    if (!(friction.coefficient > 0)) continue;

    Spring spring{key};
    double normal = 0, rate = 0, approach = 0, width = 0, depth = 0;
    for (size_t i = first; i < end; ++i) {
      const EdgeFaceContact& c = contacts[i];
      const double weight = slope_[c.face] * o.length[c.edge];
      const double length = (c.piece.to - c.piece.from) * o.length[c.edge];
      normal += weight * c.piece.sum;
      spring.stiffness +=
          friction.tangential_stiffness * thickness_ / o.bodies[other].reference * length;
      const SlipRate k = slip_rate(o, c, weight);
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
    spring.force =
        apothem::slide(force, rate / normal * dt, spring.stiffness, friction.coefficient * normal);
    memory.keep(spring);
    for (size_t i = first; i < end; ++i) {
      const EdgeFaceContact& c = contacts[i];
      apply(c, slope_[c.face] * o.length[c.edge] * spring.force / normal);
      shares_[i] = spring.force * (slope_[c.face] * o.length[c.edge] * c.piece.sum) / normal;
    }
  }
  return dt / 2 * (power_before + power(fx_, fy_));
}

// The friction force times the coefficients of the slip rate.
void OutlineFriction::apply(const EdgeFaceContact& c, double weight) {
  const Outlines& o = outlines_;
  const SlipRate k = slip_rate(o, c, weight);
  const int p = c.edge, q = o.next[p], a = c.face, b = o.next[a];
  const double tx = o.tx[a], ty = o.ty[a];
  fx_[p] += k.p * tx, fy_[p] += k.p * ty;
  fx_[q] += k.q * tx, fy_[q] += k.q * ty;
  fx_[a] += k.a * tx + k.couple * ty, fy_[a] += k.a * ty - k.couple * tx;
  fx_[b] += k.b * tx - k.couple * ty, fy_[b] += k.b * ty + k.couple * tx;
}

// Of the forces on the bodies, W.
double OutlineFriction::power(const std::vector<double>& fx, const std::vector<double>& fy) const {
  double sum = 0;
  for (size_t i = 0; i < fx.size(); ++i) sum += fx[i] * vx_[i] + fy[i] * vy_[i];
  return sum;
}

}  // namespace apothem
