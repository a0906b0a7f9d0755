// Friction per pair of elements: momentum, objectivity, stick, ledger, and what borders take away.
#include <catch2/catch.hpp>

#include "lib/mesh/rectangle_mesh.hpp"
#include "lib/run/json_archive.hpp"
#include "tests/contact/bodies.hpp"

using namespace apothem;
using namespace apothem::test;

namespace {

// Two meshes on each other and a rigid tip in between, in motion. Springs have no force yet.
struct Heap : Bodies {
  std::vector<Vec2> places;  // of the nodes in the mesh as given

  Heap(samples::Random& random, ElementShape shape, ForceDistribution distribution,
       const Friction& friction)
      : Bodies(element_law(3, distribution, friction), .1, .5) {
    const Mesh lower = rectangle_mesh({4, 2}, {4, 2}, {0, 0}, shape);
    const Mesh upper = rectangle_mesh({3, 2}, {4, 3}, {.6, 1.93}, shape);
    add_rigid(about_centre(Polygon({{-.5, 0}, {.1, -.6}, {.5, .2}})));
    add_mesh(lower);
    add_mesh(upper);
    join();
    places = lower.nodes;
    places.insert(places.end(), upper.nodes.begin(), upper.nodes.end());
    std::vector<double> v;
    for (double& u : displacement) {
      u = random.uniform(-.04, .04);
      v.push_back(random.uniform(-1, 1));
    }
    pose = {-.45, random.uniform(.6, 1.4), random.uniform(-3, 3)};
    const std::array rate{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    evaluate();
    REQUIRE_FALSE(contacts->fault());
    REQUIRE(contacts->contacts().size() > 3);
    update_friction(0);
    node_velocity = v;
    pose_rate.assign(rate.begin(), rate.end());
  }
  [[nodiscard]] Vec2 now(int n) const {
    return places[n] + Vec2(displacement[2 * n], displacement[2 * n + 1]);
  }
};

// A block dragged over a row of cells of 1 m, at a depth relative to half a cell, k = 1: mean of
// the friction over mu times the normal force, after the first four cells.
struct Drag {
  double mu, tangential_stiffness, depth;
};
double dragged(ContactSurface surface, ElementShape shape, const Drag& drag) {
  const Mesh row = rectangle_mesh({20, 1}, {20, 1}, {-10, -1}, shape);
  const Mesh block = rectangle_mesh({7, 1}, {7, 1}, {-8, -drag.depth / 2}, shape);
  const Friction friction{drag.mu, drag.tangential_stiffness};
  Bodies bodies(surface == ContactSurface::body
                    ? law_of(1, friction)
                    : element_law(1, ForceDistribution::resultant, friction));
  bodies.add_mesh(row);
  bodies.add_mesh(block);
  bodies.join();
  const size_t first = 2 * row.nodes.size();
  std::vector<double>&u = bodies.displacement, &v = bodies.node_velocity;
  for (size_t i = first; i < v.size(); i += 2) v[i] = 1;
  const double dt = 2e-3;
  double tangential = 0, normal = 0;
  for (int step = 0; step < 4000; ++step) {
    for (size_t i = first; i < u.size(); i += 2) u[i] += dt;
    bodies.evaluate();
    bodies.contacts->update_friction(bodies.kinematics(), dt);
    if (step < 2000) continue;
    const std::vector<ContactRecord> records = bodies.contacts->records();
    tangential -= on_body(records, 1, &ContactRecord::tangential).x();
    normal += on_body(records, 1, &ContactRecord::normal).y();
  }
  return tangential / (drag.mu * normal);
}

}  // namespace

TEST_CASE("friction of elements keeps linear and angular momentum", "[element_friction][contact]") {
  test::SeededRandom random(41);
  for (const ForceDistribution distribution :
       {ForceDistribution::resultant, ForceDistribution::integrated}) {
    for (const ElementShape shape : {ElementShape::triangle, ElementShape::quadrilateral}) {
      double worst = 0;
      for (int i = 0; i < scaled(50); ++i) {
        Heap heap(random, shape, distribution, {.7, 2});
        const std::vector<double> normal = heap.node_force;
        const Resultant pressed = heap.on_rigid(0);
        heap.update_friction(.01);
        const Resultant rigid = heap.on_rigid(0);
        const Vec2 at(heap.pose[0], heap.pose[1]);
        Vec2 sum = rigid.force - pressed.force;
        double moment = rigid.moment - pressed.moment + cross(at, sum), scale = 0;
        for (int n = 0; n < heap.nodes; ++n) {
          const Vec2 force = heap.on_node(n) - Vec2(normal[2 * n], normal[2 * n + 1]);
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

TEST_CASE("rigid motion of all elements together is no slip", "[element_friction][contact]") {
  test::SeededRandom random(42);
  for (const ElementShape shape : {ElementShape::triangle, ElementShape::quadrilateral}) {
    for (int i = 0; i < scaled(50); ++i) {
      Heap heap(random, shape, ForceDistribution::resultant, {10, 1});
      const Vec2 drift(random.uniform(-1, 1), random.uniform(-1, 1));
      const double spin = random.uniform(-1, 1);
      for (int n = 0; n < heap.nodes; ++n) {
        const Vec2 at = drift + cross(spin, heap.now(n));
        heap.node_velocity[2 * n] = at.x(), heap.node_velocity[2 * n + 1] = at.y();
      }
      const Vec2 centre = drift + cross(spin, Vec2(heap.pose[0], heap.pose[1]));
      heap.pose_rate = {centre.x(), centre.y(), spin};
      heap.update_friction(1);
      const std::span<const Spring> springs = heap.contacts->friction().springs();
      REQUIRE(springs.size() > 3);
      for (const Spring& s : springs) CHECK(std::abs(s.force) < 1e-13);
    }
  }
}

TEST_CASE("elements stick with k_s, slip at mu times the normal force, and remember it",
          "[element_friction][contact]") {
  const auto element_on_wall = [](double mu) {
    Bodies bodies(element_law(1, ForceDistribution::resultant, {mu, .6}), .1, .5);
    bodies.add_rigid(about_centre(samples::block(-1, -1, 2, .05)), {.5, -.475, 0});
    bodies.add_mesh(one_element({{0, 0}, {1, 0}, {1, 1}, {0, 1}}));
    bodies.join();
    bodies.evaluate();
    return bodies;
  };
  Bodies bodies = element_on_wall(.5);
  const FrictionMemory& memory = bodies.contacts->friction();
  const double normal = bodies.contacts->force_on(1).norm();

  // The wall moves by 1 mm under the element: the spring takes it back, and the element along.
  bodies.pose_rate = {1e-3, 0, 0};
  bodies.update_friction(1);
  CHECK(bodies.on_rigid(0).force.x() == Approx(-.5 * .6 * 1e-3).epsilon(1e-12));
  CHECK(bodies.contacts->force_on(1).x() == Approx(.5 * .6 * 1e-3).epsilon(1e-12));
  CHECK(memory.energy() == Approx(.5 * .6 * 1e-6 / 2).epsilon(1e-12));
  CHECK(bodies.contacts->friction_sizes()[1] == Approx(.5 * .6 * 1e-3).epsilon(1e-12));
  const std::vector<ContactRecord> record = bodies.contacts->records();
  REQUIRE(record.size() == 1);
  CHECK(record[0].tangential.x() == Approx(-.5 * .6 * 1e-3).epsilon(1e-12));
  // Its traction on the lower edge, to the right, which is along it.
  const std::vector<SurfaceRecord> surface = bodies.contacts->surface_records();
  REQUIRE(surface.size() == 8);
  CHECK(surface[4].pressure == Approx(normal / .5).epsilon(1e-12));
  CHECK(surface[4].traction == Approx(.6 * 1e-3).epsilon(1e-12));
  CHECK(std::count_if(surface.begin(), surface.end(),
                      [](const SurfaceRecord& s) { return s.traction == 0; }) == 6);
  CHECK(surface[2].traction == Approx(.6 * 1e-3 / 3).epsilon(1e-12));  // on the wall's top of 3 m

  JsonWriter writer;
  writer("contacts", *bodies.contacts);
  Bodies other = element_on_wall(.5);
  const nlohmann::json json = writer.json();
  JsonLoader loader(json);
  loader("contacts", *other.contacts);
  other.pose_rate = bodies.pose_rate;
  other.contacts->refresh(other.kinematics());
  other.find_forces();
  CHECK((bodies.node_force == other.node_force));
  CHECK((bodies.rigid_force == other.rigid_force));
  CHECK(other.contacts->friction_loss() == memory.loss());

  bodies.pose_rate = {1, 0, 0};
  bodies.update_friction(1);
  CHECK(bodies.on_rigid(0).force.x() == Approx(-.5 * normal).epsilon(1e-12));
  CHECK(memory.loss() > 0);

  const double whole = memory.energy() + memory.loss();
  bodies.pose[1] = -.6;
  bodies.evaluate();
  bodies.pose_rate = {0, 0, 0};
  bodies.update_friction(1);
  CHECK(memory.springs().empty());
  CHECK(memory.loss() == Approx(whole).epsilon(1e-14));

  Bodies none = element_on_wall(0);
  none.pose_rate = {1, 0, 0};
  none.update_friction(1);
  CHECK(none.contacts->friction().springs().empty());
}

TEST_CASE("friction of elements is lost on every border, that of boundary edges is not",
          "[element_friction][contact][slow]") {
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
  CHECK(over_quads > .985);
  CHECK(over_triangles > .985);
}
