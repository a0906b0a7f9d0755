#include "apps/accuracy/cases.hpp"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>

#include "apps/cases/hard_pairs.hpp"
#include "apps/cases/samples.hpp"
#include "geometry/exact/overlap.hpp"
#include "geometry/skeleton/skeleton.hpp"
#include "lib/text/error.hpp"

namespace apothem {
namespace {

class Cases {
 public:
  void add(const std::string& kind, const std::string& name, const PolygonWithHoles& a,
           const PolygonWithHoles& b, const std::optional<ExpectedContact>& expected = {}) {
    AccuracyCase& to = named(kind);
    const char* which = "a";
    try {
      Polygon polygon_a = without_holes(a);
      which = "b";
      Polygon polygon_b = without_holes(b);
      which = "a or b";
      to.pairs.emplace_back(name, std::move(polygon_a), std::move(polygon_b));
      to.expected.push_back(expected);
    } catch (const InvalidPolygon& error) {
      refuse(to, name,
             fmt::format("polygon {}, vertex {}: {}", which, error.vertex(), error.what()));
    } catch (const SkeletonFailure& error) {
      refuse(to, name, error.what());
    }
  }
  AccuracyCase& named(const std::string& kind) {
    for (AccuracyCase& c : cases) {
      if (c.name == kind) return c;
    }
    AccuracyCase& c = cases.emplace_back();
    c.name = kind;
    return c;
  }
  std::vector<AccuracyCase> cases;

 private:
  // The methods from outside that are compared know rings only.
  static Polygon without_holes(const PolygonWithHoles& polygon) {
    if (!polygon.holes.empty()) {
      throw InvalidPolygon("has holes, which not all of the methods know; leave it out", 0);
    }
    return Polygon(polygon.outer);
  }
  static void refuse(AccuracyCase& in, const std::string& name, const std::string& why) {
    ++in.refused;
    fmt::print(stderr, "apothem: {}\n", SceneError(name, "refused: " + why).what());
  }
};

// Adds pairs of random polygons in general position that overlap.
void add_random(Cases& cases) {
  const auto fill = [&](const std::string& kind, int count, const auto& shape) {
    cases.named(kind).random = true;
    samples::Random random(7);
    for (int i = 1; i <= count;) {
      const Polygon a = shape(random);
      const double angle = random.uniform(0, 2 * M_PI);
      const double distance = random.uniform(.3, 1.2);
      const Vec2 centre =
          samples::world_centroid(a) + distance * Vec2(std::cos(angle), std::sin(angle));
      const Polygon b = samples::posed(shape(random), centre, random.uniform(0, 2 * M_PI));
      if (overlap_polygons(a, b, a.origin()).empty()) continue;
      cases.add(kind, fmt::format("{}/{}", kind, i++), {a.vertices(), {}}, {b.vertices(), {}});
    }
  };
  fill("generic-quads", 200, [](samples::Random& random) { return samples::random_quad(random); });
  fill("generic-convex", 200, [](samples::Random& random) {
    return samples::random_convex(random, random.integer(3, 8));
  });
  fill("generic-non-convex", 50, [](samples::Random& random) {
    return samples::random_star_shaped(random, random.integer(6, 12), .35);
  });
}

}  // namespace

std::vector<AccuracyCase> accuracy_cases(const std::vector<std::string>& files) {
  Cases cases;
  for (const std::string& file : files) {
    for (const PolygonPair& pair : read_pair_file(file)) {
      const std::string kind =
          pair.kind.empty() ? std::filesystem::path(file).filename().string() : pair.kind;
      cases.add(kind, pair.name, pair.a, pair.b, pair.expected);
    }
  }
  if (files.empty()) {
    add_random(cases);
    for (const HardPair& pair : hard_pairs()) {
      cases.add(pair.kind, pair.name, {pair.a.vertices(), {}}, {pair.b.vertices(), {}});
    }
  }
  return std::move(cases.cases);
}

}  // namespace apothem
