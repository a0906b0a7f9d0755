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

// Pairs that were there before keep what is known of their edges. The lists of before are not kept:
// searches are rare, and large scenes need the memory.
void PairIntegrals::take(std::span<const BoxPair> pairs) {
  const std::vector<BoxPair> pairs_before = std::move(pairs_);
  const std::vector<Near> near_before = std::move(near_);
  pairs_.assign(pairs.begin(), pairs.end());
  near_.assign(pairs_.size(), {});
  size_t old = 0;
  for (size_t p = 0; p < pairs_.size(); ++p) {
    while (old < pairs_before.size() && pairs_before[old] < pairs_[p]) ++old;
    if (old == pairs_before.size()) break;
    if (pairs_before[old] == pairs_[p]) near_[p] = near_before[old];
  }
}

void PairIntegrals::begin() {
  slots_.resize(pairs_.size());
  for (Worker& worker : workers_) {
    worker.integrals.clear();
    worker.parts.clear();
    worker.runs.clear();
    worker.patches.clear();
  }
}

// Finds the near edges anew if the bodies have moved against each other by more than the margin.
void PairIntegrals::find_near(size_t p, const Vec2& between, NearEdgesWorkspace& workspace) {
  const auto [a, b] = pairs_[p];
  const PlacedShapes& shapes = surfaces_.shapes();
  Near& near = near_[p];
  const bool convex = shapes.convex(a) && shapes.convex(b);
  if (convex && near.edges.margin == 0) return;  // pair_integral tells their distance
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
  if (convex || !surfaces_.is_rigid(a) || !surfaces_.is_rigid(b)) return;
  const PlacedPotential view_a = shapes.view(a);
  const PlacedPotential view_b = shapes.view(b);
  const double margin = near.share * std::min(surfaces_.inradius(a), surfaces_.inradius(b));
  near.edges = near_edges(view_a, view_b, between, margin, workspace);
}

void PairIntegrals::evaluate_pair(size_t p, int index) {
  Worker& worker = workers_[static_cast<size_t>(index)];
  Parts parts;
  const PairIntegral integral = integrate(p, worker, parts);
  if (!integral.touching()) {
    slots_[p].worker = -1;
    return;
  }
  slots_[p] = {index, static_cast<int>(worker.integrals.size())};
  if (worker.integrals.size() == worker.integrals.capacity()) {
    worker.integrals.reserve(worker.integrals.size() * 9 / 8 + 16);  // large scenes need the memory
  }
  worker.integrals.push_back(integral);
  if (split_ != Split::none) worker.parts.push_back(parts);
}

PairIntegral PairIntegrals::integrate(size_t p, Worker& worker, Parts& parts) {
  const auto [a, b] = pairs_[p];
  const PlacedShapes& shapes = surfaces_.shapes();
  if (apart(shapes.boxes()[static_cast<size_t>(a)], shapes.boxes()[static_cast<size_t>(b)])) {
    return {};
  }
  const Vec2 between = surfaces_.between(a, b);
  find_near(p, between, worker.near_edges);
  NearEdges& near = near_[p].edges;
  if (near.none()) return {};
  const PlacedPotential view_a = shapes.view(a);
  const PlacedPotential view_b = shapes.view(b);
  const bool split = split_ == Split::all ||
                     (split_ == Split::not_convex && !(view_a.convex() && view_b.convex()));
  const double margin = near.margin;
  const PairIntegral integral =
      split ? contact_patches(view_a, view_b, between, worker.workspace, worker.pair_runs,
                              worker.pair_patches, near)
            : pair_integral(view_a, view_b, between, worker.workspace.edge, near);
  if (near.margin > margin) {  // they are apart by it where they are now
    near_[p].between = between;
    near_[p].angle_a = surfaces_.pose(a)[2];
    near_[p].angle_b = surfaces_.pose(b)[2];
  }
  if (!split) return integral;
  parts = {static_cast<int>(worker.patches.size()), static_cast<int>(worker.pair_patches.size()),
           static_cast<int>(worker.runs.size()), static_cast<int>(worker.pair_runs.size())};
  worker.patches.insert(worker.patches.end(), worker.pair_patches.begin(),
                        worker.pair_patches.end());
  worker.runs.insert(worker.runs.end(), worker.pair_runs.begin(), worker.pair_runs.end());
  return integral;
}

const PairIntegrals::Parts* PairIntegrals::parts_of(const Slot& slot) const {
  if (split_ == Split::none || slot.worker < 0) return nullptr;
  const Parts& parts = worker_of(slot).parts[static_cast<size_t>(slot.index)];
  return parts.first_patch < 0 ? nullptr : &parts;
}

std::span<const PairIntegral> PairIntegrals::patches(size_t pair) const {
  const Slot& slot = slots_[pair];
  const Parts* const parts = parts_of(slot);
  if (!parts) return {&(*this)[pair], 1};
  return std::span(worker_of(slot).patches)
      .subspan(static_cast<size_t>(parts->first_patch), static_cast<size_t>(parts->patches));
}

std::span<const BoundaryRun> PairIntegrals::runs(size_t pair) const {
  const Slot& slot = slots_[pair];
  const Parts* const parts = parts_of(slot);
  if (!parts) return {};
  return std::span(worker_of(slot).runs)
      .subspan(static_cast<size_t>(parts->first_run), static_cast<size_t>(parts->runs));
}

double PairIntegrals::energy(const PairTable& table) const {
  const PlacedShapes& shapes = surfaces_.shapes();
  double energy = 0;
  for (size_t p = 0; p < pairs_.size(); ++p) {
    if (slots_[p].worker < 0) continue;
    const auto [a, b] = pairs_[p];
    const double k = table.between(surfaces_.body(a), surfaces_.body(b)).normal_stiffness;
    energy += k * pair_volume(shapes.view(a), shapes.view(b), surfaces_.between(a, b)).energy;
  }
  return energy;
}

Contact PairIntegrals::contact(KernelKind kernel, size_t p, double k) const {
  const auto [a, b] = pairs_[p];
  const PairIntegral& pair = (*this)[p];
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
  const PairIntegral& pair = (*this)[p];
  if (!(pair.largest_phi <= kDeepestPhi)) return true;
  if (pair.own_length_a + pair.own_length_b <
      std::min(surfaces_.inradius(a), surfaces_.inradius(b))) {
    return false;
  }
  const PlacedShapes& shapes = surfaces_.shapes();
  const Vec2 offset = surfaces_.between(a, b);
  return shapes.top_inside(a, b, offset) || shapes.top_inside(b, a, -offset);
}

}  // namespace apothem
