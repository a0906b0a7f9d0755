// The pair kernel on lists of polygons: normal contact by integrals along edges
// (geometry/integrals/edge_integral.hpp).
#pragma once

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

class PairIntegrals {
 public:
  /// Which touching pairs are split into contact patches.
  enum class Split { none, not_convex, all };

  PairIntegrals(const Surfaces& surfaces, int threads, Split split = Split::none)
      : surfaces_(surfaces), threads_(threads), split_(split), workers_(threads_.count()) {}

  void take(std::span<const BoxPair> pairs);
  /// Integrals of all pairs; the result of a pair depends on that pair alone. Calls done(pair,
  /// worker) for each, in ascending order within each thread; the lower worker has the lower pairs.
  template <class F>
  void evaluate(const F& done) {
    begin();
    threads_.chunks(static_cast<int>(pairs_.size()), kPairTime,
                    [&](int first, int end, int worker) {
                      for (int p = first; p < end; ++p) {
                        evaluate_pair(static_cast<size_t>(p), worker);
                        done(static_cast<size_t>(p), worker);
                      }
                    });
  }
  void evaluate() {
    evaluate([](size_t, int) {});
  }

  [[nodiscard]] const std::vector<BoxPair>& pairs() const { return pairs_; }
  /// One for each pair, for unit stiffness; force on the first one, moments about the reference
  /// points. Zero for a pair that does not touch.
  [[nodiscard]] const PairIntegral& operator[](size_t pair) const {
    static const PairIntegral kApart;
    const Slot& slot = slots_[pair];
    return slot.worker < 0 ? kApart : worker_of(slot).integrals[static_cast<size_t>(slot.index)];
  }
  /// The patches of a touching pair: the whole pair if it is not split.
  [[nodiscard]] std::span<const PairIntegral> patches(size_t pair) const;
  /// The runs of a touching pair; none if it is not split.
  [[nodiscard]] std::span<const BoundaryRun> runs(size_t pair) const;
  /// Energy of all pairs for unit thickness, N. Not for every step.
  [[nodiscard]] double energy(const PairTable& table) const;

  /// The record of a pair; k is the normal stiffness times the thickness, N/m.
  [[nodiscard]] Contact contact(KernelKind kernel, size_t pair, double k) const;
  /// If the pair is so deep that its potentials are about to fall again.
  [[nodiscard]] bool too_deep(size_t pair) const;

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
  // The patches and runs of a touching pair, of those that its worker has found.
  struct Parts {
    int first_patch = -1;  // -1: not split
    int patches = 0, first_run = 0, runs = 0;
  };
  // Where the integral of a pair is. Worker -1: it does not touch. Most pairs do not, and large
  // scenes need the memory.
  struct Slot {
    int worker = -1, index = 0;
  };
  struct Worker {
    PatchWorkspace workspace;
    NearEdgesWorkspace near_edges;
    std::vector<PairIntegral> integrals;  // of the touching pairs that it has found
    // Of those that it has split; `parts` has an entry for each touching pair if any may be split.
    std::vector<Parts> parts;
    std::vector<BoundaryRun> runs;
    std::vector<PairIntegral> patches;
    // Of the pair at hand.
    std::vector<BoundaryRun> pair_runs;
    std::vector<PairIntegral> pair_patches;
  };
  void begin();
  void evaluate_pair(size_t pair, int worker);
  [[nodiscard]] PairIntegral integrate(size_t pair, Worker& worker, Parts& parts);
  [[nodiscard]] const Worker& worker_of(const Slot& slot) const {
    return workers_[static_cast<size_t>(slot.worker)];
  }
  [[nodiscard]] const Parts* parts_of(const Slot& slot) const;
  void find_near(size_t pair, const Vec2& between, NearEdgesWorkspace& workspace);

  const Surfaces& surfaces_;
  Threads threads_;
  Split split_;
  std::vector<BoxPair> pairs_;
  std::vector<Near> near_;   // of each pair
  std::vector<Slot> slots_;  // of each pair
  std::vector<Worker> workers_;
};

}  // namespace apothem
