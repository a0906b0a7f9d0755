#include "geometry/integrals/contact_patches.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "geometry/polygon/segment.hpp"

namespace apothem {

using namespace edge_detail;

namespace {

// Splits a pair into boundary segments and patches. The start of the segment i has the number 2 i,
// and its end 2 i + 1.
class Splitter {
 public:
  Splitter(const PlacedPotential& a, const PlacedPotential& b, const Vec2& offset,
           PatchWorkspace& workspace, std::vector<BoundarySegment>& segments)
      : a_(a),
        b_(b),
        offset_(offset),
        arm_(arm(a, b, offset)),
        work_(workspace),
        segments_(segments) {}

  /// Finds all segments and returns what pair_integral returns.
  PairIntegral find_segments(NearEdges& near) {
    const auto begin = [&] {
      segments_.clear();
      work_.halves.clear();
      work_.crossed.clear();
      of_a_ = 0;
    };
    begin();
    return integrate_pair<true>(a_, b_, offset_, near, work_.edge, begin,
                                [&](bool of_a, int e, const auto& edge, const SegmentSpan& span,
                                    const EdgeSums<double>& sums) {
                                  work_.halves.push_back(sums);
                                  add_segment(of_a, e, edge, span, sums);
                                  work_.crossed.push_back(span.edge0);
                                  work_.crossed.push_back(span.edge1);
                                  if (of_a) of_a_ = size();
                                });
  }

  [[nodiscard]] int size() const { return static_cast<int>(segments_.size()); }

  /// Joins the segments to patches.
  void group() {
    const auto grow = [](auto& list, size_t least) {
      if (list.size() < least) list.resize(2 * least);
    };
    grow(work_.joined, 2 * segments_.size());
    work_.sets.reset(segments_.size());
    std::fill_n(work_.joined.begin(), 2 * size(), char{0});
    loose_ = 2 * size();
    join_at_vertices(0, of_a_, a_);
    join_at_vertices(of_a_, size(), b_);
    join_at_crossings();
    if (loose_ > 0) join_loose_ends();
    if (a_.links || b_.links) join_holes();
  }

  /// Numbers the patches in the order of their first segment and returns their number.
  int number() {
    int count = 0;
    for (int r = 0; r < size(); ++r) {
      const int first = work_.sets.find(r);
      segments_[r].patch = first == r ? count++ : segments_[first].patch;
    }
    return count;
  }

  /// Sums the integrals of the segments over each of the `count` patches, and appends them to the
  /// empty list.
  void sum(int count, std::vector<PairIntegral>& patches) {
    work_.of_a.assign(count, {});
    work_.of_b.assign(count, {});
    for (int r = 0; r < size(); ++r) {
      (segments_[r].of_a ? work_.of_a : work_.of_b)[segments_[r].patch].add(work_.halves[r]);
    }
    for (int p = 0; p < count; ++p) {
      patches.push_back(combine(work_.of_a[p], work_.of_b[p], arm_));
      patches.back().depth = depth(a_, b_, work_.of_a[p], work_.of_b[p]);
    }
    add_extents(patches);
  }

 private:
  // Appends a segment. Its integrals are those that `combine` would give for it alone.
  template <class Edge>
  void add_segment(bool of_a, int e, const Edge& edge, const SegmentSpan& span,
                   const EdgeSums<double>& half) {
    const double turn = arm_.x() * half.fy - arm_.y() * half.fx;
    const double shift_x = of_a ? arm_.x() : 0, shift_y = of_a ? arm_.y() : 0;
    const double x = edge.qx - shift_x, y = edge.qy - shift_y;  // about a's reference point
    Vec2 centre = Vec2::Zero();
    if (half.weight != 0) {
      centre = {(half.wx - shift_x * half.weight) / half.weight,
                (half.wy - shift_y * half.weight) / half.weight};
    }
    segments_.push_back({{of_a, e, 0, edge.fraction(span.s0), edge.fraction(span.s1), half.length},
                         {x + span.s0 * edge.ex, y + span.s0 * edge.ey},
                         {x + span.s1 * edge.ex, y + span.s1 * edge.ey},
                         of_a ? Vec2(-half.fx, -half.fy) : Vec2(half.fx, half.fy),
                         of_a ? turn - half.moment : half.moment,
                         of_a ? half.moment : -half.moment - turn,
                         half.weight,
                         centre,
                         half.largest});
  }

