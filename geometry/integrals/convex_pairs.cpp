#include "geometry/integrals/convex_pairs.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "geometry/integrals/edge_trace.hpp"
#include "lib/execution/dispatch.hpp"

namespace apothem {

using namespace edge_detail;

namespace {

using Four = PackOf<4>;

template <class Real>
APOTHEM_INLINE Real larger(const Real& p, const Real& q) {
  return select(p < q, q, p);
}
APOTHEM_INLINE double largest(const Four& p) {
  return std::max(std::max(p.v[0], p.v[1]), std::max(p.v[2], p.v[3]));
}

// Above this ratio of the sizes of two polygons edges may have to be shortened, and heights at
// their ends are not accurate enough to exclude them. An edge is at most twice as long as the
// radius.
constexpr double kSimilar = 3.99;
bool is_long(double radius, double of_other) { return !(radius < kSimilar * of_other); }

}  // namespace

// Makes room for kAtOnce pairs of polygons with at most most_sides_ sides.
void ConvexPairs::make_room() {
  const auto sides = static_cast<size_t>(most_sides_), groups = (sides + kLanes - 1) / kLanes;
  const size_t edges = 2 * sides * kAtOnce;
  rows_.resize(2 * (sides + 1 + 2 * sides) * groups *
               kAtOnce);  // two more rows for each edge that is shortened
  copies_.resize(8 * groups * kAtOnce);
  parts_.resize(edges + 1);
  for (size_t g = 0; g < groups; ++g) edges_[g].resize(edges + kLanes);
  room_ = most_sides_;
}

void ConvexPairs::fill_up(Side& side, Numbers*& memory) {
  const int all = kLanes * side.groups;
  if (side.size == all) return;
  for (const double** numbers : {&side.start_x, &side.start_y, &side.gx, &side.gy}) {
    double* const copy = memory->v.data();
    std::copy(*numbers, *numbers + side.size, copy);
    std::fill(copy + side.size, copy + all, copy[0]);
    *numbers = copy;
    memory += side.groups;
  }
}

// Writes the heights of the vertices of x, moved by (dx, dy), over the edges of y: one row for each
// vertex and the first row again. Returns how far outside one edge of y all of x lies, in the unit
// of the heights, or 0 if there is no such edge. Sets in `edges` the bits of those edges of x that
// are not entirely beyond one edge of y by more than `margin`.
template <bool quads>
APOTHEM_INLINE double ConvexPairs::find_heights(const Side& x, const Side& y, double dx, double dy,
                                                double margin, Numbers* rows, unsigned& edges) {
  const int size = quads ? 4 : x.size, groups = quads ? 1 : y.groups;
  const Four least(-margin);
  std::array<unsigned, kMostSides + 1> beyond;  // bits of the edges of y that each vertex is beyond
  unsigned beyond_all = ~0U;
  const auto height = [&](int v, int g) APOTHEM_LAMBDA {
    const int first = kLanes * g;
    return Four::load(y.gx + first) * (Four(x.x[v] + dx) - Four::load(y.start_x + first)) +
           Four::load(y.gy + first) * (Four(x.y[v] + dy) - Four::load(y.start_y + first));
  };
  for (int v = 0; v < size; ++v) {
    unsigned of_vertex = 0;
    for (int g = 0; g < groups; ++g) {
      const Four h = height(v, g);
      h.store(rows[v * groups + g].v.data());
      of_vertex |= bits(h < least) << (kLanes * g);
    }
    beyond[static_cast<size_t>(v)] = of_vertex;
    beyond_all &= of_vertex;
  }
  for (int g = 0; g < groups; ++g) rows[size * groups + g] = rows[g];
  beyond[static_cast<size_t>(size)] = beyond[0];
  edges = 0;
  for (int v = 0; v < size; ++v) {
    const auto k = static_cast<size_t>(v);
    edges |= unsigned{(beyond[k] & beyond[k + 1]) == 0} << v;
  }
  if (beyond_all == 0) return 0;
  // If a number is not finite, the polygons do not count as apart.
  Four all(0.);
  double gap = -HUGE_VAL;
  for (int g = 0; g < groups; ++g) {
    Four highest(-HUGE_VAL);
    for (int v = 0; v < size; ++v) {
      const Four h = Four::load(rows[v * groups + g].v.data());
      all += h;
      highest = larger(highest, h);
    }
    gap = std::max(gap, largest(-highest));
  }
  return any(!(all == all)) ? 0 : gap;
}

// Finds the edges of both polygons that may enter the other one.
APOTHEM_INLINE void ConvexPairs::find(ConvexPair& pair, Numbers*& rows) {
  const Side &a = pair.a, &b = pair.b;
  const bool a_is_long = is_long(a.radius, b.radius), b_is_long = is_long(b.radius, a.radius);
  pair.first = found_;
  pair.of_a = pair.of_b = 0;
  const bool quads = a.size == 4 && b.size == 4;
  const auto apart = [&](const Side& x, const Side& y, double dx, double dy, double margin,
                         Numbers* heights, unsigned& edges) APOTHEM_LAMBDA {
    const double gap = quads ? find_heights<true>(x, y, dx, dy, margin, heights, edges)
                             : find_heights<false>(x, y, dx, dy, margin, heights, edges);
    if (!(gap > 0)) return false;
    const double steepest = y.steepest;
    if (pair.near->skin == 0 && steepest > 0) {
      const double round_off = kRoundOff * (a.radius + b.radius);
      const double apart_by = gap / steepest - round_off;
      if (apart_by > round_off) *pair.near = {0, 0, apart_by};
    }
    return true;
  };
  Numbers* const of_a = rows;
  Numbers* const of_b = of_a + std::ptrdiff_t{a.size + 1} * b.groups;
  const double margin_a = a_is_long ? kRoundOff * a.radius * b.steepest : 0;
  const double margin_b = b_is_long ? kRoundOff * b.radius * a.steepest : 0;
  unsigned edges_a, edges_b;
  if (apart(a, b, pair.dx, pair.dy, margin_a, of_a, edges_a) ||
      apart(b, a, -pair.dx, -pair.dy, margin_b, of_b, edges_b)) {
    return;
  }
  rows = of_b + std::ptrdiff_t{b.size + 1} * a.groups;
  pair.of_a = std::popcount(edges_a);
  pair.of_b = std::popcount(edges_b);
  list_edges(a, b, pair.dx, pair.dy, edges_a, of_a, a_is_long, rows);
  list_edges(b, a, -pair.dx, -pair.dy, edges_b, of_b, b_is_long, rows);
}

// Lists edges of x. If x is much larger than y, edges are shortened, see BasicEdge.
APOTHEM_INLINE void ConvexPairs::list_edges(const Side& x, const Side& y, double dx, double dy,
                                            unsigned edges, const Numbers* heights, bool is_long,
                                            Numbers*& rows) {
  const auto group = static_cast<size_t>(y.groups - 1);
  ConvexEdge* const first = edges_[group].data() + listed_[group];
  ConvexEdge* next = first;
  const auto put = [&](int e) APOTHEM_LAMBDA {
    next->from = heights + std::ptrdiff_t{e} * y.groups;
    next->until = next->from + y.groups;
    // The frame is written as one pack, as it will be read.
    Four(Four::Vector{x.x[e] + dx - y.reference_x, x.y[e] + dy - y.reference_y, x.x[e + 1] - x.x[e],
                      x.y[e + 1] - x.y[e]})
        .store(&next->frame.qx);
    next->part = found_ + static_cast<int>(next - first);
    next->number = e;
    next->whole = true;
  };
  // Most polygons have one edge or two here, which are written without a branch.
  const int count = std::popcount(edges);
  for (int k = 0; k < 2; ++k, ++next) {
    put(std::countr_zero(edges | 1U << (x.size - 1)));
    edges &= edges - 1;
  }
  for (; edges != 0; edges &= edges - 1, ++next) put(std::countr_zero(edges));
  next = first + count;
  found_ += count;
  listed_[group] += count;
  if (!is_long) return;
  const PlacedPotential placed_x{
      .x = x.x, .y = x.y, .gx = x.gx, .gy = x.gy, .size = x.size, .capped = false};
  const PlacedPotential placed_y{.x = y.start_x,
                                 .y = y.start_y,
                                 .gx = y.gx,
                                 .gy = y.gy,
                                 .size = kLanes * y.groups,
                                 .capped = false,
                                 .reference = {y.reference_x, y.reference_y},
                                 .radius = y.radius};
  for (ConvexEdge* edge = first; edge != next; ++edge) {
    const PlacedEdge part(placed_x, placed_y, edge->number, dx, dy);
    if (!part.shortened) continue;
    height_row(placed_y, part.px, part.py, rows->v.data());
    edge->from = rows, rows += y.groups;
    height_row(placed_y, part.px + part.ex, part.py + part.ey, rows->v.data());
    edge->until = rows, rows += y.groups;
    edge->frame = {part.qx, part.qy, part.ex, part.ey};
    edge->whole = part.first == 0;
  }
}

// Integrates four edges over polygons with `groups` groups of edges: finds their parts inside, and
// phi along these.
template <bool one_group>
APOTHEM_INLINE void ConvexPairs::integrate(const ConvexEdge* edges, int groups) {
  std::array<Four, one_group ? 4 : kMostSides> from, until;
  FourOf<Four> rows;
  for (int g = 0; g < (one_group ? 1 : groups); ++g) {
    const auto put = [&](auto& list) APOTHEM_LAMBDA {
      for (size_t i = 0; i < 4; ++i) list[static_cast<size_t>(kLanes * g) + i] = rows[i];
    };
    read_rows([&](int k) APOTHEM_LAMBDA { return edges[k].from[g].v.data(); }, rows);
    put(from);
    read_rows([&](int k) APOTHEM_LAMBDA { return edges[k].until[g].v.data(); }, rows);
    put(until);
  }
  EdgeFrame<Four> edge;
  gather(
      edge, [&](int k) APOTHEM_LAMBDA -> const auto& { return edges[k].frame; });
  const int lines = one_group ? 4 : kLanes * groups;
  const Row<Four> row{from.data(), until.data(), lines, lines};
  Four s0, s1;
  const Four::Mask inside = clip(row, s0, s1);
  const SegmentMoments<Four> moments = any(inside)
                                           ? envelope_moments(row, s0, s1, inside)
                                           : SegmentMoments<Four>();  // 0 where no part lies inside
  const Four zero(0.), nowhere(std::numeric_limits<double>::quiet_NaN());
  const auto part = [&](int k) APOTHEM_LAMBDA -> EdgePart& {
    return parts_[static_cast<size_t>(edges[k].part)];
  };
  scatter(
      along_edge(edge, moments, select(inside, s1 - s0, zero)), [&](int k) APOTHEM_LAMBDA -> auto& {
        return part(k).sums;
      });
  const Four start = select(inside, s0, nowhere), end = select(inside, s1, nowhere);
  write_rows({edge.qx + start * edge.ex, edge.qx + end * edge.ex, edge.qy + start * edge.ey,
              edge.qy + end * edge.ey},
             [&](int k) APOTHEM_LAMBDA { return part(k).ends.v.data(); });
  const unsigned enter = bits(inside & (s0 == zero));
  for (int k = 0; k < kLanes; ++k) {
    EdgePart& result = part(k);
    result.number = edges[k].number;
    result.enters = edges[k].whole & ((enter >> k & 1U) != 0);
  }
}

// Calls f(part) for the parts of a polygon. Most polygons have one or two parts. These calls have
// no branch; a missing part is replaced by one that changes no sum and no extent.
template <class F>
APOTHEM_INLINE void ConvexPairs::each_part(const EdgePart* from, const EdgePart* until,
                                           const F& f) {
  static constexpr double kNoEnd = std::numeric_limits<double>::quiet_NaN();
  static constexpr EdgePart kNone{{}, {kNoEnd, kNoEnd, kNoEnd, kNoEnd}, 0, false};
  const auto count = until - from;
  f(count > 0 ? *from : kNone);
  f(count > 1 ? from[1] : kNone);
  for (auto k = std::ptrdiff_t{2}; k < count; ++k) f(from[k]);
}

// Sums the results of `count` pairs from `first` on, at most four. The formulas are those of
// `join`.
APOTHEM_INLINE void ConvexPairs::add_up(size_t first, size_t count) {
  FourOf<Four> linear_a, others_a, linear_b, others_b;
  std::array<std::uint64_t, kLanes> inside_a, inside_b;
  const Four::Mask last{Four::Mask::Vector{0, 0, 0, -1}};
  // The remaining lanes are padding, which repeats the last pair.
  const auto pair = [&](size_t k) APOTHEM_LAMBDA -> const ConvexPair& {
    return pairs_[first + std::min(k, count - 1)];
  };
  int parts = 0;
  for (size_t k = 0; k < count; ++k) parts += pair(k).of_a + pair(k).of_b;
  if (parts == 0) {
    std::fill_n(results_.begin() + static_cast<std::ptrdiff_t>(first), count, PairIntegral());
    return;
  }
  const auto sum = [&](const EdgePart* from, const EdgePart* until, Four& all_linear,
                       Four& all_others, std::uint64_t& inside) APOTHEM_LAMBDA {
    Four linear(0.), others(0.), most(0.);
    inside = 0;
    each_part(from, until, [&](const EdgePart& part) APOTHEM_LAMBDA {
      const Four more = Four::load(&part.sums.wx);
      linear += Four::load(&part.sums.fx);
      others += more;
      most = larger(most, more);
      inside |= std::uint64_t{part.enters} << part.number;
    });
    all_linear = linear;
    all_others = select(last, most, others);
  };
  for (size_t k = 0; k < kLanes; ++k) {
    const EdgePart* const of_a = parts_.data() + pair(k).first;
    const EdgePart* const of_b = of_a + pair(k).of_a;
    sum(of_a, of_b, linear_a[k], others_a[k], inside_a[k]);
    sum(of_b, of_b + pair(k).of_b, linear_b[k], others_b[k], inside_b[k]);
  }
  transpose(linear_a, linear_a);
  transpose(linear_b, linear_b);
  transpose(others_a, others_a);
  transpose(others_b, others_b);
  const auto& [fx_a, fy_a, turn_a, weight_a] = linear_a;
  const auto& [fx_b, fy_b, turn_b, weight_b] = linear_b;
  const auto& [wx_a, wy_a, length_a, most_a] = others_a;
  const auto& [wx_b, wy_b, length_b, most_b] = others_b;
  const auto lanes = [&](const auto& value) APOTHEM_LAMBDA {
    return pack_of<kLanes>([&](int k)
                               APOTHEM_LAMBDA { return value(pair(static_cast<size_t>(k))); });
  };
  const Four zero(0.);
  const Four rx = lanes([](const ConvexPair& p)
                            APOTHEM_LAMBDA { return p.a.reference_x - p.b.reference_x + p.dx; });
  const Four ry = lanes([](const ConvexPair& p)
                            APOTHEM_LAMBDA { return p.a.reference_y - p.b.reference_y + p.dy; });
  const Four fx = fx_b - fx_a, fy = fy_b - fy_a;
  const Four moment_a = turn_b - (turn_a - (rx * fy_a - ry * fx_a));
  const Four moment_b = turn_a - (turn_b + (rx * fy_b - ry * fx_b));
  const Four weight = weight_a + weight_b;
  const Four::Mask none = weight == zero;
  const Four centre_x = select(none, zero, (wx_b + (wx_a - rx * weight_a)) / weight);
  const Four centre_y = select(none, zero, (wy_b + (wy_a - ry * weight_a)) / weight);
  const Four steepest_a = lanes([](const ConvexPair& p) APOTHEM_LAMBDA { return p.a.steepest; });
  const Four steepest_b = lanes([](const ConvexPair& p) APOTHEM_LAMBDA { return p.b.steepest; });
  const Four depth_a = most_a / steepest_b, depth_b = most_b / steepest_a;
  const Four depth =
      select((steepest_a > zero) & (steepest_b > zero), larger(depth_a, depth_b), zero);
  const Four size = square_root(fx * fx + fy * fy);
  const Four nx = fx / size, ny = fy / size, shift = nx * ry - ny * rx;
  std::array<double, kLanes> low, high;
  for (size_t k = 0; k < kLanes; ++k) {
    using Two = double __attribute__((vector_size(16)));
    const EdgePart* const of_a = parts_.data() + pair(k).first;
    const EdgePart* const of_b = of_a + pair(k).of_a;
    const Two x_of = -Two{ny.v[k], ny.v[k]}, y_of{nx.v[k], nx.v[k]};
    Two lowest{HUGE_VAL, HUGE_VAL}, highest = -lowest;
    const auto include = [&](const EdgePart* from, const EdgePart* until, double own)
                             APOTHEM_LAMBDA {
                               each_part(from, until, [&](const EdgePart& part) APOTHEM_LAMBDA {
                                 Two x, y;
                                 std::memcpy(&x, &part.ends.v[0], sizeof x);
                                 std::memcpy(&y, &part.ends.v[2], sizeof y);
                                 const Two along = y_of * y + x_of * x + Two{own, own};
                                 lowest = along < lowest ? along : lowest;
                                 highest = along > highest ? along : highest;
                               });
                             };
    include(of_a, of_b, 0);
    include(of_b, of_b + pair(k).of_b, shift.v[k]);
    low[k] = std::min(lowest[0], lowest[1]), high[k] = std::max(highest[0], highest[1]);
  }
  const Four from = Four::load(low.data()), until = Four::load(high.data());
  const Four::Mask pushes = size > zero;
  const Four breadth = select(pushes, until - from, zero);
  const Four middle = select(pushes, (until + from) / Four(2.) - shift, zero);
  const auto numbers = [&](int k, int number) APOTHEM_LAMBDA {
    PairIntegral& result = results_[first + static_cast<size_t>(k)];
    return integral_numbers(result) + number;
  };
  write_rows({fx, fy, moment_a, moment_b},
             [&](int k) APOTHEM_LAMBDA { return numbers(k, kForceNumbers); });
  write_rows({weight, zero, centre_x, centre_y},
             [&](int k) APOTHEM_LAMBDA { return numbers(k, kCentreNumbers); });
  write_rows({length_a, length_b, larger(most_a, most_b), depth},
             [&](int k) APOTHEM_LAMBDA { return numbers(k, kLengthNumbers); });
  write_rows({breadth, middle, zero, zero},
             [&](int k) APOTHEM_LAMBDA { return numbers(k, kBreadthNumbers); });
  for (size_t k = 0; k < kLanes; ++k) {
    results_[first + k].inside_a = inside_a[k];
    results_[first + k].inside_b = inside_b[k];
  }
}

std::span<const PairIntegral> ConvexPairs::evaluate() {
  if (most_sides_ > room_) make_room();
  const std::span pairs(pairs_.data(), static_cast<size_t>(count_));
  if (uneven_) {
    Numbers* copies = copies_.data();
    for (ConvexPair& pair : pairs) {
      fill_up(pair.a, copies);
      fill_up(pair.b, copies);
    }
  }
  with_widest([&](auto /*lanes*/) APOTHEM_LAMBDA {
    Numbers* rows = rows_.data();
    found_ = 0;
    listed_ = {};
    for (ConvexPair& pair : pairs) find(pair, rows);
    for (int groups = 1; groups <= kGroups; ++groups) {
      ConvexEdge* const edges = edges_[static_cast<size_t>(groups - 1)].data();
      const int count = listed_[static_cast<size_t>(groups - 1)];
      // The remaining lanes are padding: they repeat the last edge, and their results are not used.
      for (int k = count; k % kLanes != 0; ++k) {
        edges[k] = edges[count - 1];
        edges[k].part = found_;
      }
      for (int first = 0; first < count; first += kLanes) {
        if (groups == 1) {
          integrate<true>(edges + first, 1);
        } else {
          integrate<false>(edges + first, groups);
        }
      }
    }
    for (size_t first = 0; first < pairs.size(); first += kLanes) {
      add_up(first, std::min<size_t>(kLanes, pairs.size() - first));
    }
    return 0.;
  });
  count_ = 0;
  uneven_ = false;
  return {results_.data(), pairs.size()};
}

}  // namespace apothem
