#include "lib/contact/rigid/pair_integrals.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace apothem {
namespace {

// A Verlet list is renewed when the bodies have moved by this fraction of its skin.
constexpr double kUsableSkin = .99;
// The skin of a Verlet list is 2^exponent times the smaller inradius. The exponent rises where
// bodies move fast, so that a list lasts for some tens of evaluations, and falls in packs at rest,
// so that few edges are listed.
constexpr int kSmallestExponent = -10;
constexpr int kLargestExponent = -3;
constexpr int kYoung = 32;
constexpr size_t kPairsAhead = 16;  // number of pairs that are prefetched, for large scenes
constexpr int kOld = 256;

// Makes room for one more element. The capacity grows by little, because large scenes need the
// memory.
template <class T>
void make_room(std::vector<T>& list) {
  if (list.size() == list.capacity()) list.reserve(list.size() * 9 / 8 + 16);
}

}  // namespace

// Pairs that existed before keep their Verlet lists. The old lists are not kept as buffers:
// searches are rare, and large scenes need the memory.
void PairIntegrals::set_pairs(std::span<const BoxPair> pairs) {
  const std::vector<BoxPair> pairs_before = std::move(pairs_);
  const std::vector<VerletList> lists_before = std::move(verlet_lists_);
  pairs_.assign(pairs.begin(), pairs.end());
  verlet_lists_.assign(pairs_.size(), {});
  size_t old = 0;
  for (size_t p = 0; p < pairs_.size(); ++p) {
    while (old < pairs_before.size() && pairs_before[old] < pairs_[p]) ++old;
    if (old == pairs_before.size()) break;
    if (pairs_before[old] == pairs_[p]) verlet_lists_[p] = lists_before[old++];
  }
  touching_.clear();
}

void PairIntegrals::begin() {
  touching_.clear();
  for (PairWorkspace& worker : workers_) {
    worker.results.clear();
    worker.integrals.clear();
    worker.first = 0;
    worker.ranges.clear();
    worker.segments.clear();
    worker.whole_segments.clear();
    worker.patches.clear();
  }
}

// Renews the Verlet list of a pair if the bodies have moved relative to each other by more than its
// skin.
void PairIntegrals::update_verlet_list(size_t p, const Vec2& between,
                                       NearEdgesWorkspace& workspace) {
  const auto [a, b] = pairs_[p];
  const PlacedShapes& shapes = surfaces_.shapes();
  VerletList& near = verlet_lists_[p];
  const bool convex = shapes.convex(a) && shapes.convex(b);
  if (convex && near.edges.skin == 0) return;  // pair_integral finds their distance
  const double turn_a = surfaces_.pose(a)[2];
  const double turn_b = surfaces_.pose(b)[2];
  const Vec2 shift = between - near.between;
  const double moved = std::abs(shift.x()) + std::abs(shift.y()) +
                       std::abs(turn_a - near.angle_a) * shapes.radius(a) +
                       std::abs(turn_b - near.angle_b) * shapes.radius(b);
  const bool known = moved < kUsableSkin * near.edges.skin;
  const bool narrow = near.edges.none() || near.skin_exponent <= kSmallestExponent;
  near.age = static_cast<std::int16_t>(std::min(near.age + 1, kOld));
  if (known && (narrow || near.age < kOld)) return;
  if (known) {
    near.skin_exponent = static_cast<std::int16_t>(near.skin_exponent - 2);
  } else if (near.edges.skin > 0 && !near.edges.none() && near.age < kYoung) {
    near.skin_exponent =
        static_cast<std::int16_t>(std::min(near.skin_exponent + 1, kLargestExponent));
  }
  near = {{}, turn_a, between, turn_b, near.skin_exponent, 0};
  if (convex || !surfaces_.is_rigid(a) || !surfaces_.is_rigid(b)) return;
  const PlacedPotential view_a = shapes.view(a);
  const PlacedPotential view_b = shapes.view(b);
  const double skin =
      std::ldexp(std::min(surfaces_.inradius(a), surfaces_.inradius(b)), near.skin_exponent);
  near.edges = near_edges(view_a, view_b, between, skin, workspace);
}