  // Joins two ends. The smaller root becomes the root of the union, because it is the first segment
  // of the patch.
  void join(int end, int other) {
    work_.joined[end] = work_.joined[other] = 1;
    loose_ -= 2;
    const auto [first, second] =
        std::minmax({work_.sets.find(end / 2), work_.sets.find(other / 2)});
    work_.sets.join(second, first);
  }

  // Joins segments that follow each other at a vertex. The segments first to last - 1 belong to one
  // polygon and are in the order of its edges.
  void join_at_vertices(int first, int last, const PlacedPotential& polygon) {
    for (int r = first; r < last; ++r) {
      const int edge = polygon.next(segments_[r].edge);
      const int next =
          edge > segments_[r].edge ? (r + 1 < last ? r + 1 : first) : first_on(edge, first, r);
      const int end = 2 * r + 1, start = 2 * next;
      if (segments_[next].edge == edge && work_.crossed[end] < 0 && work_.crossed[start] < 0) {
        join(end, start);
      }
    }
  }

  // The first one of the segments from `first` to `last` that lies on an edge or behind it.
  [[nodiscard]] int first_on(int edge, int first, int last) const {
    const auto begin = segments_.begin();
    const auto found = std::lower_bound(begin + first, begin + last, edge,
                                        [](const BoundarySegment& s, int e) { return s.edge < e; });
    return static_cast<int>(found - begin);
  }

  // Joins the boundaries of holes in the overlap, which turn clockwise, to the boundary around
  // them: the smallest one that encloses a point of theirs.
  void join_holes() {
    std::vector<double>& twice_area = work_.twice_area;
    std::vector<int>& roots = work_.roots;
    twice_area.assign(segments_.size(), 0.);
    roots.clear();
    for (int r = 0; r < size(); ++r) {
      roots.push_back(work_.sets.find(r));
      twice_area[roots.back()] += cross(segments_[r].start, segments_[r].end);
    }
    if (std::ranges::all_of(twice_area, [](double area) { return area >= 0; })) return;
    for (int hole = 0; hole < size(); ++hole) {
      if (!(twice_area[hole] < 0)) continue;
      int around = -1;
      for (int outer = 0; outer < size(); ++outer) {
        if (!(twice_area[outer] > 0) || !encloses(outer, segments_[hole].start)) continue;
        if (around < 0 || twice_area[outer] < twice_area[around]) around = outer;
      }
      if (around < 0) continue;
      const auto [first, second] = std::minmax({work_.sets.find(hole), work_.sets.find(around)});
      work_.sets.join(second, first);
    }
  }

  // Whether the boundary of the segments with a root goes round a point.
  [[nodiscard]] bool encloses(int root, const Vec2& point) const {
    bool inside = false;
    for (int r = 0; r < size(); ++r) {
      if (work_.roots[r] != root) continue;
      const Vec2 p = segments_[r].start - point, q = segments_[r].end - point;
      if ((p.y() > 0) != (q.y() > 0) && (cross(p, q) > 0) == (q.y() > p.y())) inside = !inside;
    }
    return inside;
  }

  // Joins segments where edge i of a crosses edge j of b. They are found by (i, j) and not by
  // position.
  void join_at_crossings() {
    const auto end_of_a = segments_.begin() + of_a_;
    for (int end = 2 * of_a_; end < 2 * size(); ++end) {
      const int i = work_.crossed[end];
      if (i < 0) continue;
      auto segment =
          std::lower_bound(segments_.begin(), end_of_a, i,
                           [](const BoundarySegment& r, int edge) { return r.edge < edge; });
      for (; segment != end_of_a && segment->edge == i && !work_.joined[end]; ++segment) {
        const int first = 2 * static_cast<int>(segment - segments_.begin());
        for (const int other : {first, first + 1}) {
          if (work_.crossed[other] != segments_[end / 2].edge || work_.joined[other]) continue;
          join(end, other);
          break;
        }
      }
    }
  }

