// Contact of rigid bodies by the potentials of their polygons: momenta, symmetry, bits, patches.
#include <algorithm>
#include <catch2/catch.hpp>
#include <set>

#include "geometry/integrals/penetration.hpp"
#include "lib/contact/rigid/pair_integrals.hpp"
#include "lib/execution/parallel.hpp"
#include "tests/contact/bodies.hpp"
#include "tests/geometry/patches.hpp"

using namespace apothem;
using namespace apothem::test;

namespace {

ContactLaw rough_law(FrictionLaw friction_law, double damping) {
  ContactLaw law = law_of(3, {.6, 2});
  law.friction_law = friction_law;
  law.damping.normal = damping;
  return law;
}

// Polygons of all sorts on a grid, so close that neighbours overlap, in motion. In a large heap
// some are equal: the skeleton of a new one takes longer than its contacts.
Bodies random_heap(samples::Random& random, const ContactLaw& law, int across, int threads = 1,
                   int materials = 1) {
  Bodies bodies(law, .1, .5, threads);
  std::vector<Potential> shapes;
  for (int i = 0; i < std::min(across * across, 60); ++i) {
    shapes.push_back(about_centre(
        random.integer(0, 1) ? samples::random_convex(random, random.integer(3, 8))
                             : samples::random_star_shaped(random, random.integer(4, 9), .5)));
  }
  for (int i = 0; i < across * across; ++i) {
    const Potential& shape = shapes[static_cast<size_t>(i) % shapes.size()];
    const double x = 1. * (i % across) + random.uniform(-.2, .2);
    const double y = 1. * (i / across) + random.uniform(-.2, .2);
    bodies.add_rigid(shape, {x, y, random.uniform(-3, 3)}, {1, 1, 2}, i % materials);
  }
  bodies.join();
  for (double& v : bodies.pose_rate) v = random.uniform(-1, 1);
  return bodies;
}

void step(Bodies& bodies, double dt) {
  for (size_t i = 0; i < bodies.pose.size(); ++i) bodies.pose[i] += dt * bodies.pose_rate[i];
  bodies.evaluate();
  bodies.update_friction(dt);
}

Vec2 place_of(const Bodies& bodies, RigidIndex i) {
  return {bodies.pose[3 * i], bodies.pose[3 * i + 1]};
}

// Two feet of 1 m on a wide floor whose top is at y = 0; `depth` of the feet in it.
const Polygon kTable(
    {{-1.5, 0}, {-.5, 0}, {-.5, 1}, {.5, 1}, {.5, 0}, {1.5, 0}, {1.5, 2}, {-1.5, 2}});
const Polygon kFloor = samples::block(-4, -2, 4, 0);
Bodies table_on_floor(const ContactLaw& law, double depth) {
  Bodies bodies(law);
  bodies.add_polygon(kFloor);
  bodies.add_polygon(samples::shifted(kTable, {0, -depth}), {1, 1, 1});
  bodies.join();
  bodies.evaluate();
  return bodies;
}

}  // namespace

