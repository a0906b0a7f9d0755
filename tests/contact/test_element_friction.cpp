// Friction per pair of elements: momentum, objectivity, stick, ledger, and what borders take away.
#include <catch2/catch.hpp>

#include "apothem/contact/deformable_friction.hpp"
#include "apothem/contact/element_friction.hpp"
#include "apothem/mesh/rectangle_mesh.hpp"
#include "contact/outline_pairs.hpp"

using namespace apothem;
using namespace apothem::test;

namespace {

FrictionTable same_friction(int bodies, double mu, double stiffness) {
  return {std::vector<int>(bodies), 1, {{mu, stiffness}}};
}

// Two meshes on each other and a rigid tip in between, in motion.
struct Heap {
  std::vector<Vec2> nodes;
  Polygon tip{{{-.5, 0}, {.1, -.6}, {.5, .2}}};
  Potential potential = translated(make_potential(tip), area_moments(tip).centroid);
  ElementContact contact;
  std::vector<double> u, v, place, rate;

  Heap(samples::Random& random, ElementShape shape, ForceDistribution distribution)
      : contact(3, .5, .1, distribution, 1) {
    const Mesh lower = rectangle_mesh({4, 2}, {4, 2}, {0, 0}, shape);
    const Mesh upper = rectangle_mesh({3, 2}, {4, 3}, {.6, 1.93}, shape);
    contact.add_rigid(potential, 0);
    contact.add_deformable(lower, boundary(lower), 0);
    contact.add_deformable(upper, boundary(upper), static_cast<int>(lower.nodes.size()));
    nodes = lower.nodes;
    nodes.insert(nodes.end(), upper.nodes.begin(), upper.nodes.end());
    for (size_t k = 0; k < 2 * nodes.size(); ++k) {
      u.push_back(random.uniform(-.04, .04));
      v.push_back(random.uniform(-1, 1));
    }
    place = {-.45, random.uniform(.6, 1.4), random.uniform(-3, 3)};
    rate = {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    contact.update(u, place);
    contact.evaluate();
    REQUIRE_FALSE(contact.fault());
    REQUIRE(contact.touching() > 3);
  }
  [[nodiscard]] Vec2 now(size_t n) const { return nodes[n] + Vec2(u[2 * n], u[2 * n + 1]); }
};

// A block dragged over a row of cells of 1 m, at a depth as a share of half a cell, k = 1: mean of
// the friction over mu times the normal force, after the first four cells.
struct Drag {
  double mu, tangential_stiffness, depth;
};
template <class Contact, class Friction>
double dragged(Contact contact, ElementShape shape, const Drag& drag) {
  const Mesh row = rectangle_mesh({20, 1}, {20, 1}, {-10, -1}, shape);
  const Mesh block = rectangle_mesh({7, 1}, {7, 1}, {-8, -drag.depth / 2}, shape);
  contact.add_deformable(row, boundary(row), 0);
  contact.add_deformable(block, boundary(block), static_cast<int>(row.nodes.size()));
  Friction friction{same_friction(2, drag.mu, drag.tangential_stiffness)};
  const size_t first = 2 * row.nodes.size();
  std::vector<double> u(first + 2 * block.nodes.size()), v(u.size());
  for (size_t i = first; i < v.size(); i += 2) v[i] = 1;
  const double dt = 2e-3;
  double tangential = 0, normal = 0;
  for (int step = 0; step < 4000; ++step) {
    for (size_t i = first; i < u.size(); i += 2) u[i] += dt;
    contact.update(u, {});
    contact.evaluate();
    friction.update(contact, v, {}, dt);
    if (step < 2000) continue;
    tangential -= friction.resultant(contact, 1).force.x();
    normal += contact.resultant(1).force.y();
  }
  return tangential / (drag.mu * normal);
}

double dragged(ContactSurface surface, ElementShape shape, const Drag& drag) {
  if (surface == ContactSurface::body) {
    return dragged<DeformableContact, DeformableFriction>({1, 1, .1, 1}, shape, drag);
  }
  return dragged<ElementContact, ElementFriction>({1, 1, .1, ForceDistribution::resultant, 1},
                                                  shape, drag);
}

}  // namespace

TEST_CASE("friction of elements keeps linear and angular momentum", "[element_friction]") {
  samples::Random random(41);
  for (const ForceDistribution distribution :
       {ForceDistribution::resultant, ForceDistribution::integrated}) {
    for (const ElementShape shape : {ElementShape::triangle, ElementShape::quadrilateral}) {
      double worst = 0;
      for (int i = 0; i < scaled(50); ++i) {
        const Heap heap(random, shape, distribution);
        ElementFriction friction(same_friction(3, .7, 2));
        friction.update(heap.contact, heap.v, heap.rate, .01);
        std::vector<double> f(heap.u.size());
        friction.add_forces(heap.contact, f);
        const auto rigid = friction.resultant(heap.contact, 0);
        const Vec2 at(heap.place[0], heap.place[1]);
        Vec2 sum = rigid.force;
        double moment = rigid.moment + cross(at, rigid.force), scale = 0;
        for (size_t n = 0; n < heap.nodes.size(); ++n) {
          const Vec2 force(f[2 * n], f[2 * n + 1]);
          sum += force;
          moment += cross(heap.now(n), force);
          scale = std::max(scale, force.norm());
        }
        REQUIRE(scale > 0);
        worst = std::max({worst, sum.norm() / scale, std::abs(moment) / scale});
      }
      CAPTURE(worst);
      CHECK(worst < 1e-12);
    }
  }
}

TEST_CASE("rigid motion of all elements together is no slip", "[element_friction]") {
  samples::Random random(42);
  for (const ElementShape shape : {ElementShape::triangle, ElementShape::quadrilateral}) {
    for (int i = 0; i < scaled(50); ++i) {
      Heap heap(random, shape, ForceDistribution::resultant);
      const Vec2 drift(random.uniform(-1, 1), random.uniform(-1, 1));
      const double spin = random.uniform(-1, 1);
      for (size_t n = 0; n < heap.nodes.size(); ++n) {
        const Vec2 at = drift + cross(spin, heap.now(n));
        heap.v[2 * n] = at.x(), heap.v[2 * n + 1] = at.y();
      }
      const Vec2 centre = drift + cross(spin, Vec2(heap.place[0], heap.place[1]));
      heap.rate = {centre.x(), centre.y(), spin};
      ElementFriction friction(same_friction(3, 10, 1));
      friction.update(heap.contact, heap.v, heap.rate, 1);
      REQUIRE(friction.memory().slips.size() > 3);
      for (const EdgeSlip& s : friction.memory().slips) CHECK(std::abs(s.spring) < 1e-13);
    }
  }
}

TEST_CASE("elements stick with k_s, slip at mu times the normal force, and remember it",
          "[element_friction]") {
  const Mesh mesh = one_element({{0, 0}, {1, 0}, {1, 1}, {0, 1}});
  const Polygon wall = samples::block(-1, -1, 2, .05);
  const Potential potential = translated(make_potential(wall), area_moments(wall).centroid);
  std::vector<double> place{.5, -.475, 0};
  ElementContact contact(1, .5, .1, ForceDistribution::resultant, 1);
  contact.add_rigid(potential, 0);
  contact.add_deformable(mesh, boundary(mesh), 0);
  const std::vector<double> u(8), still(8);
  contact.update(u, place);
  contact.evaluate();
  const double normal = contact.resultant(0).force.norm();

  // The wall moves by 1 mm under the element: the spring takes it back, and the element along.
  ElementFriction friction(same_friction(2, .5, .6));
  friction.update(contact, still, std::vector<double>{1e-3, 0, 0}, 1);
  CHECK(friction.resultant(contact, 0).force.x() == Approx(-.5 * .6 * 1e-3).epsilon(1e-12));
  CHECK(friction.resultant(contact, 1).force.x() == Approx(.5 * .6 * 1e-3).epsilon(1e-12));
  CHECK(friction.memory().energy == Approx(.5 * .6 * 1e-6 / 2).epsilon(1e-12));
  CHECK(friction.size(contact, 1) == Approx(.5 * .6 * 1e-3).epsilon(1e-12));
  std::vector<BodyContact> record = contact.body_contacts();
  friction.add_to(contact, record);
  REQUIRE(record.size() == 1);
  CHECK(record[0].friction.x() == Approx(-.5 * .6 * 1e-3).epsilon(1e-12));
  // Its traction on the lower edge, to the right, which is along it.
  const auto surface = contact.surface();
  const std::vector<double> pressure = contact.pressures(surface);
  const std::vector<double> traction = friction.tractions(contact, surface);
  REQUIRE(surface.size() == 8);
  CHECK(pressure[4] == Approx(normal / .5).epsilon(1e-12));
  CHECK(traction[4] == Approx(.6 * 1e-3).epsilon(1e-12));
  CHECK(std::count(traction.begin(), traction.end(), 0.) == 6);
  CHECK(traction[2] == Approx(.6 * 1e-3 / 3).epsilon(1e-12));  // on the wall's top of 3 m

  ElementFriction other(same_friction(2, .5, .6));
  other.restore(friction.memory());
  other.update(contact, still, std::vector<double>{1e-3, 0, 0}, 0);
  std::vector<double> forces(8), again(8);
  friction.add_forces(contact, forces);
  other.add_forces(contact, again);
  CHECK((forces == again));
  CHECK(other.memory().friction_loss == friction.memory().friction_loss);

  friction.update(contact, still, std::vector<double>{1, 0, 0}, 1);
  CHECK(friction.resultant(contact, 0).force.x() == Approx(-.5 * normal).epsilon(1e-12));
  CHECK(friction.memory().friction_loss > 0);

  const double whole = friction.memory().energy + friction.memory().friction_loss;
  place[1] = -.6;
  contact.update(u, place);
  contact.evaluate();
  friction.update(contact, still, std::vector<double>{0, 0, 0}, 1);
  CHECK(friction.memory().slips.empty());
  CHECK(friction.memory().friction_loss == Approx(whole).epsilon(1e-14));

  ElementFriction none(same_friction(2, 0, 1));
  none.update(contact, still, std::vector<double>{1, 0, 0}, 1);
  CHECK(none.memory().slips.empty());
}

TEST_CASE("friction of elements is lost on every border, that of boundary edges is not",
          "[element_friction]") {
  using enum ElementShape;
  // A pair's normal force rises and falls linearly over two cells; the spring rises with the ratio
  // rho of its stiffness to mu times that slope, and meets the limit on its way down.
  const double mu = .4, k_s = .1, depth = .2;
  const double rho = k_s / (mu * 2 * depth);
  // Shallow: nothing is lost near the borders.
  CHECK(dragged(ContactSurface::element, quadrilateral, {mu, k_s / 20, depth / 20}) ==
        Approx(2 * rho / (1 + rho)).epsilon(.01));
  const auto both = [&](ElementShape shape) {
    return std::pair(dragged(ContactSurface::element, shape, {mu, k_s, depth}),
                     dragged(ContactSurface::body, shape, {mu, k_s, depth}));
  };
  const auto [quads, over_quads] = both(quadrilateral);
  const auto [triangles, over_triangles] = both(triangle);
  CAPTURE(quads, over_quads, triangles, over_triangles);
  CHECK(quads == Approx(.743).margin(.005));
  CHECK(triangles == Approx(.552).margin(.005));
  CHECK(over_quads > .99);
  CHECK(over_triangles > .99);
}