// Evaluates pairs from `first` on until a batch of convex pairs is full. Returns the index of the
// next pair.
size_t PairIntegrals::evaluate_some(size_t first, size_t end, int index) {
  const PlacedShapes& shapes = surfaces_.shapes();
  const std::vector<Box>& boxes = shapes.boxes();
  PairWorkspace& worker = workers_[static_cast<size_t>(index)];
  size_t p = first;
  for (; p < end && !worker.workspace.edge.convex.full(); ++p) {
    if (p + kPairsAhead < end) {
      surfaces_.fetch(pairs_[p + kPairsAhead].second);
      __builtin_prefetch(&verlet_lists_[p + kPairsAhead]);
      shapes.fetch_coordinates(pairs_[p + kPairsAhead / 2].second);
    }
    const auto [a, b] = pairs_[p];
    if (apart(boxes[static_cast<size_t>(a)], boxes[static_cast<size_t>(b)])) continue;
    const Vec2 between = surfaces_.between(a, b);
    update_verlet_list(p, between, worker.near_edges);
    if (verlet_lists_[p].edges.none()) continue;
    const PlacedPotential view_a = shapes.view(a);
    const PlacedPotential view_b = shapes.view(b);
    if (split_ != Split::all && ConvexPairs::serves(view_a) && ConvexPairs::serves(view_b)) {
      worker.convex_pairs[static_cast<size_t>(worker.workspace.edge.convex.count())] = p;
      worker.workspace.edge.convex.add(view_a, view_b, between, verlet_lists_[p].edges);
    } else {
      evaluate_convex(index);  // evaluates the convex pairs before this one
      evaluate_alone(p, view_a, view_b, index);
    }
  }
  evaluate_convex(index);
  return p;
}

void PairIntegrals::evaluate_convex(int index) {
  PairWorkspace& worker = workers_[static_cast<size_t>(index)];
  if (worker.workspace.edge.convex.count() == 0) return;
  const size_t* pair = worker.convex_pairs.data();
  for (const PairIntegral& integral : worker.workspace.edge.convex.evaluate()) {
    const size_t p = *pair++;
    if (integral.touching()) {
      add(p, integral, index, -1);
    } else if (verlet_lists_[p].edges.skin > 0) {
      note_distance(p, surfaces_.between(pairs_[p].first, pairs_[p].second));
    }
  }
}

// Notes that the polygons are apart by the skin at the present positions of their bodies.
void PairIntegrals::note_distance(size_t p, const Vec2& between) {
  verlet_lists_[p].between = between;
  verlet_lists_[p].angle_a = surfaces_.pose(pairs_[p].first)[2];
  verlet_lists_[p].angle_b = surfaces_.pose(pairs_[p].second)[2];
}

void PairIntegrals::add(size_t p, const PairIntegral& integral, int index, int list_index) {
  PairWorkspace& worker = workers_[static_cast<size_t>(index)];
  std::vector<PairInTouch>& results = results_of(index);
  make_room(worker.integrals);
  worker.integrals.push_back(integral);
  make_room(results);
  const auto number = static_cast<int>(results.size());
  results.push_back({pairs_[p].first, pairs_[p].second, number, index, list_index});
}

// Joins the lists of the threads.
void PairIntegrals::collect() {
  patch_ranges_.clear();
  for (PairWorkspace& worker : workers_) {
    const auto first_index = static_cast<int>(patch_ranges_.size());
    worker.first = &worker == workers_.data() ? 0 : static_cast<int>(touching_.size());
    for (PairInTouch pair : worker.results) {
      if (pair.list_index >= 0) pair.list_index += first_index;
      pair.number += worker.first;
      make_room(touching_);
      touching_.push_back(pair);
    }
    patch_ranges_.insert(patch_ranges_.end(), worker.ranges.begin(), worker.ranges.end());
  }
}

