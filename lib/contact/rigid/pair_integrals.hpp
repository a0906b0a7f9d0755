// Normal contact of all pairs of a list of polygons, by integrals along edges
// (geometry/integrals/edge_integral.hpp).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/integrals/contact_patches.hpp"
#include "geometry/integrals/overlap_energy.hpp"
#include "lib/contact/kernel.hpp"
#include "lib/contact/law/pair_table.hpp"
#include "lib/execution/parallel.hpp"

namespace apothem {

/// Above this potential an edge is about to cross the centre of the other polygon, beyond which the
/// potential falls again.
inline constexpr double kDeepestPhi = 0.95;

/// A pair that touches.
struct PairInTouch {
  SurfaceIndex a, b;
  int number;  ///< index in the list of all touching pairs
  int worker;  ///< thread that has found the pair
  /// Index among the pairs that are split into contact patches; -1 if it is not split.
  int list_index = -1;
};

/// The touching pairs of a list of pairs, and their integrals.
class PairIntegrals {
 public:
  /// Which touching pairs are split into contact patches.
  enum class Split { none, not_convex, all };

  PairIntegrals(const Surfaces& surfaces, int threads, Split split = Split::none)
      : surfaces_(surfaces), threads_(threads), split_(split), workers_(threads_.count()) {}

  void set_pairs(std::span<const BoxPair> pairs);
  /// Computes the integrals of all pairs; the result of a pair depends on that pair alone. Calls
  /// found(pair, integral, worker) for each touching pair, in ascending order within each thread;
  /// threads with lower numbers have lower pairs.
  template <class F>
  void evaluate(const F& found) {
    begin();
    threads_.chunks(static_cast<int>(pairs_.size()), kPairTime,
                    [&](int first, int end, int worker) {
                      const std::vector<PairInTouch>& results = results_of(worker);
                      for (auto p = static_cast<size_t>(first); p < static_cast<size_t>(end);) {
                        const size_t before = results.size();
                        p = evaluate_some(p, static_cast<size_t>(end), worker);
                        for (size_t i = before; i < results.size(); ++i) {
                          found(results[i], integral(results[i]), worker);
                        }
                      }
                    });
    collect();
  }

  /// The number of pairs in the list.
  [[nodiscard]] size_t candidates() const { return pairs_.size(); }
  /// The touching pairs, ascending.
  [[nodiscard]] const std::vector<PairInTouch>& touching() const { return touching_; }
  /// The integrals of the whole pair for unit stiffness. Moments are about the reference points.
  [[nodiscard]] const PairIntegral& integral(const PairInTouch& pair) const {
    const PairWorkspace& worker = workers_[static_cast<size_t>(pair.worker)];
    return worker.integrals[static_cast<size_t>(pair.number - worker.first)];
  }
  /// An upper bound of the penetration of a touching pair, m.
  [[nodiscard]] double deepest(const PairInTouch& pair, const PairIntegral& integral) const;
  /// The patches of a pair; the whole pair if it is not split.
  [[nodiscard]] std::span<const PairIntegral> patches(const PairInTouch& pair) const {
    const PatchRanges* const ranges = patch_ranges_of(pair);
    if (!ranges || ranges->first_patch < 0) return {&integral(pair), 1};
    return std::span(workers_[static_cast<size_t>(ranges->worker)].patches)
        .subspan(static_cast<size_t>(ranges->first_patch), static_cast<size_t>(ranges->patches));
  }
  /// The boundary segments of a pair; none if it is not split.
  [[nodiscard]] std::span<const SegmentPlace> segments(const PairInTouch& pair) const {
    const PatchRanges* const ranges = patch_ranges_of(pair);
    if (!ranges) return {};
    return std::span(workers_[static_cast<size_t>(ranges->worker)].segments)
        .subspan(static_cast<size_t>(ranges->first_segment), static_cast<size_t>(ranges->segments));
  }
  /// The boundary segments with their integrals, if all pairs are split.
  [[nodiscard]] std::span<const BoundarySegment> whole_segments(const PairInTouch& pair) const {
    const PatchRanges* const ranges = patch_ranges_of(pair);
    if (!ranges || split_ != Split::all) return {};
    return std::span(workers_[static_cast<size_t>(ranges->worker)].whole_segments)
        .subspan(static_cast<size_t>(ranges->first_segment), static_cast<size_t>(ranges->segments));
  }
  /// The number of pairs that are split.
  [[nodiscard]] size_t split_pairs() const { return patch_ranges_.size(); }

