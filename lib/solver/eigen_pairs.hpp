// Eigenvalues and eigenvectors of symmetric matrices, by Eigen and Spectra. All others ask here, so
// that the templates of both, which take long to compile, are compiled once.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <span>

namespace apothem {

/// Column i of `vectors` belongs to values[i].
struct EigenPairs {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
};

/// All pairs of a symmetric matrix, ascending; the vectors are orthonormal.
EigenPairs dense_pairs(const Eigen::MatrixXd& matrix);
/// All pairs of A x = l B x, ascending, with B positive definite and x^T B x = 1.
EigenPairs dense_pairs(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

/// All pairs of a symmetric matrix with this diagonal and these entries beside it, ascending.
EigenPairs tridiagonal_pairs(std::span<const double> diagonal, std::span<const double> beside);

/// The product of a matrix with a vector: from `in` to `out`.
using Product = std::function<void(const double* in, double* out)>;

/// The pairs with the `count` largest eigenvalues, or fewer where not all of them converge, of a
/// matrix that is symmetric in the inner product x^T B y with a positive definite B: by the Lanczos
/// method with implicit restarts. `count` is less than `size`, the number of rows.
EigenPairs largest_pairs(Eigen::Index size, Eigen::Index count, const Product& matrix,
                         const Product& inner);

}  // namespace apothem
