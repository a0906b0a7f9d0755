// Edges against faces, several at a time: which of them meet, and the forces between them. This
// header is private to outline_kernel, whose header includes it for its types.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <span>
#include <utility>
#include <vector>

#include "geometry/integrals/collar.hpp"
#include "lib/contact/mesh/edge_face_blocks.hpp"
#include "lib/contact/surface/outline_surfaces.hpp"

namespace apothem {

/// The normal forces of the candidates of a block, N. Each lane has the forces on the start and the
/// end of its edge, then those on its face; they are 0 where the edge does not meet the face.
using EdgeFacePushes = std::array<FourOf<double>, kBlock>;

/// The forces on the two ends of an edge.
using EndForces = std::array<double, 2>;
APOTHEM_INLINE void add(const EndForces& force, EndForces& sum) {
  using TwoNumbers = double __attribute__((vector_size(16)));
  const TwoNumbers both = TwoNumbers{sum[0], sum[1]} + TwoNumbers{force[0], force[1]};
  sum[0] = both[0], sum[1] = both[1];
}

/// Calls f(edge, EndForces) for the edges of a block and the bases of its faces.
template <class F>
APOTHEM_INLINE void each_push(const EdgeFaceBlock& block, const EdgeFacePushes& pushes,
                              const F& f) {
  for (size_t l = 0; l < kBlock; ++l) {
    f(block.p[l], EndForces{pushes[l][0], pushes[l][1]});
    f(block.a[l], EndForces{pushes[l][2], pushes[l][3]});
  }
}

using EdgeFaceCrossings = std::vector<std::pair<EdgeFace, CollarCrossings<double>>>;

namespace edge_face_detail {

using Pack = PackOf<kBlock>;

/// Evaluates one candidate that may reach the saturated region of the collar.
inline void find_general(const OutlineSurfaces& o, const EdgeFaceBlock& block, size_t l,
                         EdgeFaceTouch& touch, unsigned& met, EdgeFacePushes& pushes,
                         double& deepest, EdgeFaceCrossings& all_crossings) {
  const std::int32_t p = block.p[l], q = block.q[l], a = block.a[l];
  const CollarFace<double> face = o.face(a);
  CollarPiece<double> piece;
  CollarCrossings<double> crossings;
  if (!general_collar_piece(face, o.x[p], o.y[p], o.x[q], o.y[q], piece, crossings)) return;
  const EdgeFaceForces<double> f =
      edge_face_forces(piece, block.slope[l], o.length[p], 1 / face.length);
  pushes[l] = {f.edge_start, f.edge_end, f.face_start, f.face_end};
  if (crossings.count > 0) all_crossings.emplace_back(EdgeFace{p, a}, crossings);
  if (piece.deepest <= block.nothing[l]) return;
  met |= 1U << l;
  touch.from[l] = piece.from, touch.to[l] = piece.to;
  touch.sum[l] = piece.sum, touch.first[l] = piece.first, touch.deepest[l] = piece.deepest;
  const double beyond = std::max(0., std::max(-face.alpha(), face.beta()));
  deepest = std::max(deepest, piece.deepest * piece.deepest * (1 + beyond * beyond));
}

}  // namespace edge_face_detail

/// Finds the contacts of a unit. Calls push(block, pushes) for the blocks in which an edge meets
/// its face.
template <class Push>
APOTHEM_INLINE void find_meetings(const OutlineSurfaces& o, EdgeFaceBlocks& all, EdgeFaceUnit& unit,
                                  EdgeFaceCrossings& crossings, const Push& push) {
  using edge_face_detail::Pack;
  using Vertices = EdgeFaceBlock::Vertices;
  const Pack zero(0.), one(1.);
  Pack deepest(0.);  // squares of upper bounds
  double general_deepest = 0;
  int touching = 0;
  for (std::int32_t i = unit.first_law; i < unit.end_law; ++i) all.forces()[i].setZero();
  for (std::int32_t i = unit.first; i < unit.end; ++i) {
    const EdgeFaceBlock& block = all.blocks()[i];
    const auto gathered = [](const std::vector<double>& values, const Vertices& v) APOTHEM_LAMBDA {
      return pack_of<kBlock>([&](size_t l)
                                 APOTHEM_LAMBDA { return values[static_cast<size_t>(v[l])]; });
    };
    const CollarFace<Pack> face{gathered(o.x, block.a),
                                gathered(o.y, block.a),
                                gathered(o.x, block.b),
                                gathered(o.y, block.b),
                                gathered(o.tx, block.a),
                                gathered(o.ty, block.a),
                                gathered(o.length, block.a),
                                gathered(o.mx, block.a),
                                gathered(o.my, block.a),
                                gathered(o.mx, block.b),
                                gathered(o.my, block.b),
                                gathered(o.depth, block.a),
                                gathered(o.regular_depth, block.a)};
    const Pack px = gathered(o.x, block.p), py = gathered(o.y, block.p);
    const Pack qx = gathered(o.x, block.q), qy = gathered(o.y, block.q);
    const CollarPieces<Pack> piece = collar_pieces(face, px, py, qx, qy);
    unsigned general = bits(piece.general) & block.lanes;
    std::uint8_t& met = all.met()[i];
    met = 0;
    if ((bits(piece.met) | general) == 0) continue;

    const Pack edge_length = gathered(o.length, block.p), scale = one / face.length;
    const EdgeFaceForces<Pack> force =
        edge_face_forces(piece, Pack::load(block.slope.data()), edge_length, scale);
    const auto where = [&](const auto& mask, const Pack& x)
                           APOTHEM_LAMBDA { return select(mask, x, zero); };
    EdgeFacePushes pushes;
    write_rows({where(piece.met, force.edge_start), where(piece.met, force.edge_end),
                where(piece.met, force.face_start), where(piece.met, force.face_end)},
               [&](int l) APOTHEM_LAMBDA { return pushes[static_cast<size_t>(l)].data(); });

    const auto contact = piece.met & !(piece.deepest <= Pack::load(block.nothing.data()));
    EdgeFaceTouch& touch = all.touches()[i];
    const auto put = [&](EdgeFaceTouch::Numbers& numbers, const Pack& x)
                         APOTHEM_LAMBDA { x.store(numbers.data()); };
    put(touch.from, where(contact, piece.from)), put(touch.to, where(contact, piece.to));
    put(touch.sum, where(contact, piece.sum)), put(touch.first, where(contact, piece.first));
    put(touch.deepest, where(contact, piece.deepest));
    put(touch.tx, face.tx), put(touch.ty, face.ty), put(touch.edge_length, edge_length);
    const Pack x = px - face.ax, y = py - face.ay, ex = qx - px, ey = qy - py;
    put(touch.start, (face.tx * x + face.ty * y) * scale);
    put(touch.rise, (face.tx * ex + face.ty * ey) * scale);
    put(touch.height, (face.tx * y - face.ty * x) * scale);
    put(touch.climb, (face.tx * ey - face.ty * ex) * scale);

    // Where a face reaches beyond the end of its edge, at a reflex vertex, the distance from the
    // boundary may exceed the height in the face. This factor bounds their ratio.
    const Pack alpha = -face.alpha(), beta = face.beta();
    const Pack further = select(alpha < beta, beta, alpha);
    const Pack beyond = where(further > zero, further);
    const Pack square = where(contact, piece.deepest * piece.deepest * (one + beyond * beyond));
    deepest = select(square <= deepest, deepest, square);

    // The force on the body with the lower number, which acts at its edge or at its face.
    EdgeFaceTouch::Numbers lower_x, lower_y;
    const auto at_edge = Pack::load(block.edge_is_lower.data()) > zero;
    const Pack lower =
        where(piece.met, select(at_edge, (force.edge_start + force.edge_end) / edge_length,
                                force.face_start + force.face_end));
    put(lower_x, zero - select(at_edge, ey, face.ty) * lower);
    put(lower_y, select(at_edge, ex, face.tx) * lower);

    unsigned found = bits(contact);
    for (; general != 0; general &= general - 1) {
      const auto l = static_cast<size_t>(std::countr_zero(general));
      edge_face_detail::find_general(o, block, l, touch, found, pushes, general_deepest, crossings);
      const bool edge = block.edge_is_lower[l] > 0;
      const std::int32_t line = edge ? block.p[l] : block.a[l];
      const double sum = edge ? pushes[l][0] + pushes[l][1] : pushes[l][2] + pushes[l][3];
      lower_x[l] = -o.ty[line] * sum, lower_y[l] = o.tx[line] * sum;
    }
    met = static_cast<std::uint8_t>(found | EdgeFaceBlocks::kPushed);
    touching += std::popcount(found);
    if (block.one_law) {
      Vec2& force_sum = all.forces()[block.law[0]];
      force_sum = {force_sum.x() + lower_x[0] + lower_x[1] + lower_x[2] + lower_x[3],
                   force_sum.y() + lower_y[0] + lower_y[1] + lower_y[2] + lower_y[3]};
    } else {
      for (size_t l = 0; l < kBlock; ++l) {
        all.forces()[block.law[l]] += Vec2(lower_x[l], lower_y[l]);
      }
    }
    push(i, pushes);
  }
  unit.touching = touching;
  for (size_t l = 0; l < kBlock; ++l) general_deepest = std::max(general_deepest, deepest.v[l]);
  unit.deepest = general_deepest;
}

}  // namespace apothem