  /// The energy of all pairs for unit thickness, N. It is too slow for every step.
  [[nodiscard]] double energy(const PairTable& table) const;

  /// The contact record of a pair; k is the normal stiffness times the thickness, N/m.
  [[nodiscard]] Contact contact(KernelKind kernel, const PairInTouch& pair, double k) const;
  /// True if the pair is so deep that its potentials are about to fall again.
  [[nodiscard]] bool too_deep(const PairInTouch& pair, const PairIntegral& integral) const;

 private:
  static constexpr int kFirstExponent = -6;
  static constexpr double kPairTime = 200;  // ns

  // The Verlet list of a pair: the edges that are near the other body, and the positions of the
  // bodies when the list was made.
  struct VerletList {
    NearEdges edges;
    double angle_a = 0;
    Vec2 between = Vec2::Zero();
    double angle_b = 0;
    // The requested skin is 2^skin_exponent times the smaller inradius.
    std::int16_t skin_exponent = kFirstExponent;
    std::int16_t age = 0;  // evaluations since the list was made
  };
  // The patches and boundary segments of a pair, as ranges of the lists of a thread.
  struct PatchRanges {
    int patches, segments;
    // `first_patch` is negative if the only patch is the whole pair.
    int worker, first_patch, first_segment;
  };
  struct PairWorkspace {
    PatchWorkspace workspace;
    NearEdgesWorkspace near_edges;
    std::array<size_t, ConvexPairs::kAtOnce> convex_pairs;  // indices of the collected convex pairs
    // The touching pairs that the thread has found. The results of the first thread are the
    // beginning of the list of all.
    std::vector<PairInTouch> results;
    std::vector<PairIntegral> integrals;  // their integrals
    int first = 0;                        // index of the first one in the list of all
    // The pairs that the thread has split.
    std::vector<PatchRanges> ranges;
    std::vector<SegmentPlace> segments;
    // The same segments with integrals, if all pairs are split.
    std::vector<BoundarySegment> whole_segments;
    std::vector<PairIntegral> patches;
    // The segments and patches of the present pair.
    std::vector<BoundarySegment> pair_segments;
    std::vector<PairIntegral> pair_patches;
  };
  void begin();
  size_t evaluate_some(size_t first, size_t end, int worker);
  void evaluate_convex(int worker);
  void note_distance(size_t pair, const Vec2& between);
  void add(size_t pair, const PairIntegral& integral, int worker, int list_index);
  void collect();
  void evaluate_alone(size_t pair, const PlacedPotential& view_a, const PlacedPotential& view_b,
                      int worker);
  [[nodiscard]] std::vector<PairInTouch>& results_of(int worker) {
    return worker == 0 ? touching_ : workers_[static_cast<size_t>(worker)].results;
  }
  [[nodiscard]] const PatchRanges* patch_ranges_of(const PairInTouch& pair) const {
    return pair.list_index < 0 ? nullptr : &patch_ranges_[static_cast<size_t>(pair.list_index)];
  }
  void update_verlet_list(size_t pair, const Vec2& between, NearEdgesWorkspace& workspace);

  const Surfaces& surfaces_;
  Threads threads_;
  Split split_;
  std::vector<BoxPair> pairs_;
  std::vector<VerletList> verlet_lists_;  // Verlet list of each pair
  std::vector<PairInTouch> touching_;
  std::vector<PatchRanges> patch_ranges_;  // of each pair that is split
  mutable std::vector<double> energies_;   // energy of each touching pair, found when asked for, N
  mutable std::vector<OverlapEnergy> energy_memory_;  // of each thread
  std::vector<PairWorkspace> workers_;
};

}  // namespace apothem
