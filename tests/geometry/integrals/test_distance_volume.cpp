// The distance fields of both polygons of a pair, each integrated over the other polygon, where
// vertices and edges of one polygon lie on the borders between the cells of the other one.
#include "geometry/integrals/distance_volume.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "geometry/exact/exact_integral.hpp"
#include "tests/geometry/long_outlines.hpp"
#include "tests/support.hpp"

using namespace apothem;

namespace {

PotentialChoice choice_of(double length) {
  return {.field = PotentialChoice::Field::distance,
          .reference = PotentialChoice::Reference::length,
          .length = length};
}

// The integral of phi of `owner` over `other`, in coordinates relative to `origin`. The reference
// length is either much less than 1 or more than the depth of the polygon, so that phi stays below
// its limit.
double volume(const Polygon& owner, const Polygon& other, double length, const Vec2& origin,
              DistanceVolume<double> integral = DistanceVolume<double>()) {
  std::vector<double> px, py;
  for (int i = 0; i <= owner.size(); ++i) {
    const Vec2 p = owner[i % owner.size()] - origin;
    px.push_back(p.x()), py.push_back(p.y());
  }
  const PlacedDistance<double> field{.size = owner.size(),
                                     .x = px.data(),
                                     .y = py.data(),
                                     .gx = nullptr,
                                     .gy = nullptr,
                                     .slope = 1 / length,
                                     .corners = nullptr,
                                     .capped = length < 1,
                                     .links = owner.links()};
  double sum = 0;
  for (int k = 0; k < other.rings(); ++k) {
    std::vector<double> x, y;
    for (const Vec2& v : other.ring(k)) {
      x.push_back(v.x() - origin.x()), y.push_back(v.y() - origin.y());
    }
    sum += integral.over(field, x, y);
  }
  return sum;
}

double distance(const Polygon& polygon, const Vec2& p) {
  double least = HUGE_VAL;
  for (int i = 0; i < polygon.size(); ++i) {
    const Vec2 arm = p - polygon[i], edge = polygon.after(i) - polygon[i];
    const double s = std::clamp(arm.dot(edge) / edge.squaredNorm(), 0., 1.);
    least = std::min(least, (arm - s * edge).norm());
  }
  return least;
}

// Where a vertical line crosses the outline, from below.
std::vector<double> crossings(const Polygon& polygon, double x) {
  std::vector<double> found;
  for (int i = 0; i < polygon.size(); ++i) {
    const Vec2 p = polygon[i], q = polygon.after(i);
    if ((p.x() < x) == (q.x() < x)) continue;
    found.push_back(p.y() + (q.y() - p.y()) * ((x - p.x()) / (q.x() - p.x())));
  }
  std::sort(found.begin(), found.end());
  return found;
}

// The same integral from the definition, by the midpoint rule with `count` columns between every
// two vertices and `count` points in every part of a column that is inside both polygons.
double reference(const Polygon& owner, const Polygon& other, double length, int count) {
  std::vector<double> x;
  for (const Polygon* polygon : {&owner, &other}) {
    for (const Vec2& v : polygon->vertices()) x.push_back(v.x());
  }
  std::sort(x.begin(), x.end());
  double sum = 0;
  for (size_t i = 1; i < x.size(); ++i) {
    const double dx = (x[i] - x[i - 1]) / count;
    for (int column = 0; column < count && dx > 1e-9; ++column) {
      const double at = x[i - 1] + (column + .5) * dx;
      const std::vector<double> own = crossings(owner, at), its = crossings(other, at);
      for (size_t k = 1; k < own.size(); k += 2) {
        for (size_t m = 1; m < its.size(); m += 2) {
          const double low = std::max(own[k - 1], its[m - 1]);
          const double dy = (std::min(own[k], its[m]) - low) / count;
          for (int j = 0; j < count && dy > 0; ++j) {
            sum += std::min(1., distance(owner, {at, low + (j + .5) * dy}) / length) * dx * dy;
          }
        }
      }
    }
  }
  return sum;
}

// Compares both fields with the reference and their sum with the energy of the methods.
void check_fields(const Polygon& a, const Polygon& b, double length) {
  const double in_a = reference(a, b, length, 150), in_b = reference(b, a, length, 150);
  for (const Vec2& origin : {Vec2(0, 0), a.origin(), b.origin()}) {
    CHECK(volume(a, b, length, origin) == Approx(in_a).epsilon(2e-4));
    CHECK(volume(b, a, length, origin) == Approx(in_b).epsilon(2e-4));
  }
  CHECK(test::edge(a, b, choice_of(length)).volume.energy == Approx(in_a + in_b).epsilon(2e-4));
  CHECK(exact_method(a, b, choice_of(length)).volume.energy == Approx(in_a + in_b).epsilon(2e-4));
}

using Ring = std::vector<Vec2>;

// Rings whose vertices, bisectors and reflex vertices are on a lattice: an L, a cross, and bars
// with one or two notches.
const std::vector<Ring> kLattice{
    {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}},
    {{1, 0},
     {2, 0},
     {2, 1},
     {3, 1},
     {3, 2},
     {2, 2},
     {2, 3},
     {1, 3},
     {1, 2},
     {0, 2},
     {0, 1},
     {1, 1}},
    {{0, 0}, {3, 0}, {3, 1}, {2, 1}, {1.5, .5}, {1, 1}, {0, 1}},
    {{0, 0}, {3, 0}, {3, 1}, {2.5, 1}, {2, .75}, {1.5, 1}, {1, .5}, {.5, 1}, {0, 1}},
    {{0, 0}, {2, 0}, {2, 2}, {1, .5}, {0, 2}}};

