// Modes of sparse systems against dense linear algebra (Eigen) and closed forms.
#include "lib/solver/modes.hpp"

#include <Eigen/Dense>
#include <catch2/catch.hpp>
#include <cmath>

#include "tests/support.hpp"

using namespace apothem;
using namespace apothem::test;

namespace modes {
namespace {

struct Springs {
  ModalSystem system;
  Tangent tangent;
  Eigen::MatrixXd dense;

  explicit Springs(size_t nodes) : dense(Eigen::MatrixXd::Zero(2 * nodes, 2 * nodes)) {
    system.moves.assign(2 * nodes, 1);
    system.mass.assign(2 * nodes, 1);
  }
  // Adds k (x_i - x_j)^2 / 2; without j the spring ends at the ground.
  void add(int i, int j, double k) {
    const auto entry = [&](int a, int b, double value) {
      tangent.add(static_cast<size_t>(a), static_cast<size_t>(b), value);
      dense(a, b) += value;
    };
    entry(i, i, k);
    if (j < 0) return;
    entry(j, j, k), entry(i, j, -k), entry(j, i, -k);
  }
  // Eigenvalues of what moves, by dense algebra, ascending.
  [[nodiscard]] Eigen::VectorXd eigenvalues() const {
    std::vector<int> which;
    for (size_t c = 0; c < system.moves.size(); ++c) {
      if (system.moves[c]) which.push_back(static_cast<int>(c));
    }
    Eigen::MatrixXd k = dense(which, which), m = Eigen::MatrixXd::Zero(k.rows(), k.cols());
    for (int i = 0; i < k.rows(); ++i) m(i, i) = system.mass[static_cast<size_t>(which[i])];
    return Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd>(k, m).eigenvalues();
  }
};

// Coordinates along x in a chain of n points, and along y in another one.
Springs chains(int n, double k_x, double k_y, bool held) {
  Springs s(static_cast<size_t>(n));
  for (int i = 0; i + 1 < n; ++i) {
    s.add(2 * i, 2 * i + 2, k_x);
    s.add(2 * i + 1, 2 * i + 3, k_y);
  }
  if (held) s.add(0, -1, k_x), s.add(1, -1, k_y);
  return s;
}

}  // namespace
}  // namespace modes

TEST_CASE("modes of a chain of masses are those of the closed form", "[modes]") {
  // Equal masses, half of it at both ends: w = 2 sqrt(k/m) sin(pi j / (2 (n - 1))), free at both
  // ends. The chain along y is the same, so that every eigenvalue is double.
  constexpr int kNodes = 300;
  modes::Springs s = modes::chains(kNodes, 4, 4, false);
  for (size_t c : {size_t{0}, size_t{1}, size_t{2 * kNodes - 2}, size_t{2 * kNodes - 1}}) {
    s.system.mass[c] = .5;
  }
  const VibrationModes found = vibration_modes(s.tangent, s.system, 12);
  CHECK(found.unstable == 0);
  CHECK(found.rigid == 2);
  REQUIRE(found.modes.size() == 14);
  CHECK(found.modes[0].eigenvalue == 0);
  // The zero modes are the translations: x has no part of y.
  CHECK(std::abs(found.modes[0].shape[1]) < 1e-10 * found.modes[0].shape[0]);
  for (int i = 2; i < 14; ++i) {
    const double w = 4 * std::sin(M_PI * (i / 2) / (2. * (kNodes - 1)));
    CHECK(std::sqrt(found.modes[static_cast<size_t>(i)].eigenvalue) == Approx(w).epsilon(1e-9));
  }
}

TEST_CASE("eigenvalues of any multiplicity are found", "[modes]") {
  // 200 equal oscillators, and one that is softer.
  modes::Springs s(200);
  for (int c = 0; c < 400; ++c) s.add(c, -1, c == 77 ? 1 : 9);
  const VibrationModes found = vibration_modes(s.tangent, s.system, 8);
  REQUIRE(found.modes.size() == 8);
  CHECK(found.modes[0].eigenvalue == Approx(1).epsilon(1e-10));
  for (size_t i = 1; i < 8; ++i) {
    CHECK(found.modes[i].eigenvalue == Approx(9).epsilon(1e-10));
    for (size_t j = 0; j < i; ++j) {
      double product = 0;
      for (size_t c = 0; c < 400; ++c) product += found.modes[i].shape[c] * found.modes[j].shape[c];
      CHECK(std::abs(product) < 1e-8);
    }
  }
}

