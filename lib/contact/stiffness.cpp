#include "apothem/contact/stiffness.hpp"

#include <Eigen/Eigenvalues>

namespace apothem {

Eigen::Matrix3d BodyStiffness::over(const std::array<double, 3>& inverse_mass) const {
  const Eigen::Vector3d root(std::sqrt(inverse_mass[0]), std::sqrt(inverse_mass[1]),
                             std::sqrt(inverse_mass[2]));
  Eigen::Matrix3d k;
  k << xx_, xy_, xt_, xy_, yy_, yt_, xt_, yt_, tt_;
  return root.asDiagonal() * k * root.asDiagonal();
}

double BodyStiffness::rate(const std::array<double, 3>& inverse_mass) const {
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  return solver.computeDirect(over(inverse_mass), Eigen::EigenvaluesOnly).eigenvalues()[2];
}

// Mean and variance of the eigenvalues: the largest one is at most mean + sqrt(2 variance).
double BodyStiffness::rate_bound(const std::array<double, 3>& inverse_mass) const {
  const auto& [wx, wy, wt] = inverse_mass;
  const double x = xx_ * wx, y = yy_ * wy, t = tt_ * wt;
  const double mean = (x + y + t) / 3;
  const double squares =
      x * x + y * y + t * t + 2 * (xy_ * xy_ * wx * wy + xt_ * xt_ * wx * wt + yt_ * yt_ * wy * wt);
  return mean + std::sqrt(std::max(2 * (squares / 3 - mean * mean), 0.0));
}

}  // namespace apothem
