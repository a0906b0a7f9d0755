#include "lib/fem/spectrum.hpp"

#include <cmath>
#include <vector>

#include "geometry/polygon/random_numbers.hpp"
#include "lib/solver/eigen_pairs.hpp"

namespace apothem {
namespace {

constexpr double kStrain =
    1e-6;  // of the probing displacements: in the linear range, far above round-off
constexpr double kAccuracy = 5e-3;      // relative, of the eigenvalue
constexpr int kMostLanczosSteps = 200;  // of Lanczos' method

}  // namespace

double largest_eigenvalue(FiniteElements& elements, std::span<const double> u,
                          std::span<const double> inverse_mass) {
  const auto n = static_cast<Eigen::Index>(u.size());
  using Vector = Eigen::VectorXd;
  Vector root(n);
  for (Eigen::Index i = 0; i < n; ++i) root[i] = std::sqrt(inverse_mass[i]);
  const Vector still = Vector::Zero(n);
  const auto span = [&](const Vector& v) { return std::span(v.data(), u.size()); };
  const double length = elements.shortest_edge();

  // The product M^-1/2 K M^-1/2 q, by a central difference of the force.
  Vector plus(n), minus(n), moved(n);
  const auto apply = [&](const Vector& q) -> Vector {
    const Vector shape = root.cwiseProduct(q);
    const double scale = kStrain * length / std::max(shape.cwiseAbs().maxCoeff(), 1e-300);
    for (const double sign : {1., -1.}) {
      for (Eigen::Index i = 0; i < n; ++i) moved[i] = u[i] + sign * scale * shape[i];
      Vector& f = sign > 0 ? plus : minus;
      elements.force(span(moved), span(still), std::span<double>(f.data(), u.size()));
    }
    return (minus - plus).cwiseProduct(root) / (2 * scale);
  };

  RandomNumbers random(1);
  Vector q(n);
  for (Eigen::Index i = 0; i < n; ++i) q[i] = root[i] > 0 ? random.uniform(-.5, .5) : 0;
  if (q.norm() == 0) return 0;
  q.normalize();
  Vector before = Vector::Zero(n);
  std::vector<double> diagonal, beside;
  double answer = 0;
  for (int step = 1; step <= kMostLanczosSteps; ++step) {
    Vector next = apply(q);
    diagonal.push_back(next.dot(q));
    next -= diagonal.back() * q;
    if (!beside.empty()) next -= beside.back() * before;
    const double rest = next.norm();
    if (step % 5 == 0 || rest == 0) {
      const EigenPairs small = tridiagonal_pairs(diagonal, beside);
      const double largest = small.values[step - 1];
      const double residual = rest * std::abs(small.vectors(step - 1, step - 1));
      const double found = largest + residual;
      // Two successive results must agree: one small residual may belong to a lower eigenvalue.
      if (residual < kAccuracy * largest && std::abs(found - answer) < kAccuracy * largest) {
        return found;
      }
      answer = found;
      if (rest == 0) return answer;
    }
    beside.push_back(rest);
    before = q;
    q = next / rest;
  }
  return answer;
}

}  // namespace apothem
