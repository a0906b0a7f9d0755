// Linear systems of sparse tangents: A = K + D with a diagonal D >= 0, in the coordinates that can
// move. They are factorised in blocks (frontal_factors.hpp), symmetric ones as L D L^T, whose
// pivots tell stability (the number of negative ones is that of negative eigenvalues, Sylvester's
// law of inertia).
#pragma once

#include <memory>
#include <span>

#include "lib/solver/tangent.hpp"

namespace apothem {

class LinearSolver {
 public:
  LinearSolver();
  ~LinearSolver();
  LinearSolver(const LinearSolver&) = delete;
  LinearSolver& operator=(const LinearSolver&) = delete;

  /// Factorises A. `moves` says for each coordinate whether it belongs to the system, and
  /// `diagonal` is D. The order of elimination is kept while the places of the entries are the
  /// same. Returns false if A is singular or not finite.
  /// `rigid`: the number of the first coordinates, which are x, y and angle of rigid bodies; the
  /// others are x and y of nodes.
  [[nodiscard]] bool factorise(const Tangent& tangent, size_t rigid,
                               std::span<const std::uint8_t> moves,
                               std::span<const double> diagonal);
  /// Solves A x = b with the last factors; x is 0 in coordinates that do not belong to the system.
  void solve(std::span<const double> b, std::span<double> x) const;
  /// The number of pivots below minus `noise` times the size of the largest one; -1 if A was not
  /// symmetric, so that it is not known.
  [[nodiscard]] int negative_pivots(double noise) const;

 private:
  struct Factors;
  std::unique_ptr<Factors> factors_;
};

}  // namespace apothem