// The ring shifted by s, then turned by the angle with cosine c.x and sine c.y.
Polygon placed(const Ring& ring, const Vec2& s, const Vec2& c) {
  Ring result;
  for (const Vec2& v : ring) {
    const Vec2 p = v + s;
    result.emplace_back(c.x() * p.x() - c.y() * p.y(), c.y() * p.x() + c.x() * p.y());
  }
  return Polygon(result);
}

// Calls visit(a, b, moved b, number) for pairs of these rings at positions on a grid of 1/4, and
// for b moved by less than 1e-8 in a direction in which nothing coincides. APOTHEM_LONG=1 in the
// environment visits all positions, otherwise every seventh.
template <class Visit>
void on_lattice(const Visit& visit) {
  const int stride = test::long_run() ? 1 : 7 * (3 / test::scaled(3));
  int number = 0;
  for (const Ring& a : kLattice) {
    for (const Ring& b : kLattice) {
      for (const Vec2& turn :
           {Vec2(1, 0), Vec2(0, 1), Vec2(.6, .8), Vec2(std::sqrt(.5), std::sqrt(.5))}) {
        for (int x = -10; x <= 11; ++x) {
          for (int y = -10; y <= 11; ++y) {
            if (++number % stride != 0) continue;
            const Vec2 shift(x * .25, y * .25);
            INFO("number " << number << ", shift " << shift.transpose() << ", turn "
                           << turn.transpose());
            visit(placed(a, {0, 0}, turn), placed(b, shift, turn),
                  placed(b, shift + Vec2(7.1e-9, 4.3e-9), turn), number);
          }
        }
      }
    }
  }
}

}  // namespace

TEST_CASE("an edge leads straight to a reflex vertex of the other polygon", "[distance-volume]") {
  const Polygon a({{0, 0}, {.8, 0}, {.8, .4}, {.4, .4}, {.4, .8}, {0, .8}});
  const Polygon b({{.10158824816246967, .74155383795528051},
                   {.49696130907827418, .52151926317363462},
                   {.64365102559937148, .78510130378417098},
                   {.51186000529410325, .85844616204471957},
                   {.43851514703355465, .72665514173945145},
                   {.30672412672828647, .8},
                   {.38006898498883512, .93179102030526817},
                   {.24827796468356692, 1.0051358785658169}});
  check_fields(a, b, .04);

  const Ring notched{{0, 0}, {6, 0}, {6, 1},     {5, 1}, {4.5, .75},
                     {4, 1}, {2, 1}, {1.5, .75}, {1, 1}, {0, 1}};
  for (const Vec2& origin : {Vec2(0, 0), Vec2(-8.4464314136848841, 7.7174047579141707)}) {
    const Polygon bar = placed(notched, origin, {1, 0});
    const Polygon shifted = placed(notched, origin + Vec2(4.5, .25), {1, 0});
    check_fields(bar, shifted, 6);
    // Needless vertices that move the outline by 7e-12.
    Ring more = notched;
    more.insert(more.begin() + 1, {{.985361336283482, 2.66e-14}, {1.5, 6.5157e-12}});
    check_fields(bar, placed(more, origin + Vec2(4.5, .25), {1, 0}), 6);
  }
}