void PairIntegrals::evaluate_alone(size_t p, const PlacedPotential& view_a,
                                   const PlacedPotential& view_b, int index) {
  PairWorkspace& worker = workers_[static_cast<size_t>(index)];
  const auto [a, b] = pairs_[p];
  const Vec2 between = surfaces_.between(a, b);
  NearEdges& near = verlet_lists_[p].edges;
  const bool is_split = split_ == Split::all ||
                        (split_ == Split::not_convex && !(view_a.convex() && view_b.convex()));
  const double skin = near.skin;
  const PairIntegral integral =
      is_split ? contact_patches(view_a, view_b, between, worker.workspace, worker.pair_segments,
                                 worker.pair_patches, near)
               : pair_integral(view_a, view_b, between, worker.workspace.edge, near);
  if (near.skin > skin) note_distance(p, between);
  if (!integral.touching()) return;
  if (!is_split) {
    add(p, integral, index, -1);
    return;
  }
  PatchRanges ranges{static_cast<int>(worker.pair_patches.size()),
                     static_cast<int>(worker.pair_segments.size()), index, -1,
                     static_cast<int>(worker.segments.size())};
  worker.segments.insert(worker.segments.end(), worker.pair_segments.begin(),
                         worker.pair_segments.end());
  if (split_ == Split::all) {
    worker.whole_segments.insert(worker.whole_segments.end(), worker.pair_segments.begin(),
                                 worker.pair_segments.end());
  }
  if (ranges.patches != 1) {  // a single patch is the whole pair
    ranges.first_patch = static_cast<int>(worker.patches.size());
    worker.patches.insert(worker.patches.end(), worker.pair_patches.begin(),
                          worker.pair_patches.end());
  }
  add(p, integral, index, static_cast<int>(worker.ranges.size()));
  worker.ranges.push_back(ranges);
}

double PairIntegrals::energy(const PairTable& table) const {
  const PlacedShapes& shapes = surfaces_.shapes();
  energies_.resize(touching_.size());
  energy_memory_.resize(static_cast<size_t>(threads_.count()));
  threads_.chunks(static_cast<int>(touching_.size()), kPairTime, [&](int first, int end, int at) {
    OverlapEnergy& memory = energy_memory_[static_cast<size_t>(at)];
    for (auto i = static_cast<size_t>(first); i < static_cast<size_t>(end); ++i) {
      const SurfaceIndex a = touching_[i].a, b = touching_[i].b;
      const double k = table.between(surfaces_.body(a), surfaces_.body(b)).normal_stiffness;
      energies_[i] =
          k * pair_energy(shapes.view(a), shapes.view(b), surfaces_.between(a, b), memory);
    }
  });
  return std::accumulate(energies_.begin(), energies_.end(), 0.);
}

// A largest phi of 1 gives no bound, because phi may be limited to 1.
double PairIntegrals::deepest(const PairInTouch& pair, const PairIntegral& integral) const {
  const PlacedShapes& shapes = surfaces_.shapes();
  const double ratio = std::max(shapes.depth_ratio(pair.a), shapes.depth_ratio(pair.b));
  return integral.largest_phi < 1 ? ratio * integral.depth : HUGE_VAL;
}

Contact PairIntegrals::contact(KernelKind kernel, const PairInTouch& result, double k) const {
  const SurfaceIndex a = result.a, b = result.b;
  const PairIntegral& pair = integral(result);
  const PlacedShapes& shapes = surfaces_.shapes();
  return {kernel,
          a,
          b,
          pair.depth,
          deepest(result, pair),
          pair.largest_phi,
          k * (pair.own_length_a * shapes.slope(b) + pair.own_length_b * shapes.slope(a))};
}

bool PairIntegrals::too_deep(const PairInTouch& result, const PairIntegral& pair) const {
  const SurfaceIndex a = result.a, b = result.b;
  if (!(pair.largest_phi <= kDeepestPhi)) return true;
  // If an overlap contains the centre of a polygon's incircle, its boundary is long: the polygon's
  // own boundary is at least an inradius away from the centre, and the other one is nearer by at
  // most the depth. So a short boundary excludes this case. The highest point of a shape that
  // deforms is not the centre, and the bound is weaker.
  const double inradius = std::min(surfaces_.inradius(a), surfaces_.inradius(b));
  const bool rigid = surfaces_.is_rigid(a) && surfaces_.is_rigid(b);
  const double shortest = rigid ? 6 * (inradius - deepest(result, pair)) : inradius;
  if (pair.own_length_a + pair.own_length_b < shortest) return false;
  const PlacedShapes& shapes = surfaces_.shapes();
  const Vec2 offset = surfaces_.between(a, b);
  const double away2 = offset.squaredNorm();
  const auto inside = [&](SurfaceIndex i, SurfaceIndex j, const Vec2& from) {
    const double reach = shapes.top_reach(i, j);
    return !(away2 > reach * reach) && shapes.top_inside(i, j, from);
  };
  return inside(a, b, offset) || inside(b, a, -offset);
}

}  // namespace apothem
