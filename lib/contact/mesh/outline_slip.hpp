// The slip of edges along faces, and the dashpots across them, for several contacts at a time.
// Private to outline_friction.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "lib/contact/law/coulomb_spring.hpp"
#include "lib/contact/mesh/edge_face_blocks.hpp"
#include "lib/execution/pack.hpp"

namespace apothem {

/// What acts on the vertices: of each x and y of the friction of springs, then x and y of the
/// forces of dashpots, N.
using VertexDrag = std::array<double, 4>;

/// What is known of the slips of a block. With t, the unit tangent of the face, and n its inward
/// normal: t counts at both ends of the edge and of the face, n at the ends of the face. All are 0
/// where there is no contact.
struct OutlineSlip {
  using Numbers = EdgeFaceBlock::Numbers;
  /// Coefficients of the slip rate, weighted with the pressure, N; `turn` counts along n.
  Numbers at_p, at_q, at_b, turn;
  Numbers rate;             ///< of the slip, times the normal force, N m/s
  Numbers approach;         ///< rate of the edge towards the face, likewise
  Numbers push, push_at_q;  ///< of the dashpots across the face, and what q has of it, N
  Numbers push_power;       ///< of these dashpots on the bodies, W
};

/// Sums over the contacts of a spring.
struct SlipSums {
  enum { normal, rate, stiffness, push };  // N, N m/s, N/m, N
};

/// Finds what does not depend on springs. `velocities` of the vertices, interleaved, m/s; `times`:
/// strength of the dashpots across the faces, s, if there are any. Writes the addends of the sums
/// of each lane to `addends`.
APOTHEM_INLINE void find_slip(const EdgeFaceBlock& block, const EdgeFaceTouch& touch,
                              const std::vector<double>& velocities,
                              const std::array<double, kBlock>* times, OutlineSlip& slip,
                              std::array<double, 4>* addends) {
  using Pack = PackOf<kBlock>;
  const auto load = [](const EdgeFaceTouch::Numbers& from)
                        APOTHEM_LAMBDA { return Pack::load(from.data()); };
  struct Velocity {
    Pack x, y;
  };
  const auto velocity = [&](const EdgeFaceBlock::Vertices& i) APOTHEM_LAMBDA {
    using Pair = double __attribute__((vector_size(16)));
    const auto of = [&](size_t l) APOTHEM_LAMBDA {
      Pair v;
      std::memcpy(&v, &velocities[2 * static_cast<size_t>(i[l])], sizeof v);
      return v;
    };
    const Pack::Vector low = __builtin_shufflevector(of(0), of(1), 0, 1, 2, 3);
    const Pack::Vector high = __builtin_shufflevector(of(2), of(3), 0, 1, 2, 3);
    return Velocity{Pack(__builtin_shufflevector(low, high, 0, 2, 4, 6)),
                    Pack(__builtin_shufflevector(low, high, 1, 3, 5, 7))};
  };
  const Pack from = load(touch.from), to = load(touch.to);
  const Pack depth = load(touch.sum), moment = load(touch.first);
  const Pack tx = load(touch.tx), ty = load(touch.ty), edge_length = load(touch.edge_length);
  const Pack start = load(touch.start), rise = load(touch.rise);
  const Pack part = to - from, length = part * edge_length;

  const Pack weight = load(block.slope) * edge_length;
  const Pack sum = weight * depth, first = weight * moment;
  const Pack on_b = start * sum + rise * first;
  const Pack turn = load(touch.height) * sum + load(touch.climb) * first;
  const Pack at_p = sum - first, at_a = on_b - sum;

  const Velocity p = velocity(block.p), q = velocity(block.q);
  const Velocity a = velocity(block.a), b = velocity(block.b);
  const Pack fx = b.x - a.x, fy = b.y - a.y;
  const Pack x = at_p * p.x + first * q.x + at_a * a.x - on_b * b.x;
  const Pack y = at_p * p.y + first * q.y + at_a * a.y - on_b * b.y;
  const Pack rate = tx * x + ty * y + turn * (tx * fy - ty * fx), zero(0.);

  const auto put = [](OutlineSlip::Numbers& numbers, const Pack& number)
                       APOTHEM_LAMBDA { number.store(numbers.data()); };
  put(slip.at_p, at_p), put(slip.at_q, first), put(slip.at_b, on_b), put(slip.turn, turn);
  put(slip.rate, rate), put(slip.approach, tx * y - ty * x);
  Pack push = zero, push_at_q = zero, push_power = zero;
  if (times) {
    // Dashpots in the two points of Gauss, which are exact for what is linear along the piece.
    constexpr double kGauss = .57735026918962576451;
    const Pack half(.5), time = load(*times), per_part = Pack(1.) / part;
    const Pack middle = from + part * half, mean = depth * per_part;  // of u, and of the depth
    const Pack steepness = Pack(12.) * (moment - middle * depth) * (per_part * per_part * per_part);
    // How fast the edge closes in on the face, along the inward normal (-ty, tx), is linear in u.
    const Pack x0 = p.x - a.x - start * fx, y0 = p.y - a.y - start * fy;
    const Pack x1 = q.x - p.x - rise * fx, y1 = q.y - p.y - rise * fy;
    const Pack closing = tx * y0 - ty * x0, change = tx * y1 - ty * x1;
    const Pack share = weight * part * half;
    Pack at_both = zero, at_end = zero, power = zero;
    for (const double point : {-kGauss, kGauss}) {
      const Pack off = Pack(.5 * point) * part, u = middle + off;
      const Pack at_u = mean + steepness * off, speed = closing + u * change;
      const Pack resists = time * speed;
      const Pack force = share * select(resists < -at_u, -at_u, resists);
      at_both += force;
      at_end += u * force;
      power += force * speed;
    }
    const auto acts = (time > zero) & (part > zero) & (depth > zero);
    push = select(acts, at_both, zero);
    push_at_q = select(acts, at_end, zero);
    push_power = select(acts, -power, zero);
  }
  put(slip.push, push), put(slip.push_at_q, push_at_q), put(slip.push_power, push_power);
  write_rows({sum, rate, load(block.spring) * length, push},
             [&](int l) APOTHEM_LAMBDA { return addends[l].data(); });
}

/// Springs and dashpots along faces, and the forces in them over the normal force.
struct SlipSprings {
  using Numbers = EdgeFaceBlock::Numbers;
  Numbers force, energy;      ///< of the springs, N and J
  Numbers friction, dashpot;  ///< forces over the normal force
  unsigned lanes;             ///< one bit for each that has a spring
};

/// What is known of springs before a step, four at a time.
struct SlipMemory {
  using Numbers = EdgeFaceBlock::Numbers;
  Numbers force, stiffness;  ///< in the step before, N and N/m; of new ones 0 and 1
  Numbers coefficient;       ///< of friction
  Numbers time;              ///< strength of the dashpots along the face, s
};

/// Finds springs and dashpots after a slip of dt (s). `sums` are SlipSums. `beyond`: how far forces
/// may be above their limits, N.
APOTHEM_INLINE void find_springs(const FourOf<PackOf<kBlock>>& sums, const SlipMemory& memory,
                                 double dt, double beyond, SlipSprings& springs) {
  using Pack = PackOf<kBlock>;
  const Pack zero(0.), one(1.);
  const Pack &normal = sums[SlipSums::normal], &stiffness = sums[SlipSums::stiffness];
  const Pack mu = Pack::load(memory.coefficient.data()), time = Pack::load(memory.time.data());
  const auto exists = (mu > zero) & (normal > zero);
  const Pack above = normal + sums[SlipSums::push];
  const CoulombSpring<Pack> spring{stiffness,
                                   mu * select(above < zero, zero, above) + Pack(beyond)};
  // New contact joins without a slip of its own; contact that ends takes its share along.
  const Pack ratio = stiffness / Pack::load(memory.stiffness.data());
  const Pack before = Pack::load(memory.force.data()) * select(ratio < one, ratio, one);
  const Pack per_normal = one / normal, slip = sums[SlipSums::rate] * per_normal;  // m/s
  const Pack force = spring.after(before, slip * Pack(dt));
  const Pack dashpot = select(time > zero, spring.dashpot(force, time, slip), zero);
  const Pack energy = select(stiffness > zero, force * force / (Pack(2.) * stiffness), zero);
  const auto put = [&](OutlineSlip::Numbers& numbers, const Pack& number)
                       APOTHEM_LAMBDA { select(exists, number, zero).store(numbers.data()); };
  put(springs.force, force), put(springs.energy, energy);
  put(springs.friction, force * per_normal), put(springs.dashpot, dashpot * per_normal);
  springs.lanes = bits(exists);
}

/// The forces of a block on its vertices p, q, a and b: a pack is the VertexDrag of a lane.
struct SlipForces {
  FourOf<PackOf<4>> p, q, a, b;
};

/// The force along a face times the coefficients of the slip rate acts on the vertices. `friction`
/// and `dashpot`: forces along the tangent over the normal force.
APOTHEM_INLINE void find_drags(const EdgeFaceTouch& touch, const OutlineSlip& slip,
                               const PackOf<kBlock>& friction, const PackOf<kBlock>& dashpot,
                               SlipForces& forces) {
  using Pack = PackOf<kBlock>;
  const auto load = [](const EdgeFaceTouch::Numbers& from)
                        APOTHEM_LAMBDA { return Pack::load(from.data()); };
  const Pack tx = load(touch.tx), ty = load(touch.ty);
  const Pack friction_x = friction * tx, friction_y = friction * ty;
  const Pack dashpot_x = dashpot * tx, dashpot_y = dashpot * ty;
  const Pack at_p = load(slip.at_p), at_q = load(slip.at_q), at_b = load(slip.at_b);
  const Pack turn = load(slip.turn), push = load(slip.push), on_q = load(slip.push_at_q);
  const Pack on_p = push - on_q;
  transpose({friction_x * at_p, friction_y * at_p, dashpot_x * at_p + on_p * ty,
             dashpot_y * at_p - on_p * tx},
            forces.p);
  transpose({friction_x * at_q, friction_y * at_q, dashpot_x * at_q + on_q * ty,
             dashpot_y * at_q - on_q * tx},
            forces.q);
  const Pack on_b = load(touch.start) * push + load(touch.rise) * on_q;
  const Pack on_a = on_b - push, at_a = at_b - (at_p + at_q);
  transpose({friction_x * at_a + friction_y * turn, friction_y * at_a - friction_x * turn,
             dashpot_x * at_a + (dashpot_y * turn + on_a * ty),
             dashpot_y * at_a - (dashpot_x * turn + on_a * tx)},
            forces.a);
  transpose({-(friction_x * at_b + friction_y * turn), friction_x * turn - friction_y * at_b,
             -(dashpot_x * at_b + (dashpot_y * turn + on_b * ty)),
             dashpot_x * turn - dashpot_y * at_b + on_b * tx},
            forces.b);
}

APOTHEM_INLINE void add(const PackOf<4>& force, VertexDrag& to) {
  (PackOf<4>::load(to.data()) + force).store(to.data());
}

/// Calls f(vertex, force) for each of them, one after the other because they may share
/// vertices.
template <class F>
APOTHEM_INLINE void each_drag(const EdgeFaceBlock& block, const SlipForces& forces, const F& f) {
  for (size_t l = 0; l < kBlock; ++l) {
    f(block.p[l], forces.p[l]);
    f(block.q[l], forces.q[l]);
    f(block.a[l], forces.a[l]);
    f(block.b[l], forces.b[l]);
  }
}

}  // namespace apothem