TEST_CASE("two rigid bodies feel what the edge method says of their polygons",
          "[polygon_kernel][contact]") {
  test::SeededRandom random(71);
  int touching = 0;
  for (int i = 0; i < scaled(300); ++i) {
    const Polygon a = samples::random_convex(random, random.integer(3, 8));
    const Polygon b = samples::shifted(samples::random_star_shaped(random, 8, .5),
                                       {random.uniform(-2, 2), random.uniform(-2, 2)});
    const double k = 3 * .5;
    Bodies bodies(law_of(3), .1, .5);
    bodies.add_polygon(a, {1, 1, 1});
    bodies.add_polygon(b, {1, 1, 1});
    bodies.join();
    bodies.evaluate();
    bodies.find_forces();
    const PairResult pair = edge(a, b);
    const std::vector<Contact> contacts = bodies.contacts->contacts();
    REQUIRE(contacts.size() == (pair.integral.touching() ? 1 : 0));
    if (contacts.empty()) continue;
    ++touching;
    const PairIntegral& integral = pair.integral;
    const double size = k * integral.weight;
    const Resultant on_a = bodies.on_rigid(0), on_b = bodies.on_rigid(1);
    CHECK((on_a.force - k * integral.force).norm() < 1e-12 * size);
    CHECK(on_b.force == -on_a.force);
    CHECK(std::abs(on_a.moment - k * integral.moment_a) < 1e-12 * size);
    CHECK(std::abs(on_b.moment - k * integral.moment_b) < 1e-12 * size);
    CHECK(bodies.contacts->energy() == Approx(k * pair.volume.energy).epsilon(1e-11));
    CHECK(contacts[0].depth == Approx(integral.depth).epsilon(1e-11));
    if (!bodies.contacts->fault()) {
      CHECK(contacts[0].relative_depth == Approx(integral.largest_phi).epsilon(1e-11));
    }
    const PlacedShapes& shapes = bodies.contacts->surfaces().shapes();
    CHECK(contacts[0].stiffness == Approx(k * (integral.own_length_a * shapes.slope(1) +
                                               integral.own_length_b * shapes.slope(0)))
                                       .epsilon(1e-11));
    const double deepest = largest_penetration(*bodies.contacts);
    CHECK(deepest == Approx(penetration(a, b)).epsilon(1e-6));
    CHECK(deepest >= contacts[0].depth);
    CHECK(deepest <= contacts[0].at_most);
    CHECK(bodies.contacts->largest_force().value == Approx(on_a.force.norm()).epsilon(1e-14));
    CHECK(bodies.lambda[0] > 0);
    CHECK(bodies.lambda[1] > 0);
  }
  CHECK(touching > least(scaled(300) / 4));
}

TEST_CASE("a heap of polygons keeps linear and angular momentum, also where it rubs",
          "[polygon_kernel][contact]") {
  test::SeededRandom random(72);
  for (const FrictionLaw friction_law : {FrictionLaw::resultant, FrictionLaw::per_edge}) {
    for (const double damping : {0., .3}) {
      double worst = 0;
      for (int i = 0; i < scaled(20); ++i) {
        Bodies bodies = random_heap(random, rough_law(friction_law, damping), 6);
        for (int n = 0; n < 3; ++n) step(bodies, .01);
        REQUIRE(bodies.contacts->contacts().size() > 20);
        REQUIRE(spring_sum(*bodies.contacts) > 0);
        Vec2 sum = Vec2::Zero();
        double moment = 0, scale = 0;
        for (RigidIndex b = 0; b < 36; ++b) {
          const Resultant on = bodies.on_rigid(b);
          sum += on.force;
          moment += on.moment + cross(place_of(bodies, b), on.force);
          scale = std::max(scale, on.force.norm());
        }
        worst = std::max(worst, sum.norm() / scale);
        // Damping follows the rates of force and moments. The moments are about centres that move
        // past each other meanwhile: it keeps linear momentum only.
        if (damping == 0) worst = std::max(worst, std::abs(moment) / scale);
      }
      CAPTURE(static_cast<int>(friction_law), damping, worst);
      CHECK(worst < 1e-12);
    }
  }
}

TEST_CASE("swapping two rigid bodies swaps their forces to the last bit",
          "[polygon_kernel][contact]") {
  test::SeededRandom random(73);
  int touching = 0;
  for (int i = 0; i < scaled(300); ++i) {
    const auto polygon = [&] {
      return random.integer(0, 1) ? samples::random_convex(random, random.integer(3, 8))
                                  : samples::random_star_shaped(random, 8, .5);
    };
    const Potential a = about_centre(polygon()), b = about_centre(polygon());
    const std::array<double, 3> at_a{random.uniform(-1, 1), 0, random.uniform(-3, 3)};
    const std::array<double, 3> at_b{0, random.uniform(-2, 2), random.uniform(-3, 3)};
    std::array<double, 6> rate{};
    for (double& v : rate) v = random.uniform(-1, 1);
    const auto forces = [&](bool swapped) {
      Bodies bodies(law_of(3, {.6, 2}));
      bodies.add_rigid(swapped ? b : a, swapped ? at_b : at_a, {1, 1, 2});
      bodies.add_rigid(swapped ? a : b, swapped ? at_a : at_b, {1, 1, 2});
      bodies.join();
      bodies.evaluate();
      bodies.update_friction(0);
      const std::vector<double> normal = bodies.rigid_force;
      for (size_t k = 0; k < 6; ++k) bodies.pose_rate[k] = rate[swapped ? (k + 3) % 6 : k];
      bodies.update_friction(.01);
      return std::tuple(normal, bodies.rigid_force, spring_sum(*bodies.contacts));
    };
    const auto [normal, rough, springs] = forces(false);
    const auto [normal_swapped, rough_swapped, springs_swapped] = forces(true);
    if (springs > 0) ++touching;
    double size = 0;
    for (const double f : normal) size = std::max(size, std::abs(f));
    for (size_t k = 0; k < 6; ++k) {
      CHECK(normal[k] == normal_swapped[(k + 3) % 6]);
      // The point where friction acts is found from the other side.
      CHECK(std::abs(rough[k] - rough_swapped[(k + 3) % 6]) <= 1e-12 * size);
    }
    CHECK(springs == Approx(springs_swapped).margin(1e-12 * size));
  }
  CHECK(touching > least(scaled(300) / 4));
}

