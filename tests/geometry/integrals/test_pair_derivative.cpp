// The derivatives of a pair's integrals, against differences of the integrals themselves.
#include "geometry/integrals/pair_derivative.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "geometry/integrals/placed_shapes.hpp"
#include "tests/geometry/patches.hpp"
#include "tests/geometry/random_holed.hpp"
#include "tests/support.hpp"

using namespace apothem;
using samples::Random;

namespace {

constexpr double kHalfTurn = 3.14159265358979323846;

// Two polygons with their potentials, at poses of their centroids.
class Pair {
 public:
  Pair(const Polygon& a, const Polygon& b, const PotentialChoice& choice)
      : shape_a_(make_potential(at_centroid(a), choice)),
        shape_b_(make_potential(at_centroid(b), choice)) {
    shapes_.add(shape_a_);
    shapes_.add(shape_b_);
  }
  // x, y, angle of a, and the same of b.
  void place(const std::array<double, 6>& pose) {
    pose_ = pose;
    shapes_.place(0, pose[0], pose[1], sine_cosine(pose[2]));
    shapes_.place(1, pose[3], pose[4], sine_cosine(pose[5]));
  }
  [[nodiscard]] Vec2 offset() const { return {pose_[0] - pose_[3], pose_[1] - pose_[4]}; }
  [[nodiscard]] PairIntegral integral() {
    return contact_patches(shapes_.view(0), shapes_.view(1), offset(), workspace_, segments_,
                           patches_);
  }
  [[nodiscard]] std::span<const MovingIntegral> derivative(bool by_patches) {
    static_cast<void>(integral());
    places_.assign(segments_.begin(), segments_.end());
    return derivative_.find(
        shapes_.view(0), shapes_.view(1), offset(),
        by_patches ? std::span<const SegmentPlace>(places_) : std::span<const SegmentPlace>());
  }
  [[nodiscard]] const std::vector<PairIntegral>& patches() const { return patches_; }

 private:
  static Polygon at_centroid(const Polygon& polygon) {
    const Vec2 centre = area_moments(polygon).centroid;
    return samples::posed(polygon, -centre, 0);
  }
  Potential shape_a_, shape_b_;
  PlacedShapes shapes_;
  std::array<double, 6> pose_{};
  PatchWorkspace workspace_;
  std::vector<BoundarySegment> segments_;
  std::vector<PairIntegral> patches_;
  std::vector<SegmentPlace> places_;
  PairDerivative derivative_;
};

std::array<double, 7> numbers(const PairIntegral& p) {
  return {p.force.x(),    p.force.y(),    p.moment_a, p.moment_b,
          p.own_length_a, p.own_length_b, p.breadth};
}
std::array<Moving, 7> numbers(const MovingIntegral& p) {
  return {p.force_x, p.force_y, p.moment_a, p.moment_b, p.own_length_a, p.own_length_b, p.breadth};
}

Polygon random_shape(Random& random) {
  switch (random.integer(0, 3)) {
    case 0:
      return samples::random_convex(random, random.integer(3, 4));
    case 1:
      return samples::random_convex(random, random.integer(5, 20));
    case 2:
      return samples::random_star_shaped(random, random.integer(5, 12), .3);
    default:
      return samples::random_holed(random, random.integer(1, 3));
  }
}

}  // namespace

TEST_CASE("derivatives of the integrals of a pair are those of their differences",
          "[pair_derivative]") {
  test::SeededRandom random(41);
  int compared = 0, off = 0;
  double worst = 0;
  const int cases = test::scaled(2000);
  for (int n = 0; n < cases; ++n) {
    const PotentialChoice choice{.field = random.integer(0, 1) == 0
                                              ? PotentialChoice::Field::roof
                                              : PotentialChoice::Field::distance};
    Pair pair(random_shape(random), random_shape(random), choice);
    const std::array<double, 6> pose{
        random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(0, 2 * kHalfTurn),
        random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(0, 2 * kHalfTurn)};
    pair.place(pose);
    const PairIntegral here = pair.integral();
    const std::span<const MovingIntegral> found = pair.derivative(false);
    if (!here.touching()) {
      for (const MovingIntegral& none : found) CHECK(std::abs(none.weight.v) < 1e-12);
      continue;
    }
    REQUIRE(found.size() == 1);
    const std::array<Moving, 7> moving = numbers(found[0]);
    const std::array<double, 7> values = numbers(here);
    for (size_t i = 0; i < 4; ++i) CHECK(std::abs(moving[i].v - values[i]) < 1e-12 * here.weight);
    // Of the three derivatives by a shift, the turn of a and the turn of b.
    for (const auto& [coordinate, motion] : {std::pair(0, 0), {1, 1}, {2, 2}, {5, 3}}) {
      constexpr double kStep = 1e-6;
      std::array<double, 6> moved = pose;
      moved[static_cast<size_t>(coordinate)] += kStep;
      pair.place(moved);
      const std::array<double, 7> plus = numbers(pair.integral());
      moved[static_cast<size_t>(coordinate)] -= 2 * kStep;
      pair.place(moved);
      const std::array<double, 7> minus = numbers(pair.integral());
      pair.place(pose);
      for (size_t i = 0; i < 7; ++i) {
        const double difference = (plus[i] - minus[i]) / (2 * kStep);
        const double error = std::abs(moving[i].d.v[motion] - difference);
        ++compared;
        // A difference in which a vertex crosses an edge is none of the derivative.
        off += error > 1e-6 * (1 + std::abs(difference));
        worst = std::max(worst, error);
      }
    }
  }
  CAPTURE(compared, off, worst);
  CHECK(compared > test::least(4 * cases));
  CHECK(off < compared / 500);
}

TEST_CASE("the sums over patches have the derivatives of the whole, which are symmetric",
          "[pair_derivative]") {
  test::SeededRandom random(42);
  for (int n = 0; n < test::scaled(1000); ++n) {
    Pair pair(samples::random_star_shaped(random, 9, .3),
              samples::random_star_shaped(random, 12, .3), {});
    pair.place(
        {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(0, 2 * kHalfTurn), 0, 0, 0});
    if (!pair.integral().touching()) continue;
    const MovingIntegral whole = pair.derivative(false)[0];
    const std::span<const MovingIntegral> patches = pair.derivative(true);
    REQUIRE(patches.size() == pair.patches().size());
    Moving force_x(0.), moment_b(0.);
    for (const MovingIntegral& patch : patches) {
      force_x += patch.force_x;
      moment_b += patch.moment_b;
    }
    const double size = whole.weight.v;
    for (int k = 0; k < 4; ++k) {
      CHECK(std::abs(force_x.d.v[k] - whole.force_x.d.v[k]) < 1e-9 * (1 + size));
      CHECK(std::abs(moment_b.d.v[k] - whole.moment_b.d.v[k]) < 1e-9 * (1 + size));
    }
    // By the shift of a, its turn and that of b: second derivatives of one energy.
    const std::array<Moving, 4> f{whole.force_x, whole.force_y, whole.moment_a, whole.moment_b};
    for (int i = 0; i < 4; ++i) {
      for (int k = 0; k < i; ++k) {
        CHECK(std::abs(f[static_cast<size_t>(i)].d.v[k] - f[static_cast<size_t>(k)].d.v[i]) <
              1e-9 * (1 + size));
      }
    }
  }
}