TEST_CASE("an edge touches the border of a cell in the middle", "[distance-volume]") {
  // The border is the parabola between the notch and the bottom of the polygon. Whether two
  // functions cross that only touch is up to round-off, which differs from turn to turn.
  const Ring block{{-.75, -.75}, {2.25, -.75}, {2.25, .25}, {-.75, .25}};
  const struct {
    Ring a, b;
    Vec2 shift;
  } pairs[] = {{kLattice[2], kLattice[1], {-.75, -.75}}, {kLattice[4], block, {0, 0}}};
  for (const auto& [ring_a, ring_b, shift] : pairs) {
    for (const double length : {.3, 10.}) {
      const PotentialChoice choice = choice_of(length);
      const auto at = [&](const Vec2& move, const Vec2& turn) {
        return test::edge(placed(ring_a, {0, 0}, turn), placed(ring_b, shift + move, turn), choice);
      };
      const double step = 1e-4;
      const auto slope = [&](const Vec2& u) {
        const Vec2 none(1, 0);
        return (at(step * u, none).volume.energy - at(-step * u, none).volume.energy) / (2 * step);
      };
      const Vec2 force(slope({1, 0}), slope({0, 1}));  // on a; b gets the opposite
      const PairResult moved = at({7.1e-9, 4.3e-9}, {1, 0});
      check_fields(placed(ring_a, {0, 0}, {1, 0}), placed(ring_b, shift, {1, 0}), length);
      for (int n = 0; n < 100; ++n) {
        INFO("length " << length << ", turn " << n);
        const Vec2 turn(std::cos(.1 * n), std::sin(.1 * n));
        const PairResult r = at({0, 0}, turn);
        const Vec2 f = r.integral.force;
        const Vec2 back(turn.dot(f), turn.x() * f.y() - turn.y() * f.x());
        CHECK((back - force).norm() <= 1e-3 * (1 + force.norm()));
        CHECK((back - moved.integral.force).norm() <= 1e-6);
        CHECK(std::abs(r.integral.moment_a - moved.integral.moment_a) <= 1e-6);
        CHECK(std::abs(r.volume.energy - moved.volume.energy) <= 2e-7);
      }
    }
  }
}

TEST_CASE("distance fields where features of lattice shapes coincide", "[distance-volume][slow]") {
  int touching = 0;
  on_lattice([&](const Polygon& a, const Polygon& b, const Polygon& moved, int number) {
    const double length = number % 2 == 0 ? .3 : 10;
    const double v = volume(a, b, length, {0, 0});
    // phi is at most 1 / length steep and 1 high, and the outline of b is at most 12 long.
    CHECK(std::abs(v - volume(a, moved, length, {0, 0})) <= 1e-7);
    if (number % 3 == 0) {
      CHECK(v == Approx(reference(a, b, length, 20)).epsilon(.01).margin(3e-4 / length));
    }
    touching += v > 0;
  });
  CHECK(touching > 100);
}

TEST_CASE("forces where features of lattice shapes coincide", "[distance-volume]") {
  on_lattice([&](const Polygon& a, const Polygon& b, const Polygon& moved, int number) {
    const PotentialChoice choice = choice_of(number % 2 == 0 ? .3 : 10);
    const Potential of_a = make_potential(a, choice);
    const Potential of_b = make_potential(b, choice), of_moved = make_potential(moved, choice);
    const PairResult r = edge_method(a, of_a, b, of_b);
    const PairResult s = edge_method(a, of_a, moved, of_moved);
    CHECK((r.integral.force - s.integral.force).norm() <= 1e-6);
    CHECK(std::abs(r.integral.moment_a - s.integral.moment_a) <= 3e-6);
    CHECK(std::abs(r.volume.energy - s.volume.energy) <= 2e-7);
    if (number % 101 != 0) return;
    const PairResult exact = exact_method(a, b, choice);
    CHECK((r.integral.force - exact.integral.force).norm() <= 1e-12);
    CHECK(std::abs(r.volume.energy - exact.volume.energy) <= 1e-12);
  });
}

// With few vertices all features are tried for every cell, with many only those near it.
TEST_CASE("the integral of a distance field is the same with vertices within the edges",
          "[distance-volume]") {
  test::SeededRandom random(71);
  constexpr int kParts = 16;
  const auto whole = [](const Polygon& polygon) {  // so that edges can be divided exactly
    return samples::mapped(polygon, [](const Vec2& v) {
      return Vec2(std::round(4096 * v.x()) / 4096, std::round(4096 * v.y()) / 4096);
    });
  };
  for (int i = 0; i < test::scaled(100); ++i) {
    const int n = random.integer(5, 30);
    const Polygon owner = whole(samples::random_star_shaped(random, n, random.uniform(.1, 1)));
    std::vector<Vec2> ring;
    for (int e = 0; e < owner.size(); ++e) {
      const Vec2 step = (owner.after(e) - owner[e]) / kParts;
      for (int k = 0; k < kParts; ++k) ring.emplace_back(owner[e] + k * step);
    }
    const Polygon divided(ring);
    const Vec2 shift(random.uniform(-1.5, 1.5), random.uniform(-.5, .5));
    const Polygon other = samples::shifted(
        whole(samples::random_star_shaped(random, random.integer(3, 20), .4)), shift);
    for (const double length : {.1, 10.}) {
      const double expected = volume(owner, other, length, Vec2::Zero());
      INFO("polygon " << i);
      CHECK(volume(divided, other, length, Vec2::Zero()) ==
            Approx(expected).epsilon(1e-11).margin(1e-13));
    }
  }
}

