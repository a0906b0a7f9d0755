// The factors of sparse tangents against dense linear algebra (Eigen).
#include "lib/solver/linear_solver.hpp"

#include <Eigen/Dense>
#include <catch2/catch.hpp>
#include <cmath>

#include "tests/support.hpp"

using namespace apothem;
using namespace apothem::test;

namespace linear {
namespace {

struct System {
  size_t rigid = 0;
  Tangent tangent;
  Eigen::MatrixXd dense;
  std::vector<std::uint8_t> moves;
  std::vector<double> diagonal;
};

// Bodies and nodes that are coupled at random, each with a few others; some coordinates are held.
// Entries of one place come in several parts.
System random_system(SeededRandom& random, int bodies, int nodes, bool symmetric, double shift) {
  System s;
  s.rigid = static_cast<size_t>(3 * bodies);
  const int size = 3 * bodies + 2 * nodes;
  s.dense = Eigen::MatrixXd::Zero(size, size);
  const auto add = [&](int i, int j, double value) {
    s.tangent.add(static_cast<size_t>(i), static_cast<size_t>(j), value);
    s.dense(i, j) += value;
  };
  const auto first = [&](int b) { return b < bodies ? 3 * b : 3 * bodies + 2 * (b - bodies); };
  const auto count = [&](int b) { return b < bodies ? 3 : 2; };
  for (int n = 0; n < 3 * (bodies + nodes); ++n) {
    const int a = random.integer(0, bodies + nodes - 1), b = random.integer(0, bodies + nodes - 1);
    for (int i = 0; i < count(a); ++i) {
      for (int j = 0; j < count(b); ++j) {
        const double value = random.uniform(-1, 1);
        add(first(a) + i, first(b) + j, value);
        add(first(b) + j, first(a) + i, symmetric ? value : random.uniform(-1, 1));
      }
    }
  }
  for (int c = 0; c < size; ++c) {
    s.moves.push_back(random.integer(0, 5) > 0);
    s.diagonal.push_back(shift * random.uniform(.5, 1));
  }
  return s;
}

// Nodes in a square, each coupled with those next to it, and a body that touches one side.
System grid_system(SeededRandom& random, int side, bool symmetric) {
  System s;
  s.rigid = 3;
  const int size = 3 + 2 * side * side;
  s.dense = Eigen::MatrixXd::Zero(size, size);
  s.moves.assign(static_cast<size_t>(size), 1);
  s.diagonal.assign(static_cast<size_t>(size), 12);
  const auto add = [&](int i, int j) {
    const double value = random.uniform(-1, 1), across = symmetric ? value : random.uniform(-1, 1);
    s.tangent.add(static_cast<size_t>(i), static_cast<size_t>(j), value);
    s.tangent.add(static_cast<size_t>(j), static_cast<size_t>(i), across);
    s.dense(i, j) += value;
    s.dense(j, i) += across;
  };
  for (int n = 0; n < side * side; ++n) {
    for (const int to :
         {n, n % side + 1 < side ? n + 1 : n, n + side < side * side ? n + side : n}) {
      for (int k = 0; k < 4; ++k) add(3 + 2 * n + k / 2, 3 + 2 * to + k % 2);
    }
    for (int k = 0; n < side && k < 6; ++k) add(k / 2, 3 + 2 * n + k % 2);
  }
  return s;
}

// The part of the matrix that belongs to the system.
Eigen::MatrixXd moving(const System& s, std::vector<int>& which) {
  for (size_t c = 0; c < s.moves.size(); ++c) {
    if (s.moves[c]) which.push_back(static_cast<int>(c));
  }
  Eigen::MatrixXd a = s.dense(which, which);
  for (size_t i = 0; i < which.size(); ++i) {
    a(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(i)) +=
        s.diagonal[static_cast<size_t>(which[i])];
  }
  return a;
}

}  // namespace
}  // namespace linear

TEST_CASE("sparse systems of bodies and nodes are solved as dense ones", "[solver]") {
  SeededRandom random(51);
  for (int n = 0; n < scaled(400); ++n) {
    const int bodies = random.integer(0, 20), nodes = random.integer(bodies == 0 ? 1 : 0, 20);
    const bool symmetric = random.integer(0, 1) == 0;
    const linear::System s =
        linear::random_system(random, bodies, nodes, symmetric, random.integer(0, 1) == 0 ? 30 : 4);
    std::vector<int> which;
    const Eigen::MatrixXd a = linear::moving(s, which);
    if (which.empty()) continue;
    Eigen::VectorXd b(s.moves.size());
    for (double& x : b) x = random.uniform(-1, 1);
    LinearSolver solver;
    std::vector<double> x(s.moves.size(), 7);
    // The second time with the places that are known.
    for (int again = 0; again < 2; ++again) {
      REQUIRE(solver.factorise(s.tangent, s.rigid, s.moves, s.diagonal));
      solver.solve({b.data(), s.moves.size()}, x);
      const Eigen::VectorXd right = b(which), left = a.fullPivLu().solve(right);
      const double condition = a.norm() * a.inverse().norm();
      for (size_t i = 0; i < which.size(); ++i) {
        CHECK(std::abs(x[static_cast<size_t>(which[i])] - left[static_cast<Eigen::Index>(i)]) <
              1e-11 * condition * left.norm());
      }
      for (size_t c = 0; c < s.moves.size(); ++c) CHECK((s.moves[c] || x[c] == 0));
    }
    if (!symmetric) {
      CHECK((solver.negative_pivots(1e-12) == -1 || a.isApprox(a.transpose())));
      continue;
    }
    const auto values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(a).eigenvalues();
    CHECK(solver.negative_pivots(1e-12) == (values.array() < 0).count());
  }
}

TEST_CASE("systems of meshes, whose fronts are large, are solved as dense ones", "[solver]") {
  SeededRandom random(52);
  for (int n = 0; n < scaled(24); ++n) {
    const bool symmetric = n % 2 == 0;
    const linear::System s =
        linear::grid_system(random, random.integer(2, kSanitized ? 8 : 24), symmetric);
    std::vector<int> which;
    const Eigen::MatrixXd a = linear::moving(s, which);
    Eigen::VectorXd b(s.moves.size()), x(s.moves.size());
    for (double& entry : b) entry = random.uniform(-1, 1);
    LinearSolver solver;
    REQUIRE(solver.factorise(s.tangent, s.rigid, s.moves, s.diagonal));
    solver.solve({b.data(), s.moves.size()}, {x.data(), s.moves.size()});
    CHECK((a * x - b).norm() < 1e-12 * b.norm());
  }
}

TEST_CASE("a singular system, and one that is not finite, has no factors", "[solver]") {
  const std::vector<std::uint8_t> moves(6, 1);
  const std::vector<double> none(6, 0);
  Tangent tangent;
  for (size_t c = 0; c < 5; ++c) tangent.add(c, c, 2);
  LinearSolver solver;
  CHECK(!solver.factorise(tangent, 6, moves, none));
  tangent.add(5, 5, HUGE_VAL);
  CHECK(!solver.factorise(tangent, 6, moves, none));
  tangent.clear();
  for (size_t c = 0; c < 6; ++c) tangent.add(c, c, 2);
  CHECK(solver.factorise(tangent, 6, moves, none));
  CHECK(solver.negative_pivots(0) == 0);
}
