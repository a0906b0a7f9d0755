// Edges against faces, several at a time: which of them meet, and the forces between them. Private
// to outline_kernel.cpp.
#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <utility>
#include <vector>

#include "apothem/contact/contact.hpp"
#include "apothem/contact/edge_face.hpp"
#include "apothem/contact/outlines.hpp"
#include "apothem/geometry/integrals/collar_pack.hpp"

namespace apothem {

/// What has been found of some candidates, in their order.
struct EdgeFaceMeetings {
  struct Push {
    std::int32_t edge, face;
    EdgeFaceForces<double> force;
  };
  std::vector<Push> pushes;
  std::vector<EdgeFaceContact> contacts;
  std::vector<Contact> records;  ///< of the same contacts
  std::vector<std::pair<EdgeFace, CollarCrossings<double>>> crossings;

  void clear() { pushes.clear(), contacts.clear(), records.clear(), crossings.clear(); }
};

namespace edge_face_detail {

constexpr double kNothing = 1e-12;  // of a collar: round-off where an edge begins on a face

/// What else is known of an edge that meets a face. Of numbers or packs.
template <class Real>
struct Meeting {
  EdgeFaceForces<Real> force;
  Real surely, at_most;  ///< bounds of the depth, m
  Real share;            ///< of the collar
  Real stiffness;        ///< N/m
};

/// `piece` has the members of CollarPiece; `alpha` and `beta`: slopes of the face's bisectors.
template <class Real, class Piece>
APOTHEM_INLINE Meeting<Real> meeting_of(const Piece& piece, const Real& slope,
                                        const Real& edge_length, const Real& face_length,
                                        const Real& depth, const Real& plain, const Real& alpha,
                                        const Real& beta) {
  const Real zero(0.), one(1.), deepest(piece.deepest);
  // The distance from the boundary over the height in a face is more than 1 where the face reaches
  // beyond the end of its edge, at a reflex vertex.
  const Real beyond = select(-alpha < beta, beta, -alpha);
  const Real ratio = select(beyond > zero, square_root(one + beyond * beyond), one);
  const Real share = deepest / depth;
  return {edge_face_forces(piece, slope, edge_length, face_length),
          select(deepest <= sure_depth(plain, depth), deepest, zero), deepest * ratio,
          select(share < one, share, one), slope * edge_length * (piece.to - piece.from)};
}

inline void add(const EdgeFace& pair, const EdgeFaceLaw& law, double depth,
                const CollarPiece<double>& piece, const Meeting<double>& m,
                EdgeFaceMeetings& found) {
  found.pushes.push_back({pair.edge, pair.face, m.force});
  if (piece.deepest <= (law.self ? kNothing * depth : 0)) return;
  found.contacts.push_back({pair.edge, pair.face, pair.pair, law.slope, piece});
  const bool known = law.self && m.surely > 0;
  found.records.push_back({outline_kernel, pair.edge, pair.face, m.surely,
                           known ? m.surely : m.at_most, m.share, m.stiffness});
}

/// One candidate that may cross the top of the collar.
inline void find_deep(const Outlines& o, const EdgeFace& pair, const EdgeFaceLaw& law,
                      EdgeFaceMeetings& found) {
  const auto [e, f, index] = pair;
  const int q = o.next[e];
  const CollarFace<double> face = o.face(f);
  CollarPiece<double> piece;
  CollarCrossings<double> top;
  if (!collar_piece(face, o.x[e], o.y[e], o.x[q], o.y[q], piece, top)) return;
  add(pair, law, face.depth, piece,
      meeting_of(piece, law.slope, o.length[e], face.length, face.depth, face.plain, face.alpha(),
                 face.beta()),
      found);
  if (top.count > 0) found.crossings.emplace_back(pair, top);
}

}  // namespace edge_face_detail

/// Appends what is found of the candidates, ascending as they are.
template <int lanes>
APOTHEM_INLINE void find_meetings(const Outlines& o, std::span<const EdgeFace> candidates,
                                  std::span<const EdgeFaceLaw> laws, EdgeFaceMeetings& found) {
  using Pack = PackOf<lanes>;
  const size_t count = candidates.size();
  for (size_t first = 0; first < count; first += lanes) {
    std::array<int, lanes> e, q, f, g;
    std::array<double, lanes> slope;
    for (size_t l = 0; l < lanes; ++l) {
      const EdgeFace& pair = candidates[std::min(first + l, count - 1)];
      e[l] = pair.edge, f[l] = pair.face;
      q[l] = o.next[pair.edge], g[l] = o.next[pair.face];
      slope[l] = laws[static_cast<size_t>(pair.pair)].slope;
    }
    const auto at = [](const std::vector<double>& of, const std::array<int, lanes>& i)
        __attribute__((always_inline)) {
      return pack_of<lanes>([&](size_t l) __attribute__((always_inline)) {
        return of[static_cast<size_t>(i[l])];
      });
    };
    const CollarFaces<Pack> face{at(o.x, f),  at(o.y, f),  at(o.x, g),      at(o.y, g),
                                 at(o.tx, f), at(o.ty, f), at(o.length, f), at(o.mx, f),
                                 at(o.my, f), at(o.mx, g), at(o.my, g),     at(o.plain, f)};
    const CollarPieces<Pack> p =
        collar_pieces(face, at(o.x, e), at(o.y, e), at(o.x, q), at(o.y, q));
    const edge_face_detail::Meeting<Pack> m =
        edge_face_detail::meeting_of(p, Pack::load(slope.data()), at(o.length, e), face.length,
                                     at(o.depth, f), face.plain, face.alpha(), face.beta());
    enum {
      from,
      to,
      sum,
      start,
      area,
      along,
      height,
      deepest,
      edge_start,
      edge_end,
      face_start,
      face_end,
      surely,
      at_most,
      share,
      stiffness,
      numbers
    };
    std::array<std::array<double, lanes>, numbers> of;
    const auto put = [&](int number, const Pack& value) __attribute__((always_inline)) {
      value.store(of[static_cast<size_t>(number)].data());
    };
    put(from, p.from), put(to, p.to), put(sum, p.sum), put(start, p.first);
    put(area, p.area), put(along, p.along), put(height, p.height), put(deepest, p.deepest);
    put(edge_start, m.force.edge_start), put(edge_end, m.force.edge_end);
    put(face_start, m.force.face_start), put(face_end, m.force.face_end);
    put(surely, m.surely), put(at_most, m.at_most);
    put(share, m.share), put(stiffness, m.stiffness);
    for (size_t l = 0; l < lanes && first + l < count; ++l) {
      const EdgeFace& pair = candidates[first + l];
      const EdgeFaceLaw& law = laws[static_cast<size_t>(pair.pair)];
      if (p.deep.m[l] != 0) {
        edge_face_detail::find_deep(o, pair, law, found);
      } else if (p.met.m[l] != 0) {
        const auto value = [&](int number) __attribute__((always_inline)) {
          return of[static_cast<size_t>(number)][l];
        };
        const CollarPiece<double> piece{value(from), value(to),    value(sum),    value(start),
                                        value(area), value(along), value(height), value(deepest)};
        edge_face_detail::add(
            pair, law, o.depth[static_cast<size_t>(pair.face)], piece,
            {{value(edge_start), value(edge_end), value(face_start), value(face_end)},
             value(surely),
             value(at_most),
             value(share),
             value(stiffness)},
            found);
      }
    }
  }
}

}  // namespace apothem
