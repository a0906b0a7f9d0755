#include "geometry/integrals/layer_pair.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "lib/execution/dispatch.hpp"

namespace apothem {

using namespace edge_detail;

bool LayerPair::find(const PlacedPotential& a, const PlacedPotential& b, const Vec2& offset,
                     const NearEdges& near) {
  count_ = 0;
  if (!list(a, b, near)) return false;
  there_ = own0_ = own1_ = border0_ = border1_ = 0;
  reaches_depth_ = false;
  with_widest([&](auto /*lanes*/) APOTHEM_LAMBDA {
    find_parts(a, b, offset);
    return 0.;
  });
  return !reaches_depth_ && join_parts();
}

// Lists the pairs of near edges. Returns false if they are too many or unknown, if an edge may be
// so long that PlacedEdge shortens it, or if a cell must not be used.
bool LayerPair::list(const PlacedPotential& a, const PlacedPotential& b, const NearEdges& near) {
  // An edge is at most 2 radii long, and is shortened beyond 8 radii of the other polygon.
  constexpr double kShort = 3.9;
  if (!a.layer || !b.layer || (a.distance == nullptr) != (b.distance == nullptr)) return false;
  if (!(a.radius < kShort * b.radius && b.radius < kShort * a.radius)) return false;
  if (near.skin == 0 || a.size > 64 || b.size > 64) return false;
  int n = 0;
  bool usable = true;
  const auto add = [&](bool of_a, const double* depth, std::uint64_t edges, std::uint64_t cells) {
    for (std::uint64_t e = edges; e != 0; e &= e - 1) {
      const int edge = std::countr_zero(e);
      for (std::uint64_t c = cells; c != 0; c &= c - 1) {
        if (n == kMost) {
          usable = false;
          return;
        }
        const int cell = std::countr_zero(c);
        usable = usable && depth[cell] > 0;
        lane_[n++] = {of_a, edge, cell};
      }
    }
  };
  add(true, b.layer->depth.data(), near.of_a, near.of_b);
  add(false, a.layer->depth.data(), near.of_b, near.of_a);
  if (n == 0 || !usable) return false;
  listed_ = n == kMost ? ~Bits{0} : (Bits{1} << n) - 1;
  while (n % kPack != 0) lane_[n++] = lane_[0];
  lanes_ = n;
  return true;
}

APOTHEM_INLINE void LayerPair::find_parts(const PlacedPotential& a, const PlacedPotential& b,
                                          const Vec2& offset) {
  const bool distance = a.distance != nullptr;
  const Pack zero(0.);
  for (int first = 0; first < lanes_; first += kPack) {
    const Lane* const lanes = lane_.data() + first;
    const auto x = [&](int k)
                       APOTHEM_LAMBDA -> const PlacedPotential& { return lanes[k].of_a ? a : b; };
    const auto y = [&](int k)
                       APOTHEM_LAMBDA -> const PlacedPotential& { return lanes[k].of_a ? b : a; };
    const auto of_y = [&](const auto& value) APOTHEM_LAMBDA {
      return pack_of<kPack>([&](int k) APOTHEM_LAMBDA { return value(y(k), lanes[k]); });
    };
    const Pack dx = pack_of<kPack>(
        [&](int k) APOTHEM_LAMBDA { return lanes[k].of_a ? offset.x() : -offset.x(); });
    const Pack dy = pack_of<kPack>(
        [&](int k) APOTHEM_LAMBDA { return lanes[k].of_a ? offset.y() : -offset.y(); });
    // The starts and ends of the edges.
    FourOf<Pack> vx, vy;
    read_rows([&](int k) APOTHEM_LAMBDA { return x(k).x + lanes[k].edge; }, vx);
    read_rows([&](int k) APOTHEM_LAMBDA { return x(k).y + lanes[k].edge; }, vy);
    const Pack px = vx[0] + dx, py = vy[0] + dy, end_x = vx[1] + dx, end_y = vy[1] + dy;
    // The edge of each cell, and those before and after it.
    FourOf<Pack> cx, cy, gx, gy;
    read_rows([&](int k) APOTHEM_LAMBDA { return y(k).x + (lanes[k].cell - 1); }, cx);
    read_rows([&](int k) APOTHEM_LAMBDA { return y(k).y + (lanes[k].cell - 1); }, cy);
    read_rows([&](int k) APOTHEM_LAMBDA { return y(k).gx + (lanes[k].cell - 1); }, gx);
    read_rows([&](int k) APOTHEM_LAMBDA { return y(k).gy + (lanes[k].cell - 1); }, gy);
    const auto line = [&](int i) APOTHEM_LAMBDA {
      const size_t k = static_cast<size_t>(i) + 1;
      return CellLine{cx[k], cy[k], gx[k], gy[k]};
    };
    const CellShapes cells{of_y([](const PlacedPotential& p, const Lane& lane)
                                    APOTHEM_LAMBDA { return p.layer->depth[lane.cell]; }),
                           of_y([](const PlacedPotential& p, const Lane& lane)
                                    APOTHEM_LAMBDA { return p.layer->side[lane.cell]; }),
                           of_y([](const PlacedPotential& p, const Lane& lane)
                                    APOTHEM_LAMBDA { return p.layer->side[lane.cell + 1]; })};
    const Pack::Mask listed = listed_lanes(listed_ >> first);
    CellParts parts;
    if (!edge_detail::find_parts(cell_heights(line, px, py, distance),
                                 cell_heights(line, end_x, end_y, distance), cells, listed,
                                 distance, parts)) {
      continue;
    }
    const Pack depth_limit{double(kDepthLimit)}, edge_end{double(kEdge)};
    if (any(parts.there & ((parts.end0 == depth_limit) | (parts.end1 == depth_limit)))) {
      reaches_depth_ = true;
      return;
    }
    const auto note = [&](Bits& lanes_with, const Pack::Mask& mask)
                          APOTHEM_LAMBDA { lanes_with |= bits(parts.there & mask) << first; };
    there_ |= bits(parts.there) << first;
    note(own0_, parts.end0 == zero), note(own1_, parts.end1 == zero);
    note(border0_, parts.end0 > edge_end), note(border1_, parts.end1 > edge_end);
    parts.s0.store(s0_.data() + first), parts.s1.store(s1_.data() + first);
    SegmentMoments<Pack> moments;
    moments.add(parts.there, parts.s0, parts.v0, parts.s1, parts.v1);
    const auto lane_of = [first](auto& list) APOTHEM_LAMBDA {
      return [&list, first ](int k) APOTHEM_LAMBDA -> auto& {
        return list[static_cast<size_t>(first) + static_cast<size_t>(k)];
      };
    };
    const EdgeFrame<Pack> edge{px - of_y([](const PlacedPotential& p, const Lane&)
                                             APOTHEM_LAMBDA { return p.reference.x(); }),
                               py - of_y([](const PlacedPotential& p, const Lane&)
                                             APOTHEM_LAMBDA { return p.reference.y(); }),
                               vx[1] - vx[0], vy[1] - vy[0]};
    scatter(edge, lane_of(edge_));
    // Parts that end at a border are joined to segments later, which needs their moments.
    if (any(parts.there & ((parts.end0 > edge_end) | (parts.end1 > edge_end)))) {
      scatter(moments, lane_of(moments_));
    }
    scatter(along_edge(edge, moments, parts.s1 - parts.s0), lane_of(integrals_));
  }
}

// Joins the parts of each edge to segments. Returns false if an edge continues in a cell that is
// not listed, or in the sector of a vertex.
bool LayerPair::join_parts() {
  for (Bits rest = there_; rest != 0;) {
    const Lane& lane = lane_[std::countr_zero(rest)];
    Bits parts = 0;  // parts of the same edge
    do {
      parts |= rest & -rest;
      rest &= rest - 1;
      if (rest == 0) break;
    } while (lane_[std::countr_zero(rest)].edge == lane.edge &&
             lane_[std::countr_zero(rest)].of_a == lane.of_a);
    if (!join_parts_of_edge(parts)) return false;
  }
  return true;
}

bool LayerPair::join_parts_of_edge(Bits parts) {
  if (((border0_ | border1_) & parts) == 0 && std::has_single_bit(parts)) {
    const int i = std::countr_zero(parts);
    add_segment(i, i);
    return true;
  }
  // The parts are sorted along the edge.
  std::array<int, kMost> order;
  int n = 0;
  for (; parts != 0; parts &= parts - 1) {
    const int i = std::countr_zero(parts);
    int place = n++;
    for (; place > 0 && s0_[order[place - 1]] > s0_[i]; --place) order[place] = order[place - 1];
    order[place] = i;
  }
  for (int k = 0; k < n; ++k) {
    const int first = order[k];
    if (has(border0_, first)) return false;
    int last = first;
    Moments moments = moments_[first];
    while (has(border1_, last)) {
      if (++k == n) return false;
      const int next = order[k];
      if (!has(border0_, next) || s0_[next] != s1_[last]) return false;
      moments.sum += moments_[next].sum;
      moments.first += moments_[next].first;
      moments.largest = std::max(moments.largest, moments_[next].largest);
      last = next;
    }
    if (last != first) {
      integrals_[first] = along_edge(edge_[first], moments, s1_[last] - s0_[first]);
    }
    add_segment(first, last);
  }
  return true;
}

void LayerPair::add_segment(int first, int last) {
  segments_[count_++] = {lane_[first].of_a,
                         lane_[first].edge,
                         has(own0_, first) ? lane_[first].cell : -1,
                         has(own1_, last) ? lane_[last].cell : -1,
                         s0_[first],
                         s1_[last],
                         &edge_[first],
                         &integrals_[first]};
}

}  // namespace apothem
