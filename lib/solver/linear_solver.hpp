// Linear systems of sparse tangents: A = K + D with a diagonal D >= 0, in the coordinates that can
// move. Symmetric ones are factorised as L D L^T, whose pivots tell stability (the number of
// negative ones is that of negative eigenvalues, Sylvester's law of inertia); others as L U.
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
  [[nodiscard]] bool factorise(const Tangent& tangent, std::span<const std::uint8_t> moves,
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
