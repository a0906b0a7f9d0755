#include "apothem/contact/pair_integrals.hpp"

#include <algorithm>
#include <cmath>

namespace apothem {
namespace {

constexpr double kMoved = .99;  // of the margin, beyond which near edges are found again
// The margin is larger where bodies move faster, so that near edges are found again after some tens
// of evaluations, and smaller in packs at rest, where few edges are near. Of the smaller inradius:
constexpr double kSmallestMargin = 1. / 1024;
constexpr double kLargestMargin = 1. / 8;
constexpr int kSoon = 32;
constexpr int kLate = 256;

}  // namespace

// Pairs that were there before keep what is known of their edges.
void PairIntegrals::take(std::span<const BoxPair> pairs) {
  std::swap(pairs_, pairs_before_);
  std::swap(near_, near_before_);
  pairs_.assign(pairs.begin(), pairs.end());
  near_.assign(pairs_.size(), {});
  size_t old = 0;
  for (size_t p = 0; p < pairs_.size(); ++p) {
    while (old < pairs_before_.size() && pairs_before_[old] < pairs_[p]) ++old;
    if (old == pairs_before_.size()) break;
    if (pairs_before_[old] == pairs_[p]) near_[p] = near_before_[old];
  }
}

void PairIntegrals::begin() {
  integrals_.resize(pairs_.size());
  if (split_ != Split::none) parts_.resize(pairs_.size());
  for (Worker& worker : workers_) {
    worker.runs.clear();
    worker.patches.clear();
  }
}

// Finds the near edges anew if the bodies have moved against each other by more than the margin.
void PairIntegrals::find_near(size_t p, const Vec2& between, NearEdgesWorkspace& workspace) {
  const auto [a, b] = pairs_[p];
  const PlacedShapes& shapes = surfaces_.shapes();
  Near& near = near_[p];
  const double turn_a = surfaces_.pose(a)[2];
  const double turn_b = surfaces_.pose(b)[2];
  const Vec2 shift = between - near.between;
  const double moved = std::abs(shift.x()) + std::abs(shift.y()) +
                       std::abs(turn_a - near.angle_a) * shapes.radius(a) +
                       std::abs(turn_b - near.angle_b) * shapes.radius(b);
  const bool known = moved < kMoved * near.edges.margin;
  const bool narrow = near.edges.none() || near.share <= kSmallestMargin;
  near.age = std::min(near.age + 1, kLate);
  if (known && (narrow || near.age < kLate)) return;
  if (known) {
    near.share /= 4;
  } else if (near.edges.margin > 0 && !near.edges.none() && near.age < kSoon) {
    near.share = std::min(2 * near.share, kLargestMargin);
  }
  near = {{}, between, turn_a, turn_b, near.share, 0};
  if (!surfaces_.is_rigid(a) || !surfaces_.is_rigid(b)) return;
  const PlacedPotential view_a = shapes.view(a);
  const PlacedPotential view_b = shapes.view(b);
  if (view_a.convex() && view_b.convex()) return;  // pair_integral tells their distance
  const double margin = near.share * std::min(surfaces_.inradius(a), surfaces_.inradius(b));
  near.edges = near_edges(view_a, view_b, between, margin, workspace);
}

void PairIntegrals::evaluate_pair(size_t p, int index) {
  const auto [a, b] = pairs_[p];
  const PlacedShapes& shapes = surfaces_.shapes();
  if (apart(shapes.boxes()[static_cast<size_t>(a)], shapes.boxes()[static_cast<size_t>(b)])) {
    integrals_[p] = {};
    return;
  }
  const Vec2 between = surfaces_.between(a, b);
  Worker& worker = workers_[static_cast<size_t>(index)];
  find_near(p, between, worker.near_edges);
  NearEdges& near = near_[p].edges;
  if (near.none()) {
    integrals_[p] = {};
    return;
  }
  const PlacedPotential view_a = shapes.view(a);
  const PlacedPotential view_b = shapes.view(b);
  const bool split = split_ == Split::all ||
                     (split_ == Split::not_convex && !(view_a.convex() && view_b.convex()));
  if (!split) {
    integrals_[p] = pair_integral(view_a, view_b, between, worker.workspace.edge, near);
    if (split_ != Split::none) parts_[p] = {};
    return;
  }
  integrals_[p] = contact_patches(view_a, view_b, between, worker.workspace, worker.pair_runs,
                                  worker.pair_patches, near);
  parts_[p] = {index, static_cast<int>(worker.patches.size()),
               static_cast<int>(worker.pair_patches.size()), static_cast<int>(worker.runs.size()),
               static_cast<int>(worker.pair_runs.size())};
  worker.patches.insert(worker.patches.end(), worker.pair_patches.begin(),
                        worker.pair_patches.end());
  worker.runs.insert(worker.runs.end(), worker.pair_runs.begin(), worker.pair_runs.end());
}

std::span<const PairIntegral> PairIntegrals::patches(size_t pair) const {
  if (parts_.empty() || parts_[pair].worker < 0) return {&integrals_[pair], 1};
  const Parts& parts = parts_[pair];
  return std::span(workers_[static_cast<size_t>(parts.worker)].patches)
      .subspan(static_cast<size_t>(parts.first_patch), static_cast<size_t>(parts.patches));
}

std::span<const BoundaryRun> PairIntegrals::runs(size_t pair) const {
  if (parts_.empty() || parts_[pair].worker < 0) return {};
  const Parts& parts = parts_[pair];
  return std::span(workers_[static_cast<size_t>(parts.worker)].runs)
      .subspan(static_cast<size_t>(parts.first_run), static_cast<size_t>(parts.runs));
}

double PairIntegrals::energy(const PairTable& table) const {
  const PlacedShapes& shapes = surfaces_.shapes();
  double energy = 0;
  for (size_t p = 0; p < pairs_.size(); ++p) {
    if (!integrals_[p].touching()) continue;
    const auto [a, b] = pairs_[p];
    const double k = table.between(surfaces_.body(a), surfaces_.body(b)).normal_stiffness;
    energy += k * pair_volume(shapes.view(a), shapes.view(b), surfaces_.between(a, b)).energy;
  }
  return energy;
}

Contact PairIntegrals::contact(KernelKind kernel, size_t p, double k) const {
  const auto [a, b] = pairs_[p];
  const PairIntegral& pair = integrals_[p];
  const PlacedShapes& shapes = surfaces_.shapes();
  const double ratio = std::max(shapes.depth_ratio(a), shapes.depth_ratio(b));
  return {kernel,
          a,
          b,
          pair.depth,
          pair.largest_phi < 1 ? ratio * pair.depth : HUGE_VAL,  // phi may be limited to 1
          pair.largest_phi,
          k * (pair.own_length_a * shapes.slope(b) + pair.own_length_b * shapes.slope(a))};
}

bool PairIntegrals::too_deep(size_t p) const {
  const auto [a, b] = pairs_[p];
  const PairIntegral& pair = integrals_[p];
  if (!(pair.largest_phi <= kDeepestPhi)) return true;
  if (pair.own_length_a + pair.own_length_b <
      std::min(surfaces_.inradius(a), surfaces_.inradius(b))) {
    return false;
  }
  const PlacedShapes& shapes = surfaces_.shapes();
  const Vec2 offset = surfaces_.between(a, b);
  return shapes.top_inside(a, surfaces_.pose(a)[2], b, offset) ||
         shapes.top_inside(b, surfaces_.pose(b)[2], a, -offset);
}

}  // namespace apothem
