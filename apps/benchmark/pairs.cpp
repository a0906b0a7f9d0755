// Pairs of polygons: quadrilaterals by each method, crosses by roof and by distance field. `error`
// is the worst |dF|/W of the method against the exact oracle on these pairs, `failures` how many of
// them it failed on or got wrong by more than 1 %.

#include <cmath>
#include <memory>
#include <stdexcept>

#include "apps/benchmark/bench.hpp"
#include "apps/cases/samples.hpp"
#include "geometry/exact/exact_integral.hpp"
#include "geometry/exact/overlap.hpp"
#include "geometry/integrals/contact_patches.hpp"
#include "geometry/integrals/placed_shapes.hpp"

namespace apothem {
namespace {

struct ReferencePair {
  Polygon a, b;
  Potential potential_a, potential_b;
  PairResult exact;
};
using Pairs = std::vector<ReferencePair>;

// Overlapping pairs, the centres 1.2 apart, moved by `offset`.
Pairs touching_pairs(double offset = 0) {
  constexpr size_t kPairs = 256;
  samples::Random random(1);
  Pairs pairs;
  while (pairs.size() < kPairs) {
    const Vec2 far(offset, offset);
    const double direction = random.uniform(0, 2 * M_PI);
    const Vec2 apart = 1.2 * Vec2(std::cos(direction), std::sin(direction));
    const Polygon a = samples::shifted(samples::random_quad(random), far);
    const Polygon b = samples::shifted(samples::shifted(samples::random_quad(random), apart), far);
    const PairResult exact = exact_method(a, b, {});
    if (exact.integral.depth < 1e-2) continue;
    pairs.push_back({a, b, make_potential(a), make_potential(b), exact});
  }
  return pairs;
}

// The same, moved apart; their boxes may still overlap.
Pairs missing_pairs() {
  Pairs pairs = touching_pairs();
  for (ReferencePair& pair : pairs) {
    pair.exact = {};
    pair.exact.integral.weight = 1;
    const Vec2 away = pair.b[0] + pair.b[2] - pair.a[0] - pair.a[2];
    pair.b = samples::shifted(pair.b, .85 * away.normalized());
  }
  return pairs;
}

template <class Method>
Work by_method(Pairs made, const Method& method) {
  const auto pairs = std::make_shared<Pairs>(std::move(made));
  const auto extras = [pairs, method] {
    double worst = 0, failures = 0;
    for (const ReferencePair& pair : *pairs) {
      double error = HUGE_VAL;
      try {
        error = (method(pair).integral.force - pair.exact.integral.force).norm() /
                pair.exact.integral.weight;
      } catch (const std::runtime_error&) {
      }
      if (error < 1e-2) {
        worst = std::max(worst, error);
      } else {
        ++failures;
      }
    }
    return std::vector<Extra>{{"error", worst}, {"failures", failures}};
  };
  const auto once = [pairs, method] {
    for (const ReferencePair& pair : *pairs) {
      try {
        keep(method(pair));
      } catch (const std::runtime_error&) {
        // A failure takes time as well.
      }
    }
    return static_cast<double>(pairs->size());
  };
  return {.once = once, .extras = extras};
}

// The kernel as the step loop calls it: shapes placed, memory at hand, many pairs at a time.
struct ConvexCases {
  PlacedShapes shapes;
  std::vector<Vec2> offsets;
  std::vector<NearEdges> near;
  ConvexPairs kernel;
  // Calls found(number, integral) for each pair.
  template <class F>
  void evaluate(const F& found) {
    near.assign(offsets.size(), {});
    size_t done = 0;
    for (size_t i = 0; i < offsets.size(); ++i) {
      const int a = 2 * static_cast<int>(i);
      kernel.add(shapes.view(a), shapes.view(a + 1), offsets[i], near[i]);
      if (!kernel.full() && i + 1 < offsets.size()) continue;
      for (const PairIntegral& integral : kernel.evaluate()) found(done++, integral);
    }
  }
};

Work by_edges(const Pairs& pairs) {
  const auto cases = std::make_shared<ConvexCases>();
  for (const ReferencePair& pair : pairs) {
    for (const Potential* potential : {&pair.potential_a, &pair.potential_b}) {
      cases->shapes.place(cases->shapes.add(*potential), 0, 0, 0);
    }
    cases->offsets.emplace_back(pair.a.origin() - pair.b.origin());
  }
  double worst = 0;
  cases->evaluate([&](size_t i, const PairIntegral& integral) {
    const PairIntegral& exact = pairs[i].exact.integral;
    worst = std::max(worst, (integral.force - exact.force).norm() / exact.weight);
  });
  const auto once = [cases] {
    cases->evaluate([](size_t, const PairIntegral& integral) { keep(integral); });
    return static_cast<double>(cases->offsets.size());
  };
  return {.once = once, .extras = [worst] {
            return std::vector<Extra>{{"error", worst}, {"failures", 0}};
          }};
}

// Crosses of five unit squares, arm on arm.
struct Crosses {
  static constexpr int kPairs = 64;
  explicit Crosses(PotentialChoice::Field field) {
    const Polygon cross = samples::cross_of_squares();
    const PotentialChoice choice{.field = field,
                                 .reference = PotentialChoice::Reference::inscribed_circle};
    potential = translated(make_potential(cross, choice), area_moments(cross).centroid);
    samples::Random random(3);
    for (int i = 0; i < kPairs; ++i) {
      for (int k = 0; k < 2; ++k) {
        shapes.place(shapes.add(potential), 0, 0, random.uniform(0, 2 * M_PI));
      }
      const double direction = random.uniform(0, 2 * M_PI);
      offsets.emplace_back(1.9 * std::cos(direction), 1.9 * std::sin(direction));
    }
  }
  Potential potential;
  PlacedShapes shapes;
  std::vector<Vec2> offsets;
  EdgeWorkspace edges;
  PatchWorkspace for_patches;
  std::vector<BoundarySegment> segments;
  std::vector<PairIntegral> patches;
};

Work cross_integrals(PotentialChoice::Field field) {
  const auto c = std::make_shared<Crosses>(field);
  return {.once = [c] {
    for (int k = 0; k < Crosses::kPairs; ++k) {
      keep(
          pair_integral(c->shapes.view(2 * k), c->shapes.view(2 * k + 1), c->offsets[k], c->edges));
    }
    return static_cast<double>(Crosses::kPairs);
  }};
}

Work cross_patches(PotentialChoice::Field field) {
  const auto c = std::make_shared<Crosses>(field);
  const auto all = [c] {
    size_t patches = 0;
    for (int k = 0; k < Crosses::kPairs; ++k) {
      contact_patches(c->shapes.view(2 * k), c->shapes.view(2 * k + 1), c->offsets[k],
                      c->for_patches, c->segments, c->patches);
      patches += c->patches.size();
    }
    return static_cast<double>(patches);
  };
  return {.once =
              [all] {
                keep(all());
                return static_cast<double>(Crosses::kPairs);
              },
          .extras =
              [all] {
                return std::vector<Extra>{{"patches", all() / Crosses::kPairs}};
              }};
}

}  // namespace

std::vector<BenchmarkCase> pair_cases() {
  using Field = PotentialChoice::Field;
  std::vector<BenchmarkCase> cases;
  const auto enter = [&](const std::string& name, const std::string& about,
                         const std::function<Work()>& make) {
    cases.push_back(
        {.name = name, .item = "pair", .about = about, .prepare = [make](int) { return make(); }});
  };
  enter("quad_pair_edge", "quadrilaterals that overlap, by edge integrals",
        [] { return by_edges(touching_pairs()); });
  for (const int offset : {1'000'000, 1'000'000'000}) {
    enter("quad_pair_edge_offset/" + std::to_string(offset), "the same, so many m from zero",
          [offset] { return by_edges(touching_pairs(offset)); });
  }
  enter("quad_pair_near_miss", "quadrilaterals that just miss each other",
        [] { return by_edges(missing_pairs()); });
  for (const auto& [name, arithmetic] :
       {std::pair("inexact", Arithmetic::inexact), std::pair("exact", Arithmetic::exact)}) {
    enter(std::string("quad_pair_overlap_") + name,
          std::string("the overlap polygon by CGAL, ") + name, [arithmetic = arithmetic] {
            return by_method(touching_pairs(), [arithmetic](const ReferencePair& p) {
              return overlap_method(p.a, p.potential_a, p.b, p.potential_b, arithmetic);
            });
          });
  }
  enter("quad_pair_oracle", "the reference: exact overlap, 100 digits", [] {
    return by_method(touching_pairs(),
                     [](const ReferencePair& p) { return exact_method(p.a, p.b, {}); });
  });
  for (const auto& [field, name] :
       {std::pair(Field::roof, "roof"), std::pair(Field::distance, "distance field")}) {
    const std::string which = "/distance_field:" + std::to_string(static_cast<int>(field));
    enter("cross_pair_edge" + which, std::string("crosses, force: ") + name,
          [field = field] { return cross_integrals(field); });
    enter("cross_pair_patches" + which, std::string("crosses, contact patches: ") + name,
          [field = field] { return cross_patches(field); });
  }
  return cases;
}

}  // namespace apothem