  // Joins the ends that are still loose. The part of the boundary that round-off has lost between
  // the end of a segment and the start of the next one lies on both boundaries up to round-off:
  // either the straight line between them does, or one of the two boundaries stays near the other
  // all the way. Neither is true between ends of different patches. The length of the lost part
  // decides only between candidates that are equally near. Two starts, or two ends, are joined only
  // if they are at the same place; their cost is their distance.
  void join_loose_ends() {
    auto& bridges = work_.bridges;
    bridges.clear();
    for (int end = 1; end < 2 * size(); end += 2) {
      if (work_.joined[end]) continue;
      for (int start = 0; start < 2 * size(); start += 2) {
        if (!work_.joined[start]) bridges.push_back({gap2(point(end), point(start)), end, start});
      }
    }
    for (int end = 0; end < 2 * size(); ++end) {
      if (work_.joined[end]) continue;
      for (int other = end + 2; other < 2 * size(); other += 2) {
        if (work_.joined[other]) continue;
        bridges.push_back({(point(end) - point(other)).squaredNorm(), end, other});
      }
    }
    std::sort(bridges.begin(), bridges.end(), [](const auto& c, const auto& d) {
      return std::tie(c.cost2, c.end, c.other) < std::tie(d.cost2, d.end, d.other);
    });
    for (const auto& bridge : bridges) {
      if (!work_.joined[bridge.end] && !work_.joined[bridge.other]) join(bridge.end, bridge.other);
    }
  }

  [[nodiscard]] const Vec2& point(int end) const {
    return end % 2 == 0 ? segments_[end / 2].start : segments_[end / 2].end;
  }

  // The square of the largest distance from both boundaries of the part that may be lost between an
  // end and a start.
  [[nodiscard]] double gap2(const Vec2& end, const Vec2& start) const {
    const Vec2 middle = (end + start) / 2;
    const double straight =
        std::max({kLength2 * (end - start).squaredNorm(), nearest(a_, shift_a(), middle).distance2,
                  nearest(b_, shift_b(), middle).distance2});
    const double along_a = walk2(a_, shift_a(), b_, shift_b(), end, start, straight);
    return walk2(b_, shift_b(), a_, shift_a(), end, start, along_a);
  }

  // The square of the gap if the lost part is the boundary of x from `end` to `start`, or `most` if
  // that is smaller.
  static double walk2(const PlacedPotential& x, const Vec2& shift_x, const PlacedPotential& y,
                      const Vec2& shift_y, const Vec2& end, const Vec2& start, double most) {
    const NearestPoint from = nearest(x, shift_x, end);
    const NearestPoint to = nearest(x, shift_x, start);
    if (from.edge == to.edge && from.fraction <= to.fraction) return most;  // no vertex between
    Vec2 last = end;
    double length = 0, worst = 0;
    const auto go_to = [&](const Vec2& next) {
      length += (next - last).norm();
      worst = std::max({worst, kLength2 * length * length,
                        nearest(y, shift_y, (last + next) / 2).distance2,
                        nearest(y, shift_y, next).distance2});
      last = next;
    };
    int edge = from.edge;
    do {
      edge = x.next(edge);
      if (edge == from.edge && edge != to.edge) return most;  // they lie on different rings
      go_to(Vec2(x.x[edge], x.y[edge]) - shift_x);
      if (!(worst < most)) return most;
    } while (edge != to.edge);
    go_to(start);
    return std::min(worst, most);
  }

  // The point on a boundary that is nearest to a given point: `fraction` is its position along the
  // edge, from 0 to 1, and `distance2` its squared distance from the given point, m^2.
  struct NearestPoint {
    int edge;
    double fraction, distance2;
  };
  // The point of the boundary of p that is nearest to `point`. Like all points here, `point` is
  // relative to a's reference point; `shift` moves it to the frame of p.
  static NearestPoint nearest(const PlacedPotential& p, const Vec2& shift, const Vec2& point) {
    NearestPoint place{0, 0, std::numeric_limits<double>::infinity()};
    for (int i = 0; i < p.size; ++i) {
      const Vec2 from = point + shift - Vec2(p.x[i], p.y[i]);
      const int end = p.end(i);
      const Vec2 edge(p.x[end] - p.x[i], p.y[end] - p.y[i]);
      const auto [fraction, distance2] = nearest_on_segment(from, edge);
      if (distance2 < place.distance2) place = {i, fraction, distance2};
    }
    return place;
  }

