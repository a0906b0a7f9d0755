// Elements of several materials in one mesh: each element answers as it would in a mesh of its own
// material.
#include <catch2/catch.hpp>
#include <set>

#include "lib/fem/finite_elements.hpp"
#include "lib/fem/spectrum.hpp"
#include "lib/mesh/reorder.hpp"
#include "tests/fem/meshes.hpp"

using namespace apothem;
using namespace apothem::test;

namespace {

const std::vector<ElementMaterial> kMaterials{
    {{ElasticLaw::st_venant_kirchhoff, Plane::stress, 20e9, .2}, 2000, 0},
    {{ElasticLaw::neo_hookean, Plane::strain, 70e9, .3}, 2700, 1e-5},
    {{ElasticLaw::st_venant_kirchhoff, Plane::strain, 5e9, .1}, 1200, 3e-5}};

// The elements of one material, with all nodes of the mesh.
Mesh part_of(const Mesh& mesh, const std::vector<int>& material, int wanted) {
  Mesh part;
  part.nodes = mesh.nodes;
  for (int e = 0; e < mesh.element_count(); ++e) {
    if (material[static_cast<size_t>(e)] == wanted) part.add_element(mesh.element(e));
  }
  return part;
}

struct ElementAnswer {
  std::vector<double> force, sums, mass;
  double power, energy;
};

ElementAnswer answer_of(const ElementSet& set, const std::vector<double>& u,
                        const std::vector<double>& v, int threads) {
  FiniteElements elements(std::vector<ElementSet>{set}, threads);
  ElementAnswer result{std::vector<double>(u.size()), std::vector<double>(u.size()),
                       elements.mass(), 0, 0};
  result.mass.resize(u.size() / 2);
  // Nodes without elements are not written to.
  result.power = elements.force(u, v, result.force);
  result.energy = elements.strain_energy(u);
  elements.stiffness_sums(u, result.sums);
  return result;
}

double largest_entry(const std::vector<double>& values) {
  double most = 0;
  for (const double value : values) most = std::max(most, std::abs(value));
  return most;
}

void check_near(const std::vector<double>& a, const std::vector<double>& b, double share) {
  REQUIRE(a.size() == b.size());
  double off = 0;
  for (size_t i = 0; i < a.size(); ++i) off = std::max(off, std::abs(a[i] - b[i]));
  CHECK(off <= share * largest_entry(b));
}

}  // namespace

TEST_CASE("elements of several materials are the sum of the parts", "[fem][materials]") {
  for (const ElementKind kind :
       {ElementKind::tri3, ElementKind::quad4, ElementKind::quad4_full, ElementKind::polygon}) {
    CAPTURE(static_cast<int>(kind));
    const Mesh quads = distorted(quad_grid(40, 30, 4, 3), .2);
    Mesh mesh = kind == ElementKind::tri3 ? triangles(quads) : quads;
    reorder_along_curve(mesh);
    samples::Random random(4);
    std::vector<int> material;
    for (int e = 0; e < mesh.element_count(); ++e) material.push_back(random.integer(0, 2));
    REQUIRE(std::set<int>(material.begin(), material.end()).size() == 3);
    std::vector<double> u, v;
    for (size_t i = 0; i < 2 * mesh.nodes.size(); ++i) {
      u.push_back(random.uniform(-1e-3, 1e-3));
      v.push_back(random.uniform(-1, 1));
    }
    const ElementSet set{.kind = kind,
                         .mesh = &mesh,
                         .thickness = .5,
                         .materials = kMaterials,
                         .material_of = material};
    const ElementAnswer whole = answer_of(set, u, v, 1);
    ElementAnswer sum{std::vector<double>(u.size()), std::vector<double>(u.size()),
                      std::vector<double>(mesh.nodes.size()), 0, 0};
    for (int m = 0; m < 3; ++m) {
      const Mesh part = part_of(mesh, material, m);
      const ElementMaterial& own = kMaterials[static_cast<size_t>(m)];
      const ElementSet alone{.kind = kind,
                             .mesh = &part,
                             .material = own.elastic,
                             .density = own.density,
                             .thickness = .5,
                             .stiffness_damping = own.stiffness_damping};
      const ElementAnswer found = answer_of(alone, u, v, 1);
      for (size_t i = 0; i < u.size(); ++i) {
        sum.force[i] += found.force[i];
        sum.sums[i] += found.sums[i];
      }
      for (size_t i = 0; i < sum.mass.size(); ++i) sum.mass[i] += found.mass[i];
      sum.power += found.power;
      sum.energy += found.energy;
    }
    check_near(whole.force, sum.force, 1e-13);
    check_near(whole.mass, sum.mass, 1e-14);
    // Differences of forces: round-off counts more.
    check_near(whole.sums, sum.sums, 1e-6);
    CHECK(whole.power == Approx(sum.power).epsilon(1e-12));
    CHECK(whole.energy == Approx(sum.energy).epsilon(1e-12));
    CHECK(sum.power > 0);
    // The same bits for any number of threads.
    const ElementAnswer threads = answer_of(set, u, v, 4);
    CHECK(threads.force == whole.force);
    CHECK(threads.energy == whole.energy);

    // The stress of an element is that of its own material.
    const FiniteElements mixed(std::vector<ElementSet>{set}, 1);
    const std::vector<CauchyStress> stresses = mixed.stresses(u);
    for (int m = 0; m < 3; ++m) {
      const ElementMaterial& own = kMaterials[static_cast<size_t>(m)];
      const FiniteElements uniform(
          std::vector<ElementSet>{{.kind = kind, .mesh = &mesh, .material = own.elastic}}, 1);
      const std::vector<CauchyStress> expected = uniform.stresses(u);
      for (size_t e = 0; e < stresses.size(); ++e) {
        if (material[e] != m) continue;
        CHECK(stresses[e].xx == expected[e].xx);
        CHECK(stresses[e].zz == expected[e].zz);
        CHECK(stresses[e].energy_density == expected[e].energy_density);
        if (e % 50 == 0) CHECK(mixed.stress(u, 0, static_cast<int>(e)).xy == expected[e].xy);
      }
    }
  }
}

