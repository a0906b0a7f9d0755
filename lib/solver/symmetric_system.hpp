// Private header: a symmetric sparse matrix K in the coordinates that move, with the factors of
// K + D for diagonals D. They are Eigen's L D L^T of single entries: a body that nothing holds has
// pivots near zero, which the inverses of blocks (frontal_factors.hpp) do not bear.
#pragma once

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

#include <memory>

#include "lib/solver/modes.hpp"

namespace apothem {

/// Vectors have one entry for each coordinate that moves, in their order.
class SymmetricSystem {
 public:
  using Vector = Eigen::VectorXd;

  /// K is the symmetric part of `tangent`.
  SymmetricSystem(const Tangent& tangent, const ModalSystem& system);

  [[nodiscard]] Eigen::Index size() const { return mass_.size(); }
  [[nodiscard]] const Eigen::SparseMatrix<double>& matrix() const { return matrix_; }
  [[nodiscard]] const Vector& mass() const { return mass_; }
  /// What rounding may have made of each coordinate's stiffness: phi^T K phi is known up to
  /// phi^T N phi with this diagonal N.
  [[nodiscard]] const Vector& rounding() const { return rounding_; }
  /// Eigenvalues of K phi = w^2 M phi that are smaller in size may be rounding, 1/s^2.
  [[nodiscard]] double least() const;
  /// Norm of the part of the tangent that is not symmetric over that of the tangent.
  [[nodiscard]] double skew() const { return skew_; }
  /// A bound of the sizes of all eigenvalues of K phi = w^2 M phi, 1/s^2 (Gershgorin's circles).
  [[nodiscard]] double bound() const;

  /// Factorises K + D. Returns false if it is singular, or so nearly that solutions are useless.
  [[nodiscard]] bool factorise(const Vector& diagonal);
  /// The number of negative eigenvalues of the last matrix that was factorised.
  [[nodiscard]] int negative() const {
    return static_cast<int>((factors_->vectorD().array() < 0).count());
  }
  [[nodiscard]] Vector solve(const Vector& b) const { return factors_->solve(b); }

  /// Factorises K - shift M, where need be with a shift that is a little larger in size, which it
  /// returns. Throws NoModes.
  double shift(double by);
  /// The number of eigenvalues of K phi = w^2 M phi below `bound`.
  int count_below(double bound) { return shift(bound), negative(); }

  /// In all coordinates, with phi^T M phi = 1 and the largest entry positive.
  [[nodiscard]] std::vector<double> shape(const Vector& phi) const;

 private:
  std::vector<std::uint8_t> moves_;
  std::vector<size_t> coordinate_;  // of each entry of a vector
  Eigen::SparseMatrix<double> matrix_, shifted_;
  Vector mass_, rounding_;
  double skew_ = 0;
  // Eigen's factors cannot be copied or moved.
  using Factors = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>;
  std::unique_ptr<Factors> factors_ = std::make_unique<Factors>();
};

}  // namespace apothem
