// The slip of edges along faces, and the dashpots across them, for several contacts at a time.
// Private to outline_friction.
#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "apothem/contact/edge_face.hpp"
#include "apothem/contact/outlines.hpp"
#include "apothem/execution/pack.hpp"

namespace apothem {

/// Numbers that each contact has, kLanes contacts side by side.
class OutlineSlips {
 public:
  /// An edge from p to q against a face from a to b. With t, the unit tangent of the face, and n
  /// its inward normal: t counts at both ends of the edge and of the face, n at the ends of the
  /// face. The coefficients at_p to couple are weighted with the pressure.
  enum Number {
    tx,
    ty,
    at_p,
    at_q,
    at_a,
    at_b,
    couple,
    start,      ///< the foot of the edge's point u, from 0 at p to 1 at q, is at the share
    rise,       ///< start + u rise of the face
    push,       ///< of the dashpots, against the face, N
    push_at_q,  ///< what q has of it
    normal,     ///< force, N
    length,     ///< of the contact, m
    stiffness,  ///< of the spring, N/m
    rate,       ///< of the slip, and
    approach,   ///< of the edge towards the face; both times the normal force, N m/s
    depth,      ///< times the length, m^2
    friction,   ///< along the tangent over the normal force: of the spring, and
    dashpot,    ///< of the dashpot beside it
    numbers
  };
  struct Ends {
    std::int32_t p, q, a, b;
  };

  /// Makes room for so many contacts; what they had is lost.
  void resize(size_t contacts) {
    if (ends_.size() >= contacts) return;
    ends_.resize(contacts);
    values_.resize((contacts + kLanes - 1) / kLanes * kLanes * numbers);
  }
  [[nodiscard]] Ends& ends(size_t contact) { return ends_[contact]; }
  /// A number of contacts from this one on, as many as a pack has that begins here.
  [[nodiscard]] double* at(size_t contact, Number number) {
    return &values_[contact / kLanes * kLanes * numbers + static_cast<size_t>(number) * kLanes +
                    contact % kLanes];
  }
  [[nodiscard]] double of(size_t contact, Number number) { return *at(contact, number); }