TEST_CASE("contact of rigid bodies has the same bits for any number of threads",
          "[polygon_kernel][contact][slow]") {
  const FrictionLaw friction_law = GENERATE(FrictionLaw::resultant, FrictionLaw::per_edge);
  ContactLaw law = rough_law(friction_law, .2);
  // Some pairs have neither friction nor damping.
  ContactRule smooth{{ContactRule::Party{false, 0}, ContactRule::Party{false, 1}}};
  smooth.friction = Friction{};
  smooth.damping = ContactDamping{};
  law.rules = {smooth};
  std::vector<double> forces, lambda, springs;
  double energy = 0, loss = 0, damping_loss = 0;
  PairPeak largest;
  for (const int threads : {1, 2, 3, 7}) {
    samples::Random random(74);
    Bodies bodies = random_heap(random, law, 26, threads, 3);
    const Contacts& contacts = *bodies.contacts;
    std::set<std::pair<int, int>> before;
    int begun = 0, ended = 0;
    for (int n = 0; n < 5; ++n) {
      step(bodies, .05);
      std::set<std::pair<int, int>> touching;
      for (const Contact& c : contacts.contacts()) touching.emplace(c.a, c.b);
      for (const auto& pair : touching) begun += n > 0 && !before.contains(pair);
      for (const auto& pair : before) ended += !touching.contains(pair);
      before = std::move(touching);
    }
    REQUIRE(begun > 50);
    REQUIRE(ended > 50);
    REQUIRE(Threads(2).worth(static_cast<int>(before.size()), 200));
    std::vector<double> now;
    for (const Spring& s : contacts.springs()) now.push_back(s.force);
    REQUIRE(now.size() > 500);
    Vec2 sum = Vec2::Zero();
    double sizes = 0;
    for (size_t i = 0; i < bodies.pose.size(); i += 3) {
      const Vec2 force(bodies.rigid_force[i], bodies.rigid_force[i + 1]);
      sum += force;
      sizes += force.norm();
    }
    CHECK(sum.norm() < 1e-13 * sizes);
    if (threads > 1) {
      CHECK((bodies.rigid_force == forces));
      CHECK((bodies.lambda == lambda));
      CHECK((now == springs));
      CHECK(contacts.energy() == energy);
      CHECK(contacts.friction_loss() == loss);
      CHECK(contacts.damping_loss() == damping_loss);
      CHECK(contacts.largest_force().value == largest.value);
      CHECK(contacts.largest_force().a == largest.a);
    }
    forces = bodies.rigid_force, lambda = bodies.lambda, springs = now;
    energy = contacts.energy(), loss = contacts.friction_loss();
    damping_loss = contacts.damping_loss();
    largest = contacts.largest_force();
  }
  CHECK(damping_loss > 0);
}