TEST_CASE("one material for all elements changes no bit", "[fem][materials]") {
  Mesh mesh = distorted(quad_grid(40, 30, 4, 3), .2);
  reorder_along_curve(mesh);
  samples::Random random(5);
  std::vector<double> u, v;
  for (size_t i = 0; i < 2 * mesh.nodes.size(); ++i) {
    u.push_back(random.uniform(-1e-3, 1e-3));
    v.push_back(random.uniform(-1, 1));
  }
  const ElementMaterial& own = kMaterials[1];
  const ElementSet plain{.mesh = &mesh,
                         .material = own.elastic,
                         .density = own.density,
                         .stiffness_damping = own.stiffness_damping};
  const std::vector<int> material(static_cast<size_t>(mesh.element_count()), 1);
  const ElementSet listed{.mesh = &mesh, .materials = kMaterials, .material_of = material};
  const ElementAnswer a = answer_of(plain, u, v, 1), b = answer_of(listed, u, v, 1);
  CHECK(a.force == b.force);
  CHECK(a.mass == b.mass);
  CHECK(a.power == b.power);
  CHECK(a.energy == b.energy);
}

TEST_CASE("the highest frequency of two materials is that of the faster one", "[fem][materials]") {
  Mesh mesh = quad_grid(20, 10, 2, 1);
  reorder_along_curve(mesh);
  std::vector<int> material;
  for (int e = 0; e < mesh.element_count(); ++e) {
    material.push_back(mesh.nodes[mesh.element(e)[0]].x() < .95 ? 0 : 1);
  }
  const std::vector<double> u(2 * mesh.nodes.size(), 0);
  const auto frequency = [&](const ElementSet& set) {
    FiniteElements elements(std::vector<ElementSet>{set}, 1);
    std::vector<double> inverse;
    for (const double m : elements.mass()) inverse.insert(inverse.end(), {1 / m, 1 / m});
    return std::sqrt(largest_eigenvalue(elements, u, inverse));
  };
  const auto alone = [&](const ElementMaterial& m) {
    return frequency({.mesh = &mesh, .material = m.elastic, .density = m.density});
  };
  const double slow = alone(kMaterials[0]), fast = alone(kMaterials[1]);
  REQUIRE(fast > 1.3 * slow);
  CHECK(frequency({.mesh = &mesh, .materials = kMaterials, .material_of = material}) ==
        Approx(fast).epsilon(.03));
}

TEST_CASE("small bodies that share blocks answer as each does alone", "[fem][materials]") {
  constexpr int kBodies = 40;
  samples::Random random(7);
  std::vector<Mesh> meshes;
  for (int i = 0; i < kBodies; ++i) {
    meshes.push_back(
        distorted(quad_grid(2 + i % 5, 3, 1, 1), .2, static_cast<std::uint64_t>(i + 1)));
  }
  std::vector<ElementSet> sets;
  std::vector<double> u, v;
  for (int i = 0; i < kBodies; ++i) {
    const ElementMaterial& m = kMaterials[static_cast<size_t>(i % 3)];
    sets.push_back({.kind = i % 4 == 0 ? ElementKind::quad4_full : ElementKind::quad4,
                    .mesh = &meshes[static_cast<size_t>(i)],
                    .first_node = static_cast<int>(u.size() / 2),
                    .material = m.elastic,
                    .density = m.density,
                    .thickness = i % 7 == 0 ? .5 : 1,
                    .stiffness_damping = m.stiffness_damping});
    for (size_t k = 0; k < 2 * meshes[static_cast<size_t>(i)].nodes.size(); ++k) {
      u.push_back(random.uniform(-1e-3, 1e-3));
      v.push_back(random.uniform(-1, 1));
    }
  }
  FiniteElements all(sets, 1);
  std::vector<double> force(u.size());
  const double power = all.force(u, v, force);
  double sum = 0;
  for (int i = 0; i < kBodies; ++i) {
    ElementSet alone = sets[static_cast<size_t>(i)];
    const auto first = 2 * static_cast<size_t>(alone.first_node);
    const size_t count = 2 * alone.mesh->nodes.size();
    const auto part = [&](const std::vector<double>& of) {
      return std::vector<double>(of.begin() + static_cast<std::ptrdiff_t>(first),
                                 of.begin() + static_cast<std::ptrdiff_t>(first + count));
    };
    alone.first_node = 0;
    const ElementAnswer answer = answer_of(alone, part(u), part(v), 1);
    sum += answer.power;
    CAPTURE(i);
    check_near(part(force), answer.force, 1e-14);
    const int last = alone.mesh->element_count() - 1;
    CHECK(all.stress(u, i, last).xx ==
          FiniteElements(std::vector<ElementSet>{alone}, 1).stress(part(u), 0, last).xx);
  }
  CHECK(power == Approx(sum).epsilon(1e-12));
}
