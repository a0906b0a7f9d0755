#include "lib/solver/eigen_pairs.hpp"

#include <Spectra/SymEigsBase.h>

#include <Eigen/Eigenvalues>
#include <algorithm>

namespace apothem {
namespace {

constexpr double kTolerance = 1e-11;  // of Ritz values, relative
constexpr int kRestarts = 1000;
constexpr Eigen::Index kMoreVectors = 20;  // of the Lanczos method, than pairs

class Operator {
 public:
  using Scalar = double;
  Operator(Eigen::Index size, const Product& product) : size_(size), product_(product) {}
  [[nodiscard]] Eigen::Index rows() const { return size_; }
  void perform_op(const double* in, double* out) const { product_(in, out); }

 private:
  Eigen::Index size_;
  const Product& product_;
};

}  // namespace

EigenPairs dense_pairs(const Eigen::MatrixXd& matrix) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> all(matrix);
  return {all.eigenvalues(), all.eigenvectors()};
}

EigenPairs dense_pairs(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> all(a, b);
  return {all.eigenvalues(), all.eigenvectors()};
}

EigenPairs tridiagonal_pairs(std::span<const double> diagonal, std::span<const double> beside) {
  const auto vector = [](std::span<const double> v) {
    return Eigen::Map<const Eigen::VectorXd>(v.data(), static_cast<Eigen::Index>(v.size()));
  };
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> all;
  all.computeFromTridiagonal(vector(diagonal), vector(beside));
  return {all.eigenvalues(), all.eigenvectors()};
}

EigenPairs largest_pairs(Eigen::Index size, Eigen::Index count, const Product& matrix,
                         const Product& inner) {
  Operator product(size, matrix);
  const Operator weight(size, inner);
  const Eigen::Index breadth = std::min(size, std::max(2 * count + 1, count + kMoreVectors));
  Spectra::SymEigsBase<Operator, Operator> lanczos(product, weight, count, breadth);
  lanczos.init();
  lanczos.compute(Spectra::SortRule::LargestAlge, kRestarts, kTolerance);
  return {lanczos.eigenvalues(), lanczos.eigenvectors()};
}

}  // namespace apothem