  // The vectors from a's reference point to the origins of the frames of a and b.
  [[nodiscard]] Vec2 shift_a() const { return a_.reference; }
  [[nodiscard]] Vec2 shift_b() const { return arm_ + b_.reference; }

  // Sets the breadth of every patch.
  void add_extents(std::vector<PairIntegral>& patches) {
    auto& extents = work_.extents;
    extents.assign(patches.size(), {});
    for (const BoundarySegment& segment : segments_) {
      const Vec2& force = patches[segment.patch].force;
      const double size = force.norm();
      if (!(size > 0)) continue;
      for (const Vec2& p : {segment.start, segment.end}) {
        extents[segment.patch].include(cross(force, p) / size);
      }
    }
    for (size_t i = 0; i < patches.size(); ++i) {
      if (!(extents[i].high >= extents[i].low)) continue;  // no resultant force
      patches[i].breadth = extents[i].high - extents[i].low;
      patches[i].middle = (extents[i].high + extents[i].low) / 2;
    }
  }

  static constexpr double kLength2 = 1e-12;  // weight of the squared length of a lost part

  const PlacedPotential& a_;
  const PlacedPotential& b_;
  const Vec2 offset_, arm_;
  PatchWorkspace& work_;
  std::vector<BoundarySegment>& segments_;
  int of_a_ = 0;   // number of segments on edges of a, which come first
  int loose_ = 0;  // number of ends that are not joined
};

}  // namespace

PairIntegral contact_patches(const PlacedPotential& a, const PlacedPotential& b, const Vec2& offset,
                             PatchWorkspace& workspace, std::vector<BoundarySegment>& segments,
                             std::vector<PairIntegral>& patches, NearEdges& near) {
  patches.clear();
  Splitter splitter(a, b, offset, workspace, segments);
  PairIntegral whole = splitter.find_segments(near);
  const bool finite = !std::isnan(whole.weight);
  if (!finite || !whole.touching()) segments.clear();
  if (!whole.touching()) return whole;
  if (!finite || (a.convex() && b.convex())) {
    patches.push_back(whole);
    return whole;
  }
  splitter.group();
  const int count = splitter.number();
  if (count == 1) {
    patches.push_back(whole);
  } else {
    splitter.sum(count, patches);
  }
  return whole;
}

PairIntegral contact_patches(const PlacedPotential& a, const PlacedPotential& b, const Vec2& offset,
                             PatchWorkspace& workspace, std::vector<BoundarySegment>& segments,
                             std::vector<PairIntegral>& patches) {
  NearEdges all;
  return contact_patches(a, b, offset, workspace, segments, patches, all);
}

void shared_length(std::span<const SegmentPlace> before, int patches_before,
                   std::span<const SegmentPlace> now, int patches_now, std::vector<double>& table) {
  table.assign(static_cast<size_t>(patches_before) * patches_now, 0.0);
  // True if r is on an earlier edge than s.
  const auto behind = [](const SegmentPlace& r, const SegmentPlace& s) {
    return r.of_a != s.of_a ? r.of_a : r.edge < s.edge;
  };
  size_t first = 0;  // first segment of `now` on the edge of `old` or after it
  for (const SegmentPlace& old : before) {
    while (first < now.size() && behind(now[first], old)) ++first;
    for (size_t i = first; i < now.size() && !behind(old, now[i]); ++i) {
      const SegmentPlace& segment = now[i];
      const double overlap = std::min(old.to, segment.to) - std::max(old.from, segment.from);
      if (!(overlap >= 0)) continue;
      const SegmentPlace& longer = old.to - old.from > segment.to - segment.from ? old : segment;
      const double fraction = longer.to - longer.from;
      double& entry = table[static_cast<size_t>(old.patch) * patches_now + segment.patch];
      if (overlap > 0) {
        entry += overlap / fraction * longer.length;
      } else if (old.from == old.to || segment.from == segment.to) {
        entry += std::numeric_limits<double>::min();
      }
    }
  }
}

}  // namespace apothem
