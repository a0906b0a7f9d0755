// The pair kernel on lists of polygons: normal contact by integrals along edges
// (geometry/integrals/edge_integral.hpp).
#pragma once

#include <array>
#include <span>
#include <vector>

#include "apothem/contact/kernel.hpp"
#include "apothem/contact/pair_table.hpp"
#include "apothem/execution/parallel.hpp"
#include "apothem/geometry/integrals/contact_patches.hpp"

namespace apothem {

/// Beyond this potential an edge is about to cross the centre of the other polygon, where the
/// potential falls again.
inline constexpr double kDeepestPhi = 0.95;

/// A pair that touches, and what has been found of it.
struct PairInTouch {
  SurfaceIndex a, b;
  const PairIntegral* integral = nullptr;  ///< of the whole pair, for unit stiffness; force on a,
                                           ///< moments about the reference points
  double deepest = 0;                      ///< a bound of the penetration, m
  int patches = 1;                         ///< contact patches: one if it is not split
  int runs = 0;                            ///< runs of the boundaries; none if it is not split
  // Where these are, among those that a thread has found.
  int worker = 0, first_patch = -1, first_run = 0;
};

class PairIntegrals {
 public:
  /// Which touching pairs are split into contact patches.
  enum class Split { none, not_convex, all };

  PairIntegrals(const Surfaces& surfaces, int threads, Split split = Split::none)
      : surfaces_(surfaces), threads_(threads), split_(split), workers_(threads_.count()) {}

  void take(std::span<const BoxPair> pairs);
  /// Integrals of all pairs; the result of a pair depends on that pair alone. Calls found(result,
  /// worker) for each that touches, in ascending order within each thread; the lower worker has the
  /// lower pairs.
  template <class F>
  void evaluate(const F& found) {
    begin();
    threads_.chunks(static_cast<int>(pairs_.size()), kPairTime,
                    [&](int first, int end, int worker) {
                      const std::vector<PairInTouch>& results = results_of(worker);
                      for (auto p = static_cast<size_t>(first); p < static_cast<size_t>(end);) {
                        const size_t before = results.size();
                        p = evaluate_some(p, static_cast<size_t>(end), worker);
                        for (size_t i = before; i < results.size(); ++i) found(results[i], worker);
                      }
                    });
    collect();
  }

  /// The pairs in reach.
  [[nodiscard]] size_t candidates() const { return pairs_.size(); }
  /// The pairs that touch, ascending.
  [[nodiscard]] const std::vector<PairInTouch>& touching() const { return touching_; }
  /// The patches of a pair: the whole pair if it is not split.
  [[nodiscard]] std::span<const PairIntegral> patches(const PairInTouch& pair) const {
    if (pair.first_patch < 0) return {pair.integral, 1};
    return std::span(workers_[static_cast<size_t>(pair.worker)].patches)
        .subspan(static_cast<size_t>(pair.first_patch), static_cast<size_t>(pair.patches));
  }
  /// The runs of a pair; none if it is not split.
  [[nodiscard]] std::span<const BoundaryRun> runs(const PairInTouch& pair) const {
    return std::span(workers_[static_cast<size_t>(pair.worker)].runs)
        .subspan(static_cast<size_t>(pair.first_run), static_cast<size_t>(pair.runs));
  }
  /// Energy of all pairs for unit thickness, N. Not for every step.
  [[nodiscard]] double energy(const PairTable& table) const;

  /// The record of a pair; k is the normal stiffness times the thickness, N/m.
  [[nodiscard]] Contact contact(KernelKind kernel, const PairInTouch& pair, double k) const;
  /// If the pair is so deep that its potentials are about to fall again.
  [[nodiscard]] bool too_deep(const PairInTouch& pair) const;

 private:
  static constexpr double kFirstMargin = 1. / 64;
  static constexpr double kPairTime = 200;  // ns

  // Edges of a pair that are near the other body, and where the bodies were when they were found.
  struct Near {
    NearEdges edges;
    Vec2 between = Vec2::Zero();
    double angle_a = 0, angle_b = 0;
    double share = kFirstMargin;  // the margin asked for, of the smaller inradius
    int age = 0;                  // evaluations since then
  };
  struct Worker {
    PatchWorkspace workspace;
    NearEdgesWorkspace near_edges;
    std::array<size_t, ConvexPairs::kAtOnce> convex_pairs;  // numbers of those collected
    // Of the touching pairs that it has found. The first worker's results begin the list of all.
    std::vector<PairIntegral> integrals;
    std::vector<PairInTouch> results;
    // Of those that it has split.
    std::vector<BoundaryRun> runs;
    std::vector<PairIntegral> patches;
    // Of the pair at hand.
    std::vector<BoundaryRun> pair_runs;
    std::vector<PairIntegral> pair_patches;
  };
  void begin();
  size_t evaluate_some(size_t first, size_t end, int worker);
  void evaluate_convex(int worker);
  void note_margin(size_t pair, const Vec2& between);
  void add(const PairIntegral& integral, const PairInTouch& pair);
  void collect();
  [[nodiscard]] double bound_depth(SurfaceIndex a, SurfaceIndex b, const PairIntegral& pair) const;
  void evaluate_alone(size_t pair, const PlacedPotential& view_a, const PlacedPotential& view_b,
                      int worker);
  [[nodiscard]] std::vector<PairInTouch>& results_of(int worker) {
    return worker == 0 ? touching_ : workers_[static_cast<size_t>(worker)].results;
  }
  void find_near(size_t pair, const Vec2& between, NearEdgesWorkspace& workspace);

  const Surfaces& surfaces_;
  Threads threads_;
  Split split_;
  std::vector<BoxPair> pairs_;
  std::vector<Near> near_;  // of each pair
  std::vector<PairInTouch> touching_;
  mutable std::vector<double> energies_;  // of each of these, when they are asked for, N
  std::vector<Worker> workers_;
};

}  // namespace apothem
