#include "geometry/integrals/pair_derivative.hpp"

#include <algorithm>

#include "geometry/integrals/edge_trace.hpp"

namespace apothem {

using namespace edge_detail;

namespace {

constexpr int kTurnOfA = 2, kTurnOfB = 3;  // numbers of the motions, after the shift along x and y

Moving moved(double value, int turn, double by_turn) {
  Moving result(value);
  result.d.v[turn] = by_turn;
  return result;
}

}  // namespace

// Places the vertices of a polygon, shifted by (dx, dy), and the gradients of its edges.
void PairDerivative::place(const PlacedPotential& p, const Moving& dx, const Moving& dy, int turn,
                           Shape& shape) {
  shape.x.clear(), shape.y.clear(), shape.gx.clear(), shape.gy.clear();
  shape.box = {};
  for (int i = 0; i < p.size; ++i) {
    shape.x.push_back(moved(p.x[i], turn, -p.y[i]) + dx);
    shape.y.push_back(moved(p.y[i], turn, p.x[i]) + dy);
    shape.gx.push_back(moved(p.gx[i], turn, -p.gy[i]));
    shape.gy.push_back(moved(p.gy[i], turn, p.gx[i]));
    shape.box.include(shape.x.back().v, shape.y.back().v);
  }
}

// Adds the segments of x, placed as edges_, inside y, placed as field_: both in the frame of y.
void PairDerivative::walk(bool of_a, const PlacedPotential& x, const PlacedPotential& y) {
  if (y.roof) {
    const size_t nodes = y.roof->points.size();
    const int turn = of_a ? kTurnOfB : kTurnOfA;
    node_x_ = field_.x, node_y_ = field_.y;
    node_value_.assign(y.roof->values.begin(), y.roof->values.end());
    for (auto i = static_cast<size_t>(y.size); i < nodes; ++i) {
      const Vec2& point = y.roof->points[i];
      const double px = y.cosine * point.x() - y.sine * point.y() + y.shift.x();
      const double py = y.sine * point.x() + y.cosine * point.y() + y.shift.y();
      node_x_.push_back(moved(px, turn, -py));
      node_y_.push_back(moved(py, turn, px));
    }
  }
  for (int e = 0; e < x.size; ++e) {
    const auto start = static_cast<size_t>(e), end = static_cast<size_t>(x.next(e));
    const EdgeFrame<Moving> edge{edges_.x[start], edges_.y[start], edges_.x[end] - edges_.x[start],
                                 edges_.y[end] - edges_.y[start]};
    Box box;
    box.include(edges_.x[start].v, edges_.y[start].v);
    box.include(edges_.x[end].v, edges_.y[end].v);
    if (apart(box, field_.box)) continue;
    SegmentMoments<Moving> moments;
    const auto add = [&](const Moving& s0, const Moving& s1) {
      segments_.push_back({of_a, e, along_edge(edge, moments, Moving(s1 - s0)),
                           edge.qx + s0 * edge.ex, edge.qy + s0 * edge.ey, edge.qx + s1 * edge.ex,
                           edge.qy + s1 * edge.ey});
      moments = {};
    };
    const auto add_part = [&](const Moving& s0, int, const Moving& s1, int) { add(s0, s1); };
    if (y.distance) {
      distance_.segments(
          {y.size, field_.x.data(), field_.y.data(), field_.gx.data(), field_.gy.data(),
           y.distance->slope, &y.distance->corners, y.capped, y.links},
          edge.qx, edge.qy, edge.ex, edge.ey, moments, add_part);
      continue;
    }
    if (y.roof) {
      roof_.cross({&y.roof->arcs, y.size, static_cast<int>(node_x_.size()), node_x_.data(),
                   node_y_.data(), node_value_.data()},
                  edge.qx, edge.qy, edge.ex, edge.ey);
      roof_.segments([&](const Moving& u1, const Moving& v1, const Moving& u2,
                         const Moving& v2) { add_piece(y, u1, v1, u2, v2, moments); },
                     add_part);
      continue;
    }
    from_.clear(), until_.clear();
    for (size_t i = 0; i < static_cast<size_t>(y.size); ++i) {
      const auto height = [&](const Moving& px, const Moving& py) {
        return field_.gx[i] * (px - field_.x[i]) + field_.gy[i] * (py - field_.y[i]);
      };
      from_.push_back(height(edges_.x[start], edges_.y[start]));
      until_.push_back(height(edges_.x[end], edges_.y[end]));
    }
    if (y.capped) from_.emplace_back(1.), until_.emplace_back(1.);
    const Row<Moving> row{from_.data(), until_.data(), y.size, static_cast<int>(from_.size())};
    Moving s0, s1;
    if (!clip(row, s0, s1)) continue;
    moments = envelope_moments(row, s0, s1, true);
    add(s0, s1);
  }
}

std::span<const MovingIntegral> PairDerivative::find(const PlacedPotential& a,
                                                     const PlacedPotential& b, const Vec2& offset,
                                                     std::span<const SegmentPlace> patch_of) {
  const Moving none(0.);
  const Moving rx = Moving::variable(offset.x(), 0), ry = Moving::variable(offset.y(), 1);
  segments_.clear();
  place(a, rx, ry, kTurnOfA, edges_);
  place(b, none, none, kTurnOfB, field_);
  walk(true, a, b);
  const size_t middle = segments_.size();
  place(b, -rx, -ry, kTurnOfB, edges_);
  place(a, none, none, kTurnOfA, field_);
  walk(false, b, a);
  for (size_t i = 0; i < middle; ++i) {
    Segment& s = segments_[i];
    s.x0 -= rx, s.y0 -= ry, s.x1 -= rx, s.y1 -= ry;
  }
  const auto patch = [&](size_t segment) {
    return patch_of.empty() ? size_t{0} : static_cast<size_t>(patch_of[segment].patch);
  };
  if (!patch_of.empty()) {
    const bool same = std::ranges::equal(
        patch_of, segments_, [](const SegmentPlace& place, const Segment& segment) {
          return place.of_a == segment.of_a && place.edge == segment.edge;
        });
    if (!same) return {};
  }
  size_t count = segments_.empty() ? 0 : 1;
  for (size_t i = 0; i < segments_.size(); ++i) count = std::max(count, patch(i) + 1);
  patches_.assign(count, {});
  for (size_t p = 0; p < count; ++p) {
    std::array<EdgeSums<Moving>, 2> halves;  // of a, and of b
    for (size_t i = 0; i < segments_.size(); ++i) {
      if (patch(i) != p) continue;
      EdgeSums<Moving>& half = halves[segments_[i].of_a ? 0 : 1];
      const EdgeSums<Moving>& sums = segments_[i].sums;
      half.fx += sums.fx, half.fy += sums.fy, half.moment += sums.moment;
      half.weight += sums.weight, half.wx += sums.wx, half.wy += sums.wy;
      half.length += sums.length;
    }
    const PairSums<Moving> pair = combine_sums(halves[0], halves[1], rx, ry);
    Moving low(HUGE_VAL), high(-HUGE_VAL);
    if (const Moving size2 = pair.fx * pair.fx + pair.fy * pair.fy; size2.v > 0) {
      const Moving size = square_root(size2), nx = pair.fx / size, ny = pair.fy / size;
      for (size_t i = 0; i < segments_.size(); ++i) {
        if (patch(i) != p) continue;
        const Segment& s = segments_[i];
        for (const Moving& t : {Moving(nx * s.y0 - ny * s.x0), Moving(nx * s.y1 - ny * s.x1)}) {
          low = std::min(low, t), high = std::max(high, t);
        }
      }
    } else {
      low = high = none;
    }
    patches_[p] = {pair.fx,       pair.fy,       pair.moment_a,    pair.moment_b,    pair.weight,
                   pair.centre_x, pair.centre_y, halves[0].length, halves[1].length, high - low};
  }
  return patches_;
}

}  // namespace apothem
