// The list of hard pairs in data/polygons: what is in it, and both methods on all of it.
#include "apps/cases/hard_pairs.hpp"

#include <catch2/catch.hpp>
#include <cstdio>
#include <functional>
#include <map>
#include <random>

#include "geometry/exact/exact_integral.hpp"
#include "geometry/exact/overlap.hpp"
#include "lib/scene/pair_file.hpp"
#include "tests/support.hpp"

using namespace apothem;

namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

const std::vector<PolygonPair>& list() {
  static const std::vector<PolygonPair> pairs =
      read_pair_file(test::kSource + "/data/polygons/hard-pairs.json");
  return pairs;
}

const ExpectedContact& expected(const std::string& name) {
  for (const PolygonPair& pair : list()) {
    if (pair.name == name) return *pair.expected;
  }
  FAIL(name << " is not in the list");
  throw std::logic_error("not reached");
}

// Two polygons, what their contact should be, and the scales of its errors.
struct Pair {
  std::string name;
  Polygon a, b;
  ExpectedContact expected;
  Potential potential_a = make_potential(a);
  Potential potential_b = make_potential(b);
  double size = std::max(bounding_box(a).extent(), bounding_box(b).extent());
  double steepest = std::max(potential_a.steepest, potential_b.steepest);

  [[nodiscard]] PairResult edge() const { return edge_method(a, potential_a, b, potential_b); }
  [[nodiscard]] PairResult overlap() const {
    return overlap_method(a, potential_a, b, potential_b);
  }
};

// The tolerance is the goal, or where that is larger the round-off of phi that one ulp of the
// coordinates makes.
ExpectedContact oracle(const Polygon& a, const Polygon& b) {
  const auto [pair, volume] = exact_method(a, b, {});
  const double size = std::max(bounding_box(a).extent(), bounding_box(b).extent());
  const double steepest = std::max(make_potential(a).steepest, make_potential(b).steepest);
  return {pair.force,
          pair.moment_a,
          pair.moment_b,
          pair.weight,
          volume.energy,
          volume.overlap_area,
          pair.own_length_a + pair.own_length_b,
          std::max(1e-12, kEpsilon * size * steepest)};
}

// Largest error figures over many pairs (docs/theory.md, Normal contact).
struct Figures {
  std::vector<double> of_length, of_force, scaled;
  int above_goal = 0;

  void check(const Pair& p, const PairResult& r) {
    INFO(p.name);
    const ExpectedContact& x = p.expected;
    const double length = x.own_length > 0 ? x.own_length : p.size;
    const double error = (r.integral.force - x.force).norm();
    const double force = x.force.norm();
    of_length.push_back(error / length);
    above_goal += error > 1e-12 * length;
    REQUIRE(error <= x.tolerance * length);
    REQUIRE(std::abs(r.integral.moment_a - x.moment_a) <= x.tolerance * length * p.size);
    REQUIRE(std::abs(r.integral.moment_b - x.moment_b) <= x.tolerance * length * p.size);
    // Sums over triangles as large as the polygons, as many as they have vertices.
    const double sums = 1e-15 * (p.a.size() + p.b.size()) * p.size * p.size;
    REQUIRE(std::abs(r.volume.energy - x.energy) <= sums);
    REQUIRE(std::abs(r.volume.overlap_area - x.overlap_area) <= sums);
    if (!(x.weight > 0)) return;
    // Depth: the mean of the boundary inside. Where tractions cancel, W stands for |F|.
    const double depth = x.weight / length / p.steepest;
    const double scale = force > .1 * x.weight ? force : x.weight;
    of_force.push_back(error / scale);
    scaled.push_back(error / scale * depth / (kEpsilon * p.size));
    REQUIRE(scaled.back() < 50);
  }
};

Pair listed(const PolygonPair& pair) {
  return {pair.name, Polygon(pair.a.outer), Polygon(pair.b.outer), *pair.expected};
}

// Of the polygon scaled by a power of two. Not made again: CGAL may need another attempt at the
// same skeleton, which then differs in last bits.
Potential scaled(Potential potential, double factor) {
  for (Vec2& v : potential.vertices) v *= factor;
  for (Vec2& g : potential.gradients) g /= factor;
  for (Vec2& p : potential.top_points) p *= factor;
  potential.steepest /= factor;
  if (potential.roof) {
    for (Vec2& p : potential.roof->points) p *= factor;
  }
  return potential;
}

bool same_bits(const PairIntegral& x, const PairIntegral& y) {
  return x.force == y.force && x.moment_a == y.moment_a && x.moment_b == y.moment_b &&
         x.weight == y.weight && x.own_length_a == y.own_length_a &&
         x.own_length_b == y.own_length_b && x.depth == y.depth;
}

}  // namespace