TEST_CASE("modes of random systems are those of dense algebra", "[modes]") {
  SeededRandom random(71);
  for (int n = 0; n < scaled(40); ++n) {
    const int nodes = random.integer(70, 130);
    modes::Springs s(static_cast<size_t>(nodes));
    for (int i = 0; i < 2 * nodes; ++i) {
      s.system.mass[static_cast<size_t>(i)] = std::pow(10, random.uniform(-2, 2));
      s.system.moves[static_cast<size_t>(i)] = random.integer(0, 9) > 0;
      for (int more = 0; more < 3; ++more) {
        s.add(i, (i + random.integer(1, 2 * nodes - 1)) % (2 * nodes),
              std::pow(10, random.uniform(0, 4)));
      }
      if (random.integer(0, 3) == 0) s.add(i, -1, random.uniform(0, 10));
    }
    // Some springs push.
    const int unstable = random.integer(0, 3);
    for (int i = 0; i < unstable; ++i) s.add(random.integer(0, 2 * nodes - 1), -1, -1e6);
    const Eigen::VectorXd all = s.eigenvalues();
    const VibrationModes found = vibration_modes(s.tangent, s.system, 9);
    CAPTURE(n, nodes, unstable);
    CHECK(found.coordinates == all.size());
    CHECK(found.unstable == (all.array() < 0).count());
    CHECK(found.rigid == 0);
    CHECK(found.skew == 0);
    REQUIRE(found.modes.size() == 9);
    for (int i = 0; i < 9; ++i) {
      const Mode& mode = found.modes[static_cast<size_t>(i)];
      CHECK(mode.eigenvalue == Approx(all[i]).epsilon(1e-7).margin(1e-10 * all[all.size() - 1]));
      // K phi = w^2 M phi
      const Eigen::Map<const Eigen::VectorXd> phi(mode.shape.data(), 2 * nodes);
      const Eigen::VectorXd force = s.dense * phi;
      double off = 0, norm = 0;
      for (int c = 0; c < 2 * nodes; ++c) {
        const auto at = static_cast<size_t>(c);
        if (!s.system.moves[at]) {
          CHECK(phi[c] == 0);
          continue;
        }
        const double inertia = mode.eigenvalue * s.system.mass[at] * phi[c];
        off += std::pow(force[c] - inertia, 2) / s.system.mass[at];
        norm += s.system.mass[at] * phi[c] * phi[c];
      }
      CHECK(norm == Approx(1).epsilon(1e-10));
      CHECK(std::sqrt(off) < 1e-6 * all[all.size() - 1]);
    }
  }
}

TEST_CASE("soft parts beside stiff ones are not taken for motions without resistance", "[modes]") {
  // Stiffnesses of 1e14 and 1, and two coordinates that nothing holds.
  modes::Springs s(100);
  for (int c = 0; c < 196; ++c) s.add(c, c + 1, 1e14);
  s.add(0, -1, 1e14);
  s.add(198, -1, 1);
  const VibrationModes found = vibration_modes(s.tangent, s.system, 2);
  CHECK(found.rigid == 2);  // 197 and 199
  REQUIRE(found.modes.size() == 4);
  CHECK(found.modes[2].eigenvalue == Approx(1).epsilon(1e-12));
}

TEST_CASE("buckling of a chain of rigid links", "[modes]") {
  // Links of length l in compression P with springs k across at each joint: k + f P/l (-1, 2, -1)
  // reversed; K_s = -P/l times the second difference, so that f = k l / (P 4 sin^2(...)).
  for (const int n : {20, 200}) {
    modes::Springs unloaded(static_cast<size_t>(n)), loaded(static_cast<size_t>(n));
    constexpr double kSpring = 3, kForce = .25;
    for (modes::Springs* s : {&unloaded, &loaded}) {
      for (int c = 0; c < 2 * n; ++c) s->add(c, -1, kSpring);
    }
    loaded.add(0, -1, -kForce);
    for (int c = 0; c + 1 < 2 * n; ++c) loaded.add(c, c + 1, -kForce);
    loaded.add(2 * n - 1, -1, -kForce);
    const std::vector<Mode> found =
        buckling_modes(unloaded.tangent, loaded.tangent, unloaded.system, 3);
    REQUIRE(found.size() == 3);
    for (int j = 0; j < 3; ++j) {
      const double s = std::sin(M_PI * (2 * n - j) / (2. * (2 * n + 1)));
      CHECK(found[static_cast<size_t>(j)].eigenvalue ==
            Approx(kSpring / (4 * kForce * s * s)).epsilon(1e-9));
    }
    // What only grows stiffer does not buckle.
    CHECK(buckling_modes(loaded.tangent, unloaded.tangent, loaded.system, 3).empty());
  }
}

TEST_CASE("what can move freely does not buckle", "[modes]") {
  const modes::Springs s = modes::chains(30, 1, 1, false);
  CHECK_THROWS_AS(buckling_modes(s.tangent, s.tangent, s.system, 1), NoModes);
}