TEST_CASE("a body that stands on two feet has two patches, each with its own spring",
          "[polygon_kernel][contact]") {
  const double depth = .05;
  for (const bool rough : {false, true}) {
    CAPTURE(rough);
    Bodies bodies = table_on_floor(rough ? law_of(3, {.5, .7}) : law_of(3), depth);
    const Contacts& contacts = *bodies.contacts;
    bodies.pose_rate = {0, 0, 0, 1e-3, 0, 0};
    bodies.update_friction(1);
    CHECK(contacts.contacts().size() == 1);  // one pair
    const std::vector<ContactRecord> records = contacts.records();
    const test::PatchResult expected =
        edge_patches(kFloor, make_potential(kFloor), samples::shifted(kTable, {0, -depth}),
                     make_potential(samples::shifted(kTable, {0, -depth})));
    REQUIRE(expected.patches.size() == 2);
    REQUIRE(records.size() == 2);
    Vec2 normal = Vec2::Zero(), tangential = Vec2::Zero();
    for (size_t j = 0; j < 2; ++j) {
      const ContactRecord& record = records[j];
      const PairIntegral& patch = expected.patches[j];
      CHECK(record.a == 0);
      CHECK(record.b == 1);
      CHECK((record.normal - 3 * patch.force).norm() < 1e-13);
      CHECK(record.normal.y() < 0);  // on the floor
      CHECK((record.point - place_of(bodies, 0) - loading_point(patch)).norm() < 1e-12);
      CHECK(std::abs(std::abs(record.point.x()) - 1) < 1e-2);
      CHECK(record.penetration == Approx(depth));
      CHECK(record.phi == Approx(patch.largest_phi));
      // The table takes the floor along.
      CHECK(record.tangential.x() == Approx(rough ? .7e-3 : 0).epsilon(1e-10));
      normal += record.normal, tangential += record.tangential;
    }
    CHECK((records[0].point - records[1].point).norm() == Approx(2).epsilon(1e-2));
    CHECK((normal + tangential - bodies.on_rigid(0).force).norm() < 1e-13);
    const std::vector<Spring> springs = contacts.springs();
    REQUIRE(springs.size() == (rough ? 2 : 0));
    if (!rough) continue;
    CHECK(springs[0].key.part == 0);
    CHECK(springs[1].key.part == 1);
    CHECK(contacts.friction_sizes()[1] == Approx(2 * .7e-3).epsilon(1e-10));

    // One foot is lifted: its spring is lost, that of the other foot stays what it is.
    const Spring kept = springs[0], lost = springs[1];
    const double loss = contacts.friction_loss();
    bodies.pose_rate = {0, 0, 0, 0, 0, 0};
    bodies.pose[5] = records[0].point.x() < 0 ? .12 : -.12;
    bodies.evaluate();
    bodies.update_friction(1);
    const std::vector<ContactRecord> rest = contacts.records();
    REQUIRE(rest.size() == 1);
    CHECK(rest[0].point.x() * records[0].point.x() > 0);
    const std::vector<Spring> left = contacts.springs();
    REQUIRE(left.size() == 1);
    CHECK(left[0].force == Approx(kept.force * left[0].tangent.dot(kept.tangent)).epsilon(1e-12));
    CHECK(contacts.friction_loss() - loss ==
          Approx(kept.energy() + lost.energy() - left[0].energy()).epsilon(1e-10));
  }
}

TEST_CASE("pairs are told with the integrals that are kept, also while their lists grow",
          "[polygon_kernel][contact]") {
  samples::Random random(57);
  Bodies bodies = random_heap(random, rough_law(FrictionLaw::resultant, 0), 16);
  bodies.place();
  std::vector<BoxPair> neighbours;
  for (int i = 0; i < 256; ++i) {
    for (const int j : {i + 1, i + 16}) {
      if (j < 256) neighbours.push_back({i, j});
    }
  }
  PairIntegrals pairs(bodies.contacts->surfaces(), 1, PairIntegrals::Split::not_convex);
  pairs.set_pairs(neighbours);
  std::vector<PairIntegral> told;
  pairs.evaluate(
      [&](const PairInTouch&, const PairIntegral& integral, int) { told.push_back(integral); });
  REQUIRE(told.size() > 300);
  REQUIRE(told.size() == pairs.touching().size());
  for (size_t i = 0; i < told.size(); ++i) {
    const PairIntegral& kept = pairs.integral(pairs.touching()[i]);
    CHECK(told[i].force == kept.force);
    CHECK(told[i].largest_phi == kept.largest_phi);
  }
}