TEST_CASE("the list of hard pairs is what the generator makes", "[hard_pairs]") {
  const std::vector<HardPair> made = hard_pairs();
  REQUIRE(made.size() == list().size());
  const auto same = [](const std::vector<Vec2>& x, const std::vector<Vec2>& y) {
    REQUIRE(x.size() == y.size());
    for (size_t i = 0; i < x.size(); ++i) {  // sines differ in their last bit between libraries
      CHECK((x[i] - y[i]).norm() <= 4 * kEpsilon * std::max(x[i].norm(), 1.0));
    }
  };
  std::map<std::string, int> kinds;
  for (size_t i = 0; i < made.size(); ++i) {
    INFO(made[i].name);
    CHECK(list()[i].name == made[i].name);
    CHECK(list()[i].kind == made[i].kind);
    REQUIRE(list()[i].expected);
    same(list()[i].a.outer, made[i].a.vertices());
    same(list()[i].b.outer, made[i].b.vertices());
    ++kinds[made[i].kind];
  }
  for (const char* kind : {"vertex-on-vertex", "vertex-on-edge", "collinear-edges", "coincident",
                           "shallow", "near-parallel", "needle-on-needle", "comb-in-comb",
                           "spiral-in-spiral", "many-sided", "offset", "one-ulp"}) {
    INFO(kind);
    CHECK(kinds[kind] >= 5);
  }
}

TEST_CASE("the expected values agree with closed forms", "[hard_pairs]") {
  const auto name = [](const char* format, auto... values) {
    char text[80];
    std::snprintf(text, sizeof text, format, values...);
    return std::string(text);
  };
  const auto upwards = [](const ExpectedContact& x, double force, double energy) {
    CHECK(x.force.y() == Approx(force).epsilon(2e-13));
    CHECK(std::abs(x.force.x()) <= 1e-15 * force);
    CHECK(x.energy == Approx(energy).epsilon(2e-13));
  };
  for (const double depth : {1e-1, 1e-3, 1e-6, 1e-9, 1e-12}) {
    for (const double degrees : {10.0, 30.0, 60.0}) {
      INFO("apex on apex, " << degrees << ", depth " << depth);
      const double s = std::sin(degrees * M_PI / 180), c = std::cos(degrees * M_PI / 180);
      const double r = s * c / (1 + s);
      const double force = depth * depth * s * s / c / r;
      upwards(expected(name("vertex-on-vertex/%.0f-deg-depth-%g", degrees, depth)), force,
              force * depth / 3);
    }
    INFO("apex on flat, depth " << depth);
    const double s = .5, c = std::sqrt(.75), r = s * c / (1 + s);
    const double force = depth * depth * s / c * (1 + s / r);
    upwards(expected(name("vertex-on-edge/30-deg-depth-%g", depth)), force, force * depth / 3);
  }
  for (const double d : {.25, 1e-1, 1e-3, 1e-6, 1e-9}) {
    INFO("flat on flat, depth " << d);
    const ExpectedContact& x = expected(name("collinear-edges/inside-a-wider-edge-depth-%g", d));
    upwards(x, d * (2 + 2 * (1 - d)), d * d + d * d - 2 * d * d * d / 3);
    CHECK(x.overlap_area == Approx(d).epsilon(1e-13));
    CHECK(x.own_length == Approx(2 + 2 * d).epsilon(1e-13));
  }
  // Coincident: no force; twice the volume under phi, for tangential polygons a third of the area,
  // else from the areas of the offset outlines.
  const double hexagon = 1.5 * std::sqrt(3.0), triangle = std::sqrt(3.0) / 4;
  for (const auto& [shape, area, energy] :
       {std::tuple("square", 1.0, 2 / 3.0), std::tuple("triangle", triangle, 2 * triangle / 3),
        std::tuple("needle", 5e-4, 1e-3 / 3), std::tuple("hexagon", hexagon, 2 * hexagon / 3),
        std::tuple("cross", 5.0, 14 / 3.0), std::tuple("comb", 11.0, 32 / 3.0)}) {
    for (const char* variant : {"", "-turned-and-from-another-vertex"}) {
      INFO(shape << variant);
      const ExpectedContact& x = expected("coincident/" + std::string(shape) + variant);
      CHECK(x.force == Vec2(0, 0));
      CHECK(x.overlap_area == Approx(area).epsilon(1e-12));
      CHECK(x.energy == Approx(energy).epsilon(1e-12));
    }
  }
}

TEST_CASE("both methods on the hard pairs", "[hard_pairs][slow]") {
  Figures edge, overlap;
  for (const PolygonPair& entry : list()) {
    const Pair pair = listed(entry);
    edge.check(pair, pair.edge());
    overlap.check(pair, pair.overlap());
  }
  CHECK(edge.above_goal == 0);
  CHECK(overlap.above_goal == 0);
}