TEST_CASE("the integral over a big ring is the sum of those over triangles", "[distance-volume]") {
  test::SeededRandom random(72);
  int deep = 0;
  for (int i = 0; i < test::scaled(120); ++i) {
    const int n = random.integer(40, 150);  // more than the edges that are looked at one by one
    const Polygon other = i % 4 == 0   ? samples::gear(n / 4)
                          : i % 4 == 1 ? samples::comb(n / 4, 9)
                          : i % 4 == 2 ? samples::star(n / 2, .5)
                                       : samples::random_star_shaped(random, n, .3);
    const Box box = bounding_box(other);
    const double size = box.extent();
    const Polygon owner = samples::shifted(
        samples::scaled(samples::random_star_shaped(random, random.integer(4, 40), .4),
                        random.uniform(.2, 1) * size),
        {random.uniform(box.x0, box.x1), random.uniform(box.y0, box.y1)});
    for (const double length : {.05, 10 * size}) {
      double sum = 0, sizes = 0;
      for (int k = 2; k < other.size(); ++k) {
        const std::vector<Vec2> corners{other[0], other[k - 1], other[k]};
        const double area = ring_area(corners);
        if (area == 0) continue;
        const double part = volume(owner, Polygon(corners), length, Vec2::Zero());
        sum += area > 0 ? part : -part;
        sizes += part;
      }
      const double got = volume(owner, other, length, Vec2::Zero());
      INFO("pair " << i << ", length " << length << ": " << got << ", " << sum);
      CHECK(std::abs(got - sum) <= 1e-12 * sizes + 1e-15 * size * size);
      deep += got > 0;
    }
  }
  CHECK(deep > test::least(test::scaled(120)));
}

TEST_CASE("trees find all that bounds the cells of long outlines", "[distance-volume]") {
  test::SeededRandom random(73);
  int deep = 0;
  for (int i = 0; i < test::scaled(200); ++i) {
    const Polygon owner = test::long_outline(random, i % test::kOutlineKinds);
    const Polygon shape = test::long_outline(random, random.integer(0, test::kOutlineKinds - 1));
    // Some overlaps are small, others all of a polygon, and some polygons are not turned.
    const double size = i % 5 == 0 ? 3 : std::exp(random.uniform(-4, 1));
    const Vec2 centre = owner[random.integer(0, owner.size() - 1)];
    const Polygon other =
        samples::posed(samples::scaled(shape, size),
                       centre + Vec2(random.uniform(-size, size), random.uniform(-size, size)) / 2,
                       random.integer(0, 1) * random.uniform(0, 6));
    for (const double length : {.02, 10.}) {
      const double few = volume(owner, other, length, Vec2::Zero(), DistanceVolume<double>(10000));
      const double many = volume(owner, other, length, Vec2::Zero(), DistanceVolume<double>(0));
      INFO("pair " << i << ", length " << length);
      CHECK(std::abs(many - few) <= 1e-13 * few + 1e-16);
      deep += few > 0;
    }
    // With bounds of the overlap, as a pair has them.
    const PotentialChoice choice = choice_of(.02);
    const double energy = volume(owner, other, .02, Vec2::Zero(), DistanceVolume<double>(10000)) +
                          volume(other, owner, .02, Vec2::Zero(), DistanceVolume<double>(10000));
    CHECK(test::edge(owner, other, choice).volume.energy ==
          Approx(energy).epsilon(1e-12).margin(1e-15));
  }
  CHECK(deep > test::least(test::scaled(200)));
}

TEST_CASE("every cell of a round outline reaches its middle", "[distance-volume]") {
  // All features are equally far from the middle, up to round-off. The integral over the whole
  // outline is that over a large square.
  for (const int n : {40, 200, 600}) {
    for (const Polygon& owner : {samples::gear(n / 4), samples::star(n / 2, .5)}) {
      const double within = volume(owner, owner, 10, Vec2::Zero());
      CHECK(volume(owner, samples::block(-2, -2, 2, 2), 10, Vec2::Zero()) ==
            Approx(within).epsilon(1e-14 * n));
      CHECK(volume(owner, owner, 10, Vec2::Zero(), DistanceVolume<double>(10000)) ==
            Approx(within).epsilon(1e-14 * n));
    }
  }
}