TEST_CASE("what pairs remember follows them through every search",
          "[polygon_kernel][friction][contact]") {
  for (const FrictionLaw law : {FrictionLaw::resultant, FrictionLaw::per_edge}) {
    samples::Random random(19), same(19);
    Bodies bodies = random_heap(random, rough_law(law, .3), 8, 3);
    Bodies other = random_heap(same, rough_law(law, .3), 8);
    size_t ended = 0, before = 0;
    for (int i = 0; i < 60; ++i) {
      other.contacts->forget_search();  // in every step
      step(bodies, .01);
      step(other, .01);
      REQUIRE(bodies.rigid_force == other.rigid_force);
      REQUIRE(bodies.contacts->friction_loss() == other.contacts->friction_loss());
      REQUIRE(bodies.contacts->damping_loss() == other.contacts->damping_loss());
      const size_t now = bodies.contacts->springs().size();
      ended += now < before;
      before = now;
    }
    CHECK(bodies.contacts->searches() < 30);
    CHECK(ended > 5);
    CHECK(before > 50);
  }
}

TEST_CASE("a slide that was tried leaves nothing behind", "[polygon_kernel][friction][contact]") {
  samples::Random random(23), same(23);
  Bodies bodies = random_heap(random, rough_law(FrictionLaw::resultant, .3), 6);
  Bodies other = random_heap(same, rough_law(FrictionLaw::resultant, .3), 6);
  for (int i = 0; i < 20; ++i) {
    // Two states that are tried, with other pairs in touch, on the way to the next step.
    const std::vector<double> pose = bodies.pose;
    for (const double dt : {.03, -.02}) {
      for (size_t c = 0; c < pose.size(); ++c) {
        bodies.pose[c] = pose[c] + dt * bodies.pose_rate[c];
      }
      bodies.evaluate();
      bodies.contacts->try_friction(bodies.kinematics(), dt);
      bodies.find_forces();
    }
    bodies.contacts->drop_trial();
    bodies.pose = pose;
    step(bodies, .01);
    step(other, .01);
    REQUIRE(bodies.rigid_force == other.rigid_force);
    REQUIRE(bodies.contacts->friction_loss() == Approx(other.contacts->friction_loss()));
  }
  CHECK(other.contacts->springs().size() > 20);
}

TEST_CASE("a pair of convex polygons is one patch", "[polygon_kernel][contact]") {
  Bodies bodies(law_of(3));
  bodies.add_polygon(quad_q(), {1, 1, 1});
  bodies.add_polygon(samples::shifted(triangle_t(), {.3, .75}), {1, 1, 1});
  bodies.join();
  bodies.evaluate();
  bodies.find_forces();
  const std::vector<ContactRecord> records = bodies.contacts->records();
  REQUIRE(records.size() == 1);
  CHECK(records[0].normal == bodies.on_rigid(0).force);
  CHECK(records[0].tangential == Vec2::Zero());
  CHECK(records[0].penetration == Approx(bodies.contacts->contacts()[0].depth).epsilon(1e-12));
}

TEST_CASE("polygons deep in each other are noticed before their potentials fall again",
          "[polygon_kernel][contact]") {
  // A unit square on a large block: its centre is .5 m above its base.
  const auto fault_at = [](double depth) {
    Bodies bodies(law_of(1));
    bodies.add_polygon(samples::block(-5, -10, 5, 0));
    bodies.add_polygon(samples::block(-.5, -depth, .5, 1 - depth), {1, 1, 1});
    bodies.join();
    bodies.evaluate();
    const std::optional<ContactFault> fault = bodies.contacts->fault();
    if (fault) {
      CHECK(fault->a == 0);
      CHECK(fault->b == 1);
      CHECK(std::abs(fault->place.x()) < 1e-9);
      CHECK(fault->depth > 0);
    }
    CHECK((largest_relative_depth(*bodies.contacts) >= 1) == fault.has_value());
    return fault ? std::optional(fault->kind) : std::nullopt;
  };
  using Kind = ContactFault::Kind;
  for (const double depth : {.01, .2, .4, .47}) CHECK_FALSE(fault_at(depth));
  for (const double depth : {.48, .499, .52}) CHECK(fault_at(depth) == Kind::singular_area);
  for (const double depth : {.53, .6, .8}) CHECK(fault_at(depth) == Kind::centre);
}
