// Geometry without mechanics: the contact of two squares that overlap by 0.1 m along a whole side.
#include <apothem/geometry/exact/overlap.hpp>
#include <apothem/geometry/integrals/edge_integral.hpp>
#include <cmath>
#include <cstdio>

int main() {
  using namespace apothem;
  const Polygon a({{0, 0}, {1, 0}, {1, 1}, {0, 1}});
  const Polygon b({{0.9, 0}, {1.9, 0}, {1.9, 1}, {0.9, 1}});
  const PairResult pair = edge_method(a, make_potential(a), b, make_potential(b));
  std::printf("force on a for k_n = 1 Pa: %.15g N/m\n", pair.integral.force.x());
  // On each of the two edges phi = min(0.1, y, 1 - y) / 0.5, with the integral (0.1 - 0.01) / 0.5.
  return std::abs(pair.integral.force.x() + 0.36) < 1e-14 ? 0 : 1;
}
