#include "apothem/contact/deformable_friction.hpp"

#include <algorithm>
#include <cmath>

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

// Of the spring that a contact belongs to.
std::pair<int, int> key_of(const Outlines& o, const EdgeFaceContact& c) {
  return {c.edge, o.bodies[o.body[c.edge]].rigid() ? c.face : o.body[c.face]};
}

// One past the last contact of the same spring.
size_t end_of(const Outlines& o, const std::vector<EdgeFaceContact>& contacts, size_t first) {
  const auto key = key_of(o, contacts[first]);
  size_t end = first + 1;
  while (end < contacts.size() && key_of(o, contacts[end]) == key) ++end;
  return end;
}

}  // namespace

void DeformableFriction::find_velocities(const DeformableContact& contact,
                                         std::span<const double> node_velocity,
                                         std::span<const double> velocity) {
  const Outlines& o = contact.outlines();
  vx_.resize(o.size()), vy_.resize(o.size());
  for (const Outlines::Body& body : o.bodies) {
    for (int i = body.first; i < body.end; ++i) {
      if (body.rigid()) {
        const double* v = velocity.data() + 3 * static_cast<size_t>(body.entry);
        vx_[i] = v[0] - v[2] * (o.y[i] - body.cy);
        vy_[i] = v[1] + v[2] * (o.x[i] - body.cx);
      } else {
        vx_[i] = node_velocity[2 * static_cast<size_t>(o.node[i])];
        vy_[i] = node_velocity[2 * static_cast<size_t>(o.node[i]) + 1];
      }
    }
  }
}

void DeformableFriction::update(const DeformableContact& contact,
                                std::span<const double> node_velocity,
                                std::span<const double> velocity, double dt) {
  const Outlines& o = contact.outlines();
  const std::vector<EdgeFaceContact>& contacts = contact.contacts();
  find_velocities(contact, node_velocity, velocity);
  fx_.resize(o.size()), fy_.resize(o.size());
  const double power_before = power();
  fx_.assign(o.size(), 0), fy_.assign(o.size(), 0);
  std::swap(now_, before_);
  now_.slips.clear();
  now_.energy = 0;
  now_.friction_loss = before_.friction_loss;

  auto old = before_.slips.begin();
  for (size_t first = 0, end; first < contacts.size(); first = end) {
    end = end_of(o, contacts, first);
    const auto [edge, partner] = key_of(o, contacts[first]);
    EdgeSlip slip{edge, partner, 0, 0};
    const int body = o.body[slip.edge], other = o.body[contacts[first].face];
    const Friction& friction = table_.between(body, other);
    if (!(friction.coefficient > 0)) continue;

    double normal = 0, rate = 0;
    for (size_t i = first; i < end; ++i) {
      const EdgeFaceContact& c = contacts[i];
      const double weight = contact.slope(c) * o.length[c.edge];
      normal += weight * c.piece.sum;
      slip.stiffness += friction.tangential_stiffness * contact.thickness() /
                        o.bodies[other].reference * (c.piece.to - c.piece.from) * o.length[c.edge];
      const SlipRate k = slip_rate(o, c, weight);
      const int p = c.edge, q = o.next[p], a = c.face, b = o.next[a];
      const double x = k.p * vx_[p] + k.q * vx_[q] + k.a * vx_[a] + k.b * vx_[b];
      const double y = k.p * vy_[p] + k.q * vy_[q] + k.a * vy_[a] + k.b * vy_[b];
      rate += o.tx[a] * x + o.ty[a] * y +
              k.couple * (o.tx[a] * (vy_[b] - vy_[a]) - o.ty[a] * (vx_[b] - vx_[a]));
    }
    while (old != before_.slips.end() && old->key() < slip.key()) ++old;
    const bool known = old != before_.slips.end() && old->key() == slip.key();
    if (!(normal > 0)) continue;
    // New contact joins without a slip of its own; contact that ends takes its share along.
    const double spring = known ? old->spring * std::min(1., slip.stiffness / old->stiffness) : 0;
    const double limit = friction.coefficient * normal;
    slip.spring = std::clamp(spring - slip.stiffness * (rate / normal * dt), -limit, limit);
    if (known) ++old;
    now_.slips.push_back(slip);
    now_.energy += slip.energy();

    for (size_t i = first; i < end; ++i) {
      const EdgeFaceContact& c = contacts[i];
      const SlipRate k =
          slip_rate(o, c, contact.slope(c) * o.length[c.edge] * slip.spring / normal);
      const int p = c.edge, q = o.next[p], a = c.face, b = o.next[a];
      const double tx = o.tx[a], ty = o.ty[a];
      fx_[p] += k.p * tx, fy_[p] += k.p * ty;
      fx_[q] += k.q * tx, fy_[q] += k.q * ty;
      fx_[a] += k.a * tx + k.couple * ty, fy_[a] += k.a * ty - k.couple * tx;
      fx_[b] += k.b * tx - k.couple * ty, fy_[b] += k.b * ty + k.couple * tx;
    }
  }
  // What the bodies lose between the two forces, and the springs do not store.
  now_.friction_loss -= dt / 2 * (power_before + power());
  now_.friction_loss -= now_.energy - before_.energy;
}