TEST_CASE("hard pairs moved: the oracle decides again", "[hard_pairs]") {
  const std::vector<std::pair<std::string, std::function<Polygon(const Polygon&)>>> moves{
      {"rotated", [](const Polygon& p) { return samples::turned(p, .8765); }},
      {"shifted by 1e6",
       [](const Polygon& p) {
         return samples::shifted(p, {1e6, -3e6});
       }},
      {"shifted by 1e9", [](const Polygon& p) {
         return samples::shifted(p, {-1e9, 1e9});
       }}};
  const size_t stride =
      list().size() / static_cast<size_t>(test::scaled(static_cast<int>(list().size())));
  Figures edge, overlap;
  int collapsed = 0, checked = 0;
  for (size_t i = 0; i < list().size(); i += stride) {
    for (const auto& [move_name, move] : moves) {
      std::optional<Polygon> a, b;
      try {
        a = move(Polygon(list()[i].a));
        b = move(Polygon(list()[i].b));
      } catch (const InvalidPolygon&) {
        ++collapsed;  // far away its details are below the grid of the coordinates
        continue;
      }
      ++checked;
      const Pair pair{list()[i].name + ", " + move_name, *a, *b, oracle(*a, *b)};
      edge.check(pair, pair.edge());
      overlap.check(pair, pair.overlap());
    }
  }
  CHECK(collapsed * 20 < checked);
  CHECK(edge.above_goal == 0);
}

TEST_CASE("hard pairs in other words: the same bits", "[hard_pairs][slow]") {
  for (const PolygonPair& entry : list()) {
    INFO(entry.name);
    const Pair pair = listed(entry);
    const PairResult here = pair.edge();

    CHECK(same_bits(pair.edge().integral, here.integral));  // once more

    const PairIntegral swapped =
        edge_method(pair.b, pair.potential_b, pair.a, pair.potential_a).integral;
    CHECK(swapped.force == -here.integral.force);
    CHECK(swapped.moment_a == here.integral.moment_b);
    CHECK(swapped.moment_b == here.integral.moment_a);
    CHECK(swapped.weight == here.integral.weight);
    CHECK(swapped.own_length_a == here.integral.own_length_b);

    const auto reversed = [](const Polygon& polygon) {
      std::vector<Vec2> ring = polygon.vertices();
      std::reverse(ring.begin() + 1, ring.end());
      return Polygon(ring);
    };
    CHECK(reversed(pair.a).vertices() == pair.a.vertices());
    CHECK(reversed(pair.b).vertices() == pair.b.vertices());

    for (const int power : {-30, 20}) {
      const double scale = std::ldexp(1.0, power);
      const PairResult r =
          edge_method(samples::scaled(pair.a, scale), scaled(pair.potential_a, scale),
                      samples::scaled(pair.b, scale), scaled(pair.potential_b, scale));
      CHECK(r.integral.force == scale * here.integral.force);
      CHECK(r.integral.moment_a == scale * scale * here.integral.moment_a);
      CHECK(r.integral.weight == scale * here.integral.weight);
      CHECK(r.volume.energy == scale * scale * here.volume.energy);
      if (!pair.a.is_convex()) continue;
      const Potential again = make_potential(samples::scaled(pair.a, scale));
      CHECK(again.gradients == scaled(pair.potential_a, scale).gradients);
    }
  }
}

TEST_CASE("hard pairs from other vertices, and with doubled ones", "[hard_pairs][slow]") {
  Figures edge, overlap;
  for (const PolygonPair& entry : list()) {
    INFO(entry.name);
    std::vector<Vec2> a = entry.a.outer, b = entry.b.outer;
    std::rotate(a.begin(), a.begin() + 1, a.end());
    std::rotate(b.begin(), b.begin() + static_cast<std::ptrdiff_t>(b.size()) / 2, b.end());
    const Pair pair{entry.name, Polygon(a), Polygon(b), *entry.expected};
    edge.check(pair, pair.edge());
    overlap.check(pair, pair.overlap());

    // Equal neighbours are one vertex.
    a.insert(a.begin() + 2, a[1]);
    const Polygon doubled(a);
    CHECK(doubled.size() == pair.a.size());
    edge.check(pair, edge_method(doubled, make_potential(doubled), pair.b, pair.potential_b));
  }
}

TEST_CASE("needles that cross at random", "[hard_pairs]") {
  std::mt19937 random(2026);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (const double aspect : {3e2, 1e3, 1e4, 1e6, 1e7}) {
    INFO("aspect " << aspect);
    double worst = 0;
    for (int i = 0; i < test::scaled(200); ++i) {
      const auto needle = [&] {
        const double half = .5 / aspect;
        const Polygon thin({{-.5, -half}, {.5, -half * uniform(random)}, {.4, half}, {-.5, half}});
        const Polygon turned = samples::turned(thin, 7 * uniform(random));
        return samples::shifted(turned, {.2 * uniform(random), .2 * uniform(random)});
      };
      const Polygon a = needle(), b = needle();
      const ExpectedContact exact = oracle(a, b);
      if (!(exact.weight > 0)) continue;
      worst = std::max(worst,
                       (test::edge(a, b).integral.force - exact.force).norm() / exact.own_length);
    }
    CHECK(worst < 1e-12);
  }
}
