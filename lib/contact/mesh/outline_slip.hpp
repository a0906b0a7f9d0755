// The slip of edges against faces, and the friction forces on the vertices, for several contacts at
// a time. This header is private to outline_friction, whose header includes it for its types.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "lib/contact/mesh/edge_face_blocks.hpp"
#include "lib/execution/pack.hpp"

namespace apothem {

/// The friction on a vertex, x and y, N.
using VertexDrag = std::array<double, 2>;

/// The slips of the contacts of a block. A force on the edge is distributed to both ends of the
/// edge and of the face. With the unit tangent t of the face and its inward normal n, the part of
/// the force along t also acts on the ends of the face along n. All entries are 0 where there is no
/// contact.
struct OutlineSlip {
  using Numbers = EdgeFaceBlock::Numbers;
  /// Coefficients of the slip rate, weighted with the pressure, N. `turn` is the one along n.
  Numbers at_p, at_q, at_b, turn;
  /// The slip rate of the edge against the face, times the normal force, N m/s.
  Numbers rate_x, rate_y;
};

/// Finds the slips, which do not depend on the springs. `velocities` has x and y of all vertices,
/// interleaved, m/s.
APOTHEM_INLINE void find_slip(const EdgeFaceBlock& block, const EdgeFaceTouch& touch,
                              const std::vector<double>& velocities, OutlineSlip& slip) {
  using Pack = PackOf<kBlock>;
  const auto load = [](const EdgeFaceTouch::Numbers& from)
                        APOTHEM_LAMBDA { return Pack::load(from.data()); };
  struct Velocity {
    Pack x, y;
  };
  const auto velocity = [&](const EdgeFaceBlock::Vertices& i) APOTHEM_LAMBDA {
    using TwoNumbers = double __attribute__((vector_size(16)));
    const auto vertex_velocity = [&](size_t l) APOTHEM_LAMBDA {
      TwoNumbers v;
      std::memcpy(&v, &velocities[2 * static_cast<size_t>(i[l])], sizeof v);
      return v;
    };
    const Pack::Vector low =
        __builtin_shufflevector(vertex_velocity(0), vertex_velocity(1), 0, 1, 2, 3);
    const Pack::Vector high =
        __builtin_shufflevector(vertex_velocity(2), vertex_velocity(3), 0, 1, 2, 3);
    return Velocity{Pack(__builtin_shufflevector(low, high, 0, 2, 4, 6)),
                    Pack(__builtin_shufflevector(low, high, 1, 3, 5, 7))};
  };
  const Pack depth = load(touch.sum), moment = load(touch.first);
  const Pack tx = load(touch.tx), ty = load(touch.ty), edge_length = load(touch.edge_length);
  const Pack start = load(touch.start), rise = load(touch.rise);

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
  const Pack turning = turn * (tx * fy - ty * fx);

  const auto put = [](OutlineSlip::Numbers& numbers, const Pack& number)
                       APOTHEM_LAMBDA { number.store(numbers.data()); };
  put(slip.at_p, at_p), put(slip.at_q, first), put(slip.at_b, on_b), put(slip.turn, turn);
  put(slip.rate_x, x + turning * tx), put(slip.rate_y, y + turning * ty);
}

/// The friction on the edges of a block over the normal forces of their springs.
struct SlipPull {
  EdgeFaceBlock::Numbers x, y;
};

/// The forces of a block on its vertices. For each lane one pack holds x and y on p, x and y on q,
/// and another one those on a and b.
struct SlipForces {
  FourOf<PackOf<4>> edge, face;
};

/// Finds the forces on the vertices, which are the friction times the coefficients of the slip
/// rate.
APOTHEM_INLINE void find_drags(const EdgeFaceTouch& touch, const OutlineSlip& slip,
                               const SlipPull& pull, SlipForces& forces) {
  using Pack = PackOf<kBlock>;
  const auto load = [](const EdgeFaceTouch::Numbers& from)
                        APOTHEM_LAMBDA { return Pack::load(from.data()); };
  const Pack tx = load(touch.tx), ty = load(touch.ty), x = load(pull.x), y = load(pull.y);
  const Pack at_p = load(slip.at_p), at_q = load(slip.at_q), at_b = load(slip.at_b);
  const Pack at_a = at_b - (at_p + at_q), turn = (x * tx + y * ty) * load(slip.turn);
  transpose({x * at_p, y * at_p, x * at_q, y * at_q}, forces.edge);
  transpose(
      {x * at_a + turn * ty, y * at_a - turn * tx, -(x * at_b + turn * ty), turn * tx - y * at_b},
      forces.face);
}

/// Calls f(vertex, x, y) for each force in turn; contacts may share vertices.
template <class F>
APOTHEM_INLINE void each_drag(const EdgeFaceBlock& block, const SlipForces& forces, const F& f) {
  for (size_t l = 0; l < kBlock; ++l) {
    const auto &edge = forces.edge[l].v, &face = forces.face[l].v;
    f(block.p[l], edge[0], edge[1]);
    f(block.q[l], edge[2], edge[3]);
    f(block.a[l], face[0], face[1]);
    f(block.b[l], face[2], face[3]);
  }
}

}  // namespace apothem