 private:
  std::vector<Ends> ends_;
  std::vector<double> values_;
};

/// Finds what does not depend on springs, of the contacts from `first` on: as many as there are
/// lanes, or fewer at the end. They get their places from `place` on, a multiple of the lanes.
/// `velocities` of the vertices, interleaved, m/s; `times`: strength of
/// the dashpots across the faces, s.
template <int lanes>
APOTHEM_INLINE void find_slips(const Outlines& o, std::span<const EdgeFaceContact> contacts,
                               std::span<const EdgeFaceLaw> laws,
                               const std::vector<double>& velocities,
                               const std::array<double, lanes>& times, size_t first, size_t place,
                               OutlineSlips& slips) {
  using Pack = PackOf<lanes>;
  using S = OutlineSlips;
  std::array<const EdgeFaceContact*, lanes> of;
  std::array<std::int32_t, lanes> p, q, a, b;
  bool damped = false;
  for (size_t l = 0; l < lanes; ++l) {
    const size_t i = std::min(first + l, contacts.size() - 1);
    of[l] = &contacts[i];
    p[l] = of[l]->edge, a[l] = of[l]->face;
    q[l] = o.next[p[l]], b[l] = o.next[a[l]];
    slips.ends(place + i - first) = {p[l], q[l], a[l], b[l]};
    damped = damped || times[l] > 0;
  }
  const auto at = [](const std::vector<double>& from, const std::array<std::int32_t, lanes>& i)
      __attribute__((always_inline)) {
    return pack_of<lanes>([&](size_t l) __attribute__((always_inline)) {
      return from[static_cast<size_t>(i[l])];
    });
  };
  const auto velocity = [&](const std::array<std::int32_t, lanes>& i, size_t axis)
      __attribute__((always_inline)) {
    return pack_of<lanes>([&](size_t l) __attribute__((always_inline)) {
      return velocities[2 * static_cast<size_t>(i[l]) + axis];
    });
  };
  const auto piece = [&](double CollarPiece<double>::*number) __attribute__((always_inline)) {
    return pack_of<lanes>([&](size_t l)
                              __attribute__((always_inline)) { return of[l]->piece.*number; });
  };
  const auto put = [&](S::Number number, const Pack& value) __attribute__((always_inline)) {
    value.store(slips.at(place, number));
  };
  const Pack from = piece(&CollarPiece<double>::from), to = piece(&CollarPiece<double>::to);
  const Pack depth = piece(&CollarPiece<double>::sum), moment = piece(&CollarPiece<double>::first);
  const Pack slope =
      pack_of<lanes>([&](size_t l) __attribute__((always_inline)) { return of[l]->slope; });
  const Pack spring = pack_of<lanes>([&](size_t l) __attribute__((always_inline)) {
    return laws[static_cast<size_t>(of[l]->pair)].spring;
  });
  const Pack tx = at(o.tx, a), ty = at(o.ty, a), edge_length = at(o.length, p);
  const Pack px0 = at(o.x, p), py0 = at(o.y, p);

  const Pack scale = Pack(1.) / at(o.length, a);
  const Pack px = (px0 - at(o.x, a)) * scale, py = (py0 - at(o.y, a)) * scale;
  const Pack dx = (at(o.x, q) - px0) * scale, dy = (at(o.y, q) - py0) * scale;
  const Pack start = tx * px + ty * py, rise = tx * dx + ty * dy;
  const Pack weight = slope * edge_length;
  const Pack sum = weight * depth, first_moment = weight * moment;
  const Pack on_b = start * sum + rise * first_moment;
  const Pack couple = (tx * py - ty * px) * sum + (tx * dy - ty * dx) * first_moment;
  const Pack at_p = sum - first_moment, at_q = first_moment, at_a = on_b - sum, at_b = -on_b;

  const Pack vpx = velocity(p, 0), vpy = velocity(p, 1), vqx = velocity(q, 0), vqy = velocity(q, 1);
  const Pack vax = velocity(a, 0), vay = velocity(a, 1), vbx = velocity(b, 0), vby = velocity(b, 1);
  const Pack fx = vbx - vax, fy = vby - vay;
  const Pack x = at_p * vpx + at_q * vqx + at_a * vax + at_b * vbx;
  const Pack y = at_p * vpy + at_q * vqy + at_a * vay + at_b * vby;
  const Pack length = (to - from) * edge_length;

  put(S::tx, tx), put(S::ty, ty);
  put(S::at_p, at_p), put(S::at_q, at_q), put(S::at_a, at_a), put(S::at_b, at_b);
  put(S::couple, couple), put(S::start, start), put(S::rise, rise);
  put(S::normal, at_p + at_q), put(S::length, length), put(S::stiffness, spring * length);
  put(S::rate, tx * x + ty * y + couple * (tx * fy - ty * fx));
  put(S::approach, tx * y - ty * x), put(S::depth, depth * edge_length);
  put(S::friction, Pack(0.)), put(S::dashpot, Pack(0.));
  if (!damped) {
    put(S::push, Pack(0.)), put(S::push_at_q, Pack(0.));
    return;
  }

  // Dashpots in the two points of Gauss, which are exact for what is linear along the piece.
  constexpr double kGauss = .57735026918962576451;
  const Pack zero(0.), two(2.), time = Pack::load(times.data());
  const Pack part = to - from;
  const Pack middle = from + part / two, mean = depth / part;  // of u, and of the depth
  const Pack steepness = Pack(12.) * (moment - middle * depth) / (part * part * part);
  // How fast the edge closes in on the face, along the inward normal (-ty, tx), is linear in u.
  const Pack x0 = vpx - vax - start * fx, y0 = vpy - vay - start * fy;
  const Pack x1 = vqx - vpx - rise * fx, y1 = vqy - vpy - rise * fy;
  const Pack closing = tx * y0 - ty * x0, change = tx * y1 - ty * x1;
  const Pack share = slope * edge_length * part / two;
  Pack push = zero, push_at_q = zero;
  for (const double point : {-kGauss, kGauss}) {
    const Pack u = middle + Pack(point) * part / two;
    const Pack at_u = mean + steepness * (u - middle);
    const Pack resists = time * (closing + u * change);
    const Pack force = share * select(resists < -at_u, -at_u, resists);
    push += force;
    push_at_q += u * force;
  }
  const auto acts = (time > zero) & (part > zero) & (depth > zero);
  put(S::push, select(acts, push, zero));
  put(S::push_at_q, select(acts, push_at_q, zero));
}

/// Forces on vertices, interleaved, N.
using VertexForces = std::vector<double>;

/// Adds to the forces on the vertices from `first` to `end` - 1 those of some contacts, one after
/// the other because they may share vertices: of the springs to `friction`, of the dashpots to
/// `damping`, which may be empty. The force along a face times the coefficients of the slip rate
/// acts on the vertices.
template <int lanes>
APOTHEM_INLINE void add_slip_forces(OutlineSlips& slips, size_t contact, size_t count,
                                    std::int32_t first, std::int32_t end, VertexForces& friction,
                                    VertexForces& damping) {
  using Pack = PackOf<lanes>;
  using S = OutlineSlips;
  using Pair = double __attribute__((vector_size(16)));
  const auto get = [&](S::Number number) __attribute__((always_inline)) {
    return Pack::load(slips.at(contact, number));
  };
  const auto any_of = [&](S::Number number) __attribute__((always_inline)) {
    const double* const each = slips.at(contact, number);
    bool any = false;
    for (size_t l = 0; l < count; ++l) any = any || each[l] != 0;
    return any;
  };
  struct Forces {
    std::array<std::array<double, lanes>, 8> of;  // x and y on p, q, a and b
    APOTHEM_INLINE void put(size_t vertex, const Pack& x, const Pack& y) {
      x.store(of[2 * vertex].data());
      y.store(of[2 * vertex + 1].data());
    }
  };
  const auto add = [&](const Forces& forces, size_t l, VertexForces& to)
      __attribute__((always_inline)) {
    const S::Ends& e = slips.ends(contact + l);
    const auto add_to = [&](std::int32_t vertex, size_t k) __attribute__((always_inline)) {
      double* const f = &to[2 * static_cast<size_t>(vertex)];
      const Pair sum = Pair{f[0], f[1]} + Pair{forces.of[2 * k][l], forces.of[2 * k + 1][l]};
      f[0] = sum[0], f[1] = sum[1];
    };
    if (e.p >= first && e.p < end) add_to(e.p, 0), add_to(e.q, 1);
    if (e.a >= first && e.a < end) add_to(e.a, 2), add_to(e.b, 3);
  };
  const Pack tx = get(S::tx), ty = get(S::ty);
  const auto drag = [&](S::Number number, Forces & to) __attribute__((always_inline)) {
    const Pack force = get(number), on_p = force * get(S::at_p), on_q = force * get(S::at_q);
    const Pack on_a = force * get(S::at_a), on_b = force * get(S::at_b);
    const Pack turn = force * get(S::couple);
    to.put(0, on_p * tx, on_p * ty);
    to.put(1, on_q * tx, on_q * ty);
    to.put(2, on_a * tx + turn * ty, on_a * ty - turn * tx);
    to.put(3, on_b * tx - turn * ty, on_b * ty + turn * tx);
  };
  const auto acts = [&](S::Number number, size_t l) __attribute__((always_inline)) {
    return slips.at(contact, number)[l] != 0;
  };
  Forces along, across;
  if (any_of(S::friction)) {
    drag(S::friction, along);
    for (size_t l = 0; l < count; ++l) {
      if (acts(S::friction, l)) add(along, l, friction);
    }
  }
  if (damping.empty()) return;
  const bool dragged = any_of(S::dashpot), pushed = any_of(S::push) || any_of(S::push_at_q);
  if (dragged) drag(S::dashpot, along);
  if (pushed) {
    const Pack push = get(S::push), push_at_q = get(S::push_at_q), on_p = push - push_at_q;
    const Pack on_b = get(S::start) * push + get(S::rise) * push_at_q, on_a = on_b - push;
    across.put(0, on_p * ty, -(on_p * tx));
    across.put(1, push_at_q * ty, -(push_at_q * tx));
    across.put(2, on_a * ty, -(on_a * tx));
    across.put(3, -(on_b * ty), on_b * tx);
  }
  for (size_t l = 0; l < count; ++l) {
    if (dragged && acts(S::dashpot, l)) add(along, l, damping);
    if (pushed && (acts(S::push, l) || acts(S::push_at_q, l))) add(across, l, damping);
  }
}

}  // namespace apothem
