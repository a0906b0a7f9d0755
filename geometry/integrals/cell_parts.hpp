// The part of an edge of one polygon in a cell of the boundary layer of another one
// (boundary_layer.hpp), for four pairs of an edge and a cell at a time. This header is private to
// the integrals.
#pragma once

#include <cstdint>

#include "lib/execution/pack.hpp"

namespace apothem::edge_detail {

/// What ends the part of an edge in a cell: the cell's own edge, the end of the edge itself, the
/// border to the cell before or after, or the depth of the cell.
enum CellEnd { kOwn, kEdge, kBorderBefore, kBorderAfter, kDepthLimit };

using CellPack = PackOf<kComparedLanes>;

/// The position of a point relative to cells: its heights (phi) over the edges of the cells, and
/// over the edges before and after them. For a distance field also the positions of its foot from
/// the start and from the end of the edges.
struct CellHeights {
  CellPack own, before, after, foot, foot_from_end;
};

/// Lines of edges: the starts and gradients of the edges.
struct CellLine {
  CellPack x, y, gx, gy;
};

/// The heights of points over cells. line(0) has the edges of the cells, line(-1) and line(1) those
/// before and after them.
template <class Line>
APOTHEM_INLINE CellHeights cell_heights(const Line& line, const CellPack& px, const CellPack& py,
                                        bool distance) {
  const CellPack zero(0.);
  const CellLine own = line(0), after = line(1);
  const auto over = [&](const CellLine& l)
                        APOTHEM_LAMBDA { return l.gx * (px - l.x) + l.gy * (py - l.y); };
  CellHeights h{over(own), over(line(-1)), over(after), zero, zero};
  if (distance) {
    h.foot = own.gy * (px - own.x) - own.gx * (py - own.y);
    h.foot_from_end = own.gy * (px - after.x) - own.gx * (py - after.y);
  }
  return h;
}

/// True in lane k if bit k is set.
APOTHEM_INLINE CellPack::Mask listed_lanes(unsigned bits) {
  using Bits = CellPack::Mask::Vector;
  const Bits lane{1, 2, 4, 8};
  return {(lane & static_cast<std::int64_t>(bits)) == lane};
}

/// The depths of cells, and the sides (BoundaryLayer::side) of the vertices at their starts and
/// ends.
struct CellShapes {
  CellPack depth, side_before, side_after;
};

/// The parts of edges in cells: the lanes that have one, its ends s0 and s1, phi at the ends, and
/// the CellEnd of each end.
struct CellParts {
  CellPack::Mask there;
  CellPack s0{0.}, s1{1.}, v0, v1, end0{double(kEdge)}, end1{double(kEdge)};

  /// Restricts the parts to where a linear function is inside its bound. The function is `a` at the
  /// start of the edge and `b` at its end.
  APOTHEM_INLINE void cut(const CellPack& a, const CellPack& b, const CellPack::Mask& a_inside,
                          const CellPack::Mask& b_inside, CellEnd cause) {
    there = there & (a_inside | b_inside);
    const CellPack s = a / (a - b);
    const CellPack::Mask ends = a_inside & (!b_inside) & (s < s1);
    const CellPack::Mask begins = (!a_inside) & b_inside & (s > s0);
    s1 = select(ends, s, s1);
    end1 = select(ends, CellPack(double(cause)), end1);
    s0 = select(begins, s, s0);
    end0 = select(begins, CellPack(double(cause)), end0);
  }
};

/// Finds the parts of edges in those cells that are `listed`. `from` and `to` are the heights of
/// the ends of the edges. Returns false if there is no part. The depths of listed cells are
/// positive.
APOTHEM_INLINE bool find_parts(const CellHeights& from, const CellHeights& to,
                               const CellShapes& cells, const CellPack::Mask& listed, bool distance,
                               CellParts& parts) {
  const CellPack zero(0.), &a = from.own, &b = to.own;
  const CellPack::Mask a_inside = a >= zero, b_inside = b >= zero;
  parts.there = (a_inside | b_inside) & listed;
  if (!any(parts.there)) return false;
  parts.cut(a, b, a_inside, b_inside, kOwn);
  CellPack fa = cells.side_before * (from.before - a), fb = cells.side_before * (to.before - b);
  if (distance) {
    fa = select(cells.side_before < zero, from.foot, fa);
    fb = select(cells.side_before < zero, to.foot, fb);
  }
  parts.cut(fa, fb, fa >= zero, fb >= zero, kBorderBefore);
  fa = cells.side_after * (from.after - a), fb = cells.side_after * (to.after - b);
  if (distance) {
    fa = select(cells.side_after < zero, -from.foot_from_end, fa);
    fb = select(cells.side_after < zero, -to.foot_from_end, fb);
  }
  parts.cut(fa, fb, fa > zero, fb > zero, kBorderAfter);
  parts.there = parts.there & (parts.s0 < parts.s1);
  if (!any(parts.there)) return false;
  const CellPack::Mask a_below = a < cells.depth, b_below = b < cells.depth;
  if (any(parts.there & !(a_below & b_below))) {
    parts.cut(cells.depth - a, cells.depth - b, a_below, b_below, kDepthLimit);
    parts.there = parts.there & (parts.s0 < parts.s1);
    if (!any(parts.there)) return false;
  }
  parts.v0 = select(parts.end0 == zero, zero, a + parts.s0 * (b - a));
  const CellPack at_end = select(parts.s1 == CellPack(1.), b, a + parts.s1 * (b - a));
  parts.v1 = select(parts.end1 == zero, zero, at_end);
  return true;
}

}  // namespace apothem::edge_detail
