#include "geometry/integrals/convex_window.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/integrals/edge_trace.hpp"
#include "geometry/polygon/segment.hpp"

namespace apothem {

using namespace edge_detail;

namespace {

constexpr int kFewEdges = 6;  // edges of the first windows
constexpr int kSamples = 32;  // lines that are compared before those beside the lowest of them
constexpr int kRounds = 2;    // of the search for the nearest edges
constexpr double kAmply = 1 + 1e-6;

double height(const PlacedPotential& p, int e, const Vec2& point) {
  return p.gx[e] * (point.x() - p.x[e]) + p.gy[e] * (point.y() - p.y[e]);
}

// An edge of p whose line is low at a point: lower than those beside it, but not surely the lowest.
int low_line(const PlacedPotential& p, const Vec2& point) {
  int best = 0;
  double lowest = height(p, 0, point);
  const auto is_lower = [&](int e) {
    const double h = height(p, e, point);
    if (!(h < lowest)) return false;
    best = e, lowest = h;
    return true;
  };
  const int stride = std::max(1, p.size / kSamples);
  for (int e = stride; e < p.size; e += stride) is_lower(e);
  for (const int direction : {1, p.size - 1}) {
    while (is_lower((best + direction) % p.size)) {
    }
  }
  return best;
}

Vec2 nearest_on_edge(const PlacedPotential& p, int e, const Vec2& point) {
  const Vec2 from(p.x[e], p.y[e]), edge = Vec2(p.x[e + 1], p.y[e + 1]) - from;
  return from + nearest_on_segment(point - from, edge).share * edge;
}

// Two edges that are near each other, found by going to and fro between the polygons.
std::array<int, 2> near_edges_of(const PlacedPotential& a, const PlacedPotential& b,
                                 const Vec2& offset) {
  std::array<int, 2> edges{};
  Vec2 on_a = a.reference;
  for (int k = 0; k < kRounds; ++k) {
    edges[1] = low_line(b, on_a + offset);
    const Vec2 on_b = nearest_on_edge(b, edges[1], on_a + offset);
    edges[0] = low_line(a, on_b - offset);
    on_a = nearest_on_edge(a, edges[0], on_b - offset);
  }
  return edges;
}

// The largest distance from x to y beyond an edge of y, with x moved by `shift`, m; 0 if none is
// found. A vertex of a convex polygon that is nearer than both beside it is the nearest one.
double gap_beyond(const ConvexWindow& x, const ConvexWindow& y, const Vec2& shift) {
  const PlacedPotential &of_x = x.view(), &of_y = y.view();
  double gap = 0;
  for (int e = 0; e < of_y.size; ++e) {
    if (y.number(e) < 0) continue;
    int nearest = 0;
    double highest = -HUGE_VAL;
    for (int v = 0; v < of_x.size; ++v) {
      const double h = height(of_y, e, Vec2(of_x.x[v], of_x.y[v]) + shift);
      if (h > highest) highest = h, nearest = v;
    }
    if (x.is_inner(nearest)) gap = std::max(gap, -highest / of_y.steepest);
  }
  return gap;
}

// What is known of the overlap of two windows.
struct WindowOverlap {
  std::array<double, 2> margin{HUGE_VAL, HUGE_VAL};  // least distances from the closing sides, m
  std::array<int, 2> first{-1, -1}, last{-1, -1};    // the first and last edges with segments
  std::array<std::uint64_t, 2> inside{};             // as in PairIntegral
};

}  // namespace

void ConvexWindow::add(const PlacedPotential& p, int first, int end) {
  double* const x = coordinates_.data();
  const auto stride = static_cast<std::ptrdiff_t>(coordinates_.size() / 4);
  for (int v = first; v < end; ++v) {
    const auto at = static_cast<std::ptrdiff_t>(numbers_.size());
    x[at] = p.x[v], x[stride + at] = p.y[v];
    x[2 * stride + at] = p.gx[v], x[3 * stride + at] = p.gy[v];
    numbers_.push_back(v);
  }
}

// Makes `side` a closing side, with the slope of the other lines.
void ConvexWindow::close(int side, double slope) {
  const auto stride = static_cast<std::ptrdiff_t>(coordinates_.size() / 4);
  double* const x = coordinates_.data() + side;
  const Vec2 along(x[1] - x[0], x[stride + 1] - x[stride]);
  const double scale = slope / along.norm();
  x[2 * stride] = -scale * along.y(), x[3 * stride] = scale * along.x();
  numbers_[static_cast<size_t>(side)] = -1;
}

// The edges stay in their order in the polygon, so that sums over them have the same bits.
bool ConvexWindow::cut(const PlacedPotential& p, int middle, int edges) {
  const int n = p.size, sides = edges + 2;
  whole_ = sides >= n;
  view_ = p;
  if (whole_) return true;
  if (p.capped) return false;  // phi does not say how deep a point is
  const int first = (middle - edges / 2 + n) % n, last = (first + edges) % n;
  const int opposite = (middle + n / 2) % n;
  inside_ = (Vec2(p.x[middle], p.y[middle]) + Vec2(p.x[opposite], p.y[opposite])) / 2;
  first_ = Vec2(p.x[first], p.y[first]) - inside_;
  last_ = Vec2(p.x[last], p.y[last]) - inside_;
  if (!(cross(first_, last_) > 0)) return false;
  coordinates_.resize(4 * (static_cast<size_t>(sides) + 1));
  numbers_.clear();
  add(p, last < first ? 0 : first, last + 1);
  const auto corner = static_cast<int>(numbers_.size());
  add(p, last, last + 1);
  if (last < first) add(p, first, n);
  const auto stride = static_cast<std::ptrdiff_t>(sides) + 1;
  double* const x = coordinates_.data();
  x[corner] = inside_.x(), x[stride + corner] = inside_.y();
  x[sides] = x[0], x[stride + sides] = x[stride];
  close(corner - 1, p.steepest), close(corner, p.steepest);
  first_ /= first_.norm(), last_ /= last_.norm();
  view_.x = x, view_.y = x + stride, view_.gx = x + 2 * stride, view_.gy = x + 3 * stride;
  view_.size = sides;
  return true;
}

double ConvexWindow::margin(const Vec2& point) const {
  if (whole_) return HUGE_VAL;
  const Vec2 from = point - inside_;
  return std::min(cross(first_, from), cross(from, last_));
}

bool ConvexWindow::is_inner(int vertex) const {
  return whole_ || (number(vertex) >= 0 && number((vertex > 0 ? vertex : view_.size) - 1) >= 0);
}

std::optional<PairIntegral> windowed_integral(const PlacedPotential& a, const PlacedPotential& b,
                                              const Vec2& offset, NearEdges& near,
                                              EdgeWorkspace& workspace) {
  const double round_off = kRoundOff * (a.radius + b.radius);
  ConvexWindow &window_a = workspace.windows.a, &window_b = workspace.windows.b;
  std::array<int, 2> middle = near_edges_of(a, b, offset);
  for (int edges = kFewEdges; 2 * edges < std::max(a.size, b.size); edges = 2 * edges + 2) {
    if (!window_a.cut(a, middle[0], edges) || !window_b.cut(b, middle[1], edges)) break;
    WindowOverlap overlap;
    const auto segment = [&](bool of_a, int e, const auto& edge, const SegmentSpan& span,
                             const EdgeSums<double>&) {
      const size_t own = of_a ? 0 : 1;
      const int number = (of_a ? window_a : window_b).number(e);
      if (number >= 0 && edge.fraction(span.s0) == 0) {
        overlap.inside[own] ^= std::uint64_t{1} << (number % 64);
      }
      if (overlap.first[own] < 0) overlap.first[own] = e;
      overlap.last[own] = e;
      for (const double s : {span.s0, span.s1}) {
        const Vec2 end = Vec2(edge.qx + s * edge.ex, edge.qy + s * edge.ey) +
                         (of_a ? b.reference : a.reference + offset);
        overlap.margin[0] = std::min(overlap.margin[0], window_a.margin(end - offset));
        overlap.margin[1] = std::min(overlap.margin[1], window_b.margin(end));
      }
    };
    NearEdges all{.skin = HUGE_VAL};
    PairIntegral pair = integrate_pair<false>(
        window_a.view(), window_b.view(), offset, all, workspace, [&] { overlap = {}; }, segment);
    if (!pair.touching()) {
      const double gap =
          std::max(gap_beyond(window_a, window_b, offset), gap_beyond(window_b, window_a, -offset));
      if (!(gap > 2 * round_off)) continue;
      if (near.skin == 0) near = {0, 0, gap - round_off};
      return PairIntegral();
    }
    const auto holds = [&](const PlacedPotential& p, double margin) {
      return margin > kAmply * pair.largest_phi / p.steepest + round_off;
    };
    if (holds(a, overlap.margin[0]) && holds(b, overlap.margin[1])) {
      pair.inside_a = overlap.inside[0], pair.inside_b = overlap.inside[1];
      return pair;
    }
    for (const size_t k : {0, 1}) {
      const ConvexWindow& window = k == 0 ? window_a : window_b;
      const int number =
          overlap.first[k] < 0 ? -1 : window.number((overlap.first[k] + overlap.last[k]) / 2);
      if (number >= 0) middle[k] = number;
    }
  }
  return {};
}

}  // namespace apothem
