// The pair kernel on lists of polygons: normal contact by integrals along edges
// (geometry/integrals/edge_integral.hpp).
#pragma once

#include <span>
#include <vector>

#include "apothem/contact/kernel.hpp"
#include "apothem/contact/pair_table.hpp"
#include "apothem/execution/parallel.hpp"
#include "apothem/geometry/integrals/edge_integral.hpp"

namespace apothem {

/// Beyond this potential an edge is about to cross the centre of the other polygon, where the
/// potential falls again.
inline constexpr double kDeepestPhi = 0.95;

class PairIntegrals {
 public:
  PairIntegrals(const Surfaces& surfaces, int threads)
      : surfaces_(surfaces), threads_(threads), workspaces_(threads_.count()) {}

  void take(std::span<const BoxPair> pairs) { pairs_.assign(pairs.begin(), pairs.end()); }
  /// Integrals of all pairs; the result of a pair depends on that pair alone.
  void evaluate();

  [[nodiscard]] const std::vector<BoxPair>& pairs() const { return pairs_; }
  /// One for each pair, for unit stiffness; force on the first one, moments about the reference
  /// points.
  [[nodiscard]] const PairIntegral& operator[](size_t pair) const { return integrals_[pair]; }
  /// Energy of all pairs for unit thickness, N. Not for every step.
  [[nodiscard]] double energy(const PairTable& table) const;

  /// The record of a pair; k is the normal stiffness times the thickness, N/m.
  [[nodiscard]] Contact contact(KernelKind kernel, size_t pair, double k) const;
  /// If the pair is so deep that its potentials are about to fall again.
  [[nodiscard]] bool too_deep(size_t pair) const;

 private:
  const Surfaces& surfaces_;
  Threads threads_;
  std::vector<BoxPair> pairs_;
  std::vector<EdgeWorkspace> workspaces_;
  std::vector<PairIntegral> integrals_;
};

}  // namespace apothem