// Of the forces on the bodies, W.
double DeformableFriction::power() const {
  double sum = 0;
  for (size_t i = 0; i < fx_.size(); ++i) sum += fx_[i] * vx_[i] + fy_[i] * vy_[i];
  return sum;
}

void DeformableFriction::add_forces(const DeformableContact& contact,
                                    std::span<double> node_force) const {
  const Outlines& o = contact.outlines();
  for (int i = 0; i < o.size(); ++i) {
    if (o.node[i] < 0) continue;
    node_force[2 * static_cast<size_t>(o.node[i])] += fx_[i];
    node_force[2 * static_cast<size_t>(o.node[i]) + 1] += fy_[i];
  }
}

// The part of its spring's force that each contact has, along the face on the edge's body.
template <class Use>
void DeformableFriction::each_share(const DeformableContact& contact, Use&& use) const {
  const Outlines& o = contact.outlines();
  const std::vector<EdgeFaceContact>& contacts = contact.contacts();
  auto slip = now_.slips.begin();
  for (size_t first = 0, end; first < contacts.size() && slip != now_.slips.end(); first = end) {
    end = end_of(o, contacts, first);
    if (slip->key() != key_of(o, contacts[first])) continue;
    double normal = 0;
    for (size_t i = first; i < end; ++i) {
      normal += contact.slope(contacts[i]) * contacts[i].piece.sum;
    }
    for (size_t i = first; i < end; ++i) {
      use(i, slip->spring * contact.slope(contacts[i]) * contacts[i].piece.sum / normal);
    }
    ++slip;
  }
}

double DeformableFriction::size(const DeformableContact& contact, int body) const {
  const Outlines& o = contact.outlines();
  double sum = 0;
  for (const EdgeSlip& slip : now_.slips) {
    const int own = o.body[slip.edge];
    const int other = o.bodies[own].rigid() ? o.body[slip.partner] : slip.partner;
    if (own == body || other == body) sum += std::abs(slip.spring);
  }
  return sum;
}

void DeformableFriction::add_to(const DeformableContact& contact,
                                std::vector<BodyContact>& contacts) const {
  const Outlines& o = contact.outlines();
  const std::vector<int> patch = contact.patches();
  each_share(contact, [&](size_t i, double force) {
    const EdgeFaceContact& c = contact.contacts()[i];
    BodyContact& found = contacts[patch[i]];
    found.friction +=
        (o.body[c.edge] == found.a ? force : -force) * Vec2(o.tx[c.face], o.ty[c.face]);
  });
}

// The faces look the other way.
void DeformableFriction::tractions(const DeformableContact& contact,
                                   std::vector<double>& traction) const {
  const Outlines& o = contact.outlines();
  traction.assign(o.size(), 0);
  each_share(contact, [&](size_t k, double force) {
    const EdgeFaceContact& c = contact.contacts()[k];
    for (const int i : {c.edge, c.face}) {
      traction[i] -= force / (o.length[i] * contact.thickness());
    }
  });
}

}  // namespace apothem
