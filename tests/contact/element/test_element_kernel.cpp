// Contact by the potentials of the outermost elements, and what it costs against the body's own
// surface.
#include <catch2/catch.hpp>

#include "lib/dynamics/simulation.hpp"
#include "lib/mesh/disc_mesh.hpp"
#include "lib/mesh/rectangle_mesh.hpp"
#include "tests/contact/bodies.hpp"

using namespace apothem;
using namespace apothem::test;

namespace {

// Square elements of 1 m (r = .5 m) with their top at y = 0, and a tool on them, given with its
// lowest point at y = 0.
struct Dragged {
  Dragged(ContactSurface surface, const Polygon& tool, double depth, double x) {
    const Mesh row = rectangle_mesh({9, 1}, {9, 1}, {-4.5, -1}, ElementShape::quadrilateral);
    const Vec2 centroid = samples::world_centroid(tool);
    Bodies bodies(surface == ContactSurface::body ? law_of(1)
                                                  : element_law(1, ForceDistribution::resultant));
    bodies.add_rigid(about_centre(tool), {x + centroid.x(), centroid.y() - depth, 0});
    bodies.add_mesh(row);
    bodies.join();
    bodies.evaluate();
    if (surface == ContactSurface::element) REQUIRE_FALSE(bodies.contacts->fault());
    bodies.find_forces();
    force = bodies.on_rigid(0).force;
  }
  Vec2 force;
};

// Largest |Fx/Fy| over one element, and how much less Fy is than in its middle.
std::pair<double, double> drag(ContactSurface surface, double depth) {
  const Polygon tip({{0, 0}, {1, 1}, {-1, 1}});
  double tangential = 0, least = HUGE_VAL;
  const double middle = Dragged(surface, tip, depth, 0).force.y();
  for (int i = 0; i <= 100; ++i) {
    const Vec2 f = Dragged(surface, tip, depth, .01 * i).force;
    tangential = std::max(tangential, std::abs(f.x() / f.y()));
    least = std::min(least, f.y());
  }
  return {tangential, 1 - least / middle};
}

// Discs of 1 m that meet with an offset across their velocity (m, m/s).
struct Oblique {
  int quarter;
  double speed, offset;
};
Model oblique_discs(const Oblique& o, ContactSurface surface, ForceDistribution distribution) {
  Model model;
  model.materials = {{"rock", 2000, {ElasticLaw::st_venant_kirchhoff, Plane::stress, 20e9, .2}}};
  model.contact.normal_stiffness = 20e9;
  model.contact.surface = surface;
  model.contact.distribution = distribution;
  const DiscCells cells{o.quarter, 1};
  const double half = std::sqrt(1 - o.offset * o.offset) + .0013;  // a little apart
  for (const double side : {-1., 1.}) {
    DeformableBody body;
    body.name = side < 0 ? "left" : "right";
    body.element = ElementKind::quad4;
    const Vec2 centre(side * half, side * o.offset);
    body.mesh = disc_mesh(centre, 1, cells, ElementShape::quadrilateral);
    body.velocity = {-side * o.speed, 0};
    body.first_node = model.node_count();
    model.deformables.push_back(body);
  }
  return model;
}

struct Impact {
  double worst = 0;     // energy error, of the kinetic energy
  double momentum = 0;  // largest error, of that of one disc
  bool touched = false;
};

Impact impact(const Model& model, double safety) {
  TimeSettings time;
  time.end = 4.5e-3;
  time.fixed_step = safety * Simulation(model, time, 1, 1).step_choice().stability;
  Simulation simulation(model, time, 1, 1);
  const double kinetic = simulation.energies().kinetic;
  Impact result;
  while (simulation.state().time < time.end) {
    simulation.step();
    const Energies e = simulation.energies();
    result.worst = std::max(result.worst, std::abs(e.total_error) / kinetic);
    result.touched = result.touched || e.contact > 0;
  }
  CHECK(simulation.energies().contact == 0);  // apart again
  const Momenta m = simulation.momenta();
  const double one = kinetic / model.deformables[1].velocity.norm();
  for (const double error : {m.x_error, m.y_error, m.angular_error}) {
    result.momentum = std::max(result.momentum, std::abs(error) / one);
  }
  return result;
}

}  // namespace

TEST_CASE("elements in contact keep linear and angular momentum", "[element_kernel][contact]") {
  test::SeededRandom random(31);
  for (const ForceDistribution distribution :
       {ForceDistribution::resultant, ForceDistribution::integrated}) {
    for (const ElementShape shape : {ElementShape::triangle, ElementShape::quadrilateral}) {
      double worst = 0;
      for (int i = 0; i < scaled(50); ++i) {
        const Mesh lower = rectangle_mesh({4, 2}, {4, 2}, {0, 0}, shape);
        const Mesh upper = rectangle_mesh({3, 2}, {4, 3}, {.6, 1.93}, shape);
        const Polygon tip({{-.5, 0}, {.1, -.6}, {.5, .2}});
        Bodies bodies(element_law(3, distribution), .1, .5);
        bodies.add_rigid(about_centre(tip));
        bodies.add_mesh(lower);
        bodies.add_mesh(upper);
        bodies.join();
        std::vector<Vec2> nodes = lower.nodes;
        nodes.insert(nodes.end(), upper.nodes.begin(), upper.nodes.end());
        std::vector<double>& u = bodies.displacement;
        for (double& x : u) x = random.uniform(-.04, .04);
        const Vec2 at(-.45, random.uniform(.6, 1.4));
        bodies.pose = {at.x(), at.y(), random.uniform(-3, 3)};
        bodies.evaluate();
        REQUIRE_FALSE(bodies.contacts->fault());
        REQUIRE(bodies.contacts->contacts().size() > 3);
        bodies.find_forces();
        const Resultant rigid = bodies.on_rigid(0);
        Vec2 sum = rigid.force;
        double moment = rigid.moment + cross(at, rigid.force), scale = rigid.force.norm();
        for (int n = 0; n < bodies.nodes; ++n) {
          const Vec2 force = bodies.on_node(n);
          sum += force;
          moment += cross(Vec2(nodes[n] + Vec2(u[2 * n], u[2 * n + 1])), force);
          scale = std::max(scale, force.norm());
        }
        worst = std::max({worst, sum.norm() / scale, std::abs(moment) / scale});
        CHECK((bodies.contacts->force_on(1) + bodies.contacts->force_on(2) + rigid.force).norm() <
              1e-13 * scale);
      }
      CAPTURE(worst);
      CHECK(worst < 1e-12);
    }
  }
}

TEST_CASE("contact of elements has the same bits for any number of threads",
          "[element_kernel][contact]") {
  const ElementShape shape = ElementShape::triangle;
  const Mesh lower = rectangle_mesh({40, .1}, {2000, 5}, {0, 0}, shape);
  const Mesh upper = rectangle_mesh({39, .1}, {1850, 5}, {.5, .097}, shape);
  std::vector<double> before;
  using enum ForceDistribution;
  for (const auto& [distribution, threads] :
       {std::pair(resultant, 1), {resultant, 3}, {integrated, 1}, {integrated, 3}}) {
    Bodies bodies(element_law(1, distribution), .002, 1, threads);
    bodies.add_mesh(lower);
    bodies.add_mesh(upper);
    bodies.join();
    std::vector<double>& u = bodies.displacement;
    for (size_t i = 0; i < u.size(); ++i) u[i] = 1e-4 * std::sin(static_cast<double>(i));
    bodies.evaluate();
    REQUIRE_FALSE(bodies.contacts->fault());
    CHECK(bodies.contacts->candidates() > 2000);
    CHECK(bodies.contacts->contacts().size() > 2000);
    bodies.find_forces();
    if (threads > 1) CHECK((bodies.node_force == before));
    before = bodies.node_force;
    // The search is kept while all boxes stay near.
    for (double& v : u) v += 5e-4;
    bodies.place();
    CHECK(bodies.contacts->searches() == 1);
  }
}

TEST_CASE("an element that does not deform feels what a rigid polygon feels",
          "[element_kernel][contact]") {
  const Polygon quad = quad_q(), tip = samples::shifted(triangle_t(), {.3, .75});
  for (const ForceDistribution distribution :
       {ForceDistribution::resultant, ForceDistribution::integrated}) {
    Bodies bodies(element_law(1, distribution));
    bodies.add_polygon(tip);
    bodies.add_mesh(one_element(quad.vertices()));
    bodies.join();
    bodies.evaluate();
    bodies.find_forces();
    const PairResult pair = edge(tip, quad);
    CHECK((bodies.on_rigid(0).force - pair.integral.force).norm() < 1e-14);
    CHECK(bodies.on_rigid(0).moment == Approx(pair.integral.moment_a).epsilon(1e-12));
    CHECK(bodies.contacts->energy() == Approx(pair.volume.energy).epsilon(1e-12));
    REQUIRE(bodies.contacts->contacts().size() == 1);
    CHECK(largest_penetration(*bodies.contacts) == Approx(pair.integral.depth).epsilon(1e-12));
    const std::vector<ContactRecord> record = bodies.contacts->records();
    REQUIRE(record.size() == 1);
    CHECK(record[0].penetration == Approx(pair.integral.depth).epsilon(1e-12));
    const Vec2 place(bodies.pose[0], bodies.pose[1]);
    CHECK((record[0].point - place - loading_point(pair.integral)).norm() < 1e-13);
  }
}

TEST_CASE("the resultant goes to the corners by the shape functions at its action point",
          "[element_kernel][contact]") {
  // Symmetric tip from above: in the middle of the upper edge's width, so half on each side.
  Bodies bodies(element_law(1, ForceDistribution::resultant));
  bodies.add_polygon(Polygon({{.5, .9}, {.7, 1.3}, {.3, 1.3}}));
  bodies.add_mesh(one_element({{0, 0}, {1, 0}, {1, 1}, {0, 1}}));
  bodies.join();
  bodies.evaluate();
  bodies.find_forces();
  const double y = bodies.contacts->records()[0].point.y();
  const double total = -bodies.on_rigid(0).force.y();
  CHECK(total < 0);
  CHECK(y > .9);
  CHECK(y < 1);
  for (const int upper : {2, 3}) CHECK(bodies.on_node(upper).y() == Approx(total / 2 * y));
  for (const int lower : {0, 1}) CHECK(bodies.on_node(lower).y() == Approx(total / 2 * (1 - y)));
}

TEST_CASE("an element bent or passed through is noticed", "[element_kernel][contact]") {
  Bodies bodies(element_law(1, ForceDistribution::resultant));
  bodies.add_polygon(samples::block(-1, -1, 2, .05));
  bodies.add_mesh(one_element({{0, 0}, {1, 0}, {1, 1}, {0, 1}}));
  const Mesh arrow = one_element({{0, 0}, {2, 0}, {.5, .5}, {0, 2}});
  CHECK_THROWS_AS(Bodies(bodies.law).add_mesh(arrow), InvalidPolygon);
  bodies.join();
  const Contacts& contacts = *bodies.contacts;
  std::vector<double>& u = bodies.displacement;
  bodies.evaluate();
  CHECK_FALSE(contacts.fault());
  u[4] = u[5] = -.6;  // the upper right corner below the diagonal
  bodies.evaluate();
  REQUIRE(contacts.fault());
  CHECK(contacts.fault()->kind == ContactFault::Kind::not_convex);
  for (size_t i = 0; i < u.size(); ++i) u[i] = i % 2 ? -.6 : 0;
  bodies.evaluate();
  REQUIRE(contacts.fault());
  CHECK(contacts.fault()->kind == ContactFault::Kind::element);
  u[0] = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_AS(bodies.place(), std::domain_error);
}

TEST_CASE("a tip dragged over a row of elements meets their borders", "[element_kernel][contact]") {
  for (const double depth : {.05, .2}) {
    const auto [tangential, loss] = drag(ContactSurface::element, depth);
    const auto [none, even] = drag(ContactSurface::body, depth);
    CAPTURE(depth, tangential, loss, none, even);
    // On a border the elements' part of the force is half of what it is elsewhere.
    const double sine = std::sqrt(.5), r_tip = std::sqrt(2.) - 1, r_element = .5;
    CHECK(loss == Approx(.5 / (1 + sine * r_element / r_tip)).epsilon(1e-10));
    CHECK(tangential == Approx(.17).margin(.005));
    CHECK(none < 1e-12);
    CHECK(std::abs(even) < 1e-12);
  }
}

TEST_CASE("a flat punch dragged over a row of elements loses force to their borders",
          "[element_kernel][contact]") {
  constexpr double r_element = .5, r_punch = 1;
  for (const double d : {.025, .05, .1, .24}) {
    for (const double width : {2., 2.3}) {
      const Polygon punch = samples::block(-width / 2, 0, width / 2, 2);
      const double whole = width * d / r_element + (width * d - d * d) / r_punch;
      for (int i = 0; i <= 50; ++i) {
        CAPTURE(d, width, i);
        const Vec2 body = Dragged(ContactSurface::body, punch, d, .02 * i).force;
        CHECK(std::abs(body.x()) < 1e-12 * std::abs(body.y()));
        CHECK(std::abs(body.y()) == Approx(whole).epsilon(1e-12));
        if (width != 2) continue;
        // Each metre of the punch meets the borders of one element.
        const Vec2 element = Dragged(ContactSurface::element, punch, d, .02 * i).force;
        CHECK(std::abs(element.y()) == Approx(whole - width * d * d / r_element).epsilon(1e-10));
      }
    }
  }
}

TEST_CASE("energy of two oblique discs: a floor, or the step squared",
          "[element_kernel][contact][deformable][slow]") {
  // Node against node, and in general position, where edges and faces come and go.
  for (const Oblique& o : {Oblique{6, 20, .5}, Oblique{8, 40, .35}}) {
    for (const ForceDistribution distribution :
         {ForceDistribution::resultant, ForceDistribution::integrated}) {
      const Model elements = oblique_discs(o, ContactSurface::element, distribution);
      const Impact coarse = impact(elements, .4), fine = impact(elements, .2);
      CAPTURE(o.quarter, coarse.worst, fine.worst, coarse.momentum);
      CHECK(coarse.touched);
      CHECK(coarse.momentum < 1e-13);
      CHECK(fine.worst > 2e-3);
      CHECK(coarse.worst / fine.worst < 1.1);
    }
    const Model surface = oblique_discs(o, ContactSurface::body, ForceDistribution::variational);
    const Impact coarse = impact(surface, .4), fine = impact(surface, .2);
    CAPTURE(o.quarter, coarse.worst, fine.worst);
    CHECK(coarse.worst < 3e-4);
    CHECK(coarse.worst / fine.worst == Approx(4).epsilon(o.quarter == 6 ? .05 : .2));
  }
}

TEST_CASE("a rigid block bounces on elements", "[element_kernel][contact][deformable]") {
  Model model;
  model.materials = {{"rock", 2000, {ElasticLaw::st_venant_kirchhoff, Plane::stress, 20e9, .2}}};
  model.contact.normal_stiffness = 20e9;
  model.contact.surface = ContactSurface::element;
  model.contact.distribution = ForceDistribution::resultant;
  RigidBody block;
  block.name = "block";
  block.velocity = {0, -5};
  set_shape(block, samples::block(.55, .501, 1.15, 1), model);
  model.bodies = {block};
  DeformableBody bar;
  bar.name = "bar";
  bar.mesh = rectangle_mesh({2, .5}, {8, 2}, {0, 0}, ElementShape::quadrilateral);
  model.deformables = {bar};
  TimeSettings time;
  time.end = 2e-3;
  time.fixed_step = .4 * Simulation(model, time, 1, 1).step_choice().stability;
  Simulation simulation(model, time, 1, 1);
  double pressed = 0;
  while (simulation.state().time < time.end) {
    simulation.step();
    const std::vector<ContactRecord> contacts = simulation.contacts();
    if (contacts.empty()) continue;
    double normal = 0;  // of all patches: the bar bends away from under the block's middle
    for (const ContactRecord& r : contacts) {
      CHECK(r.a == 0);
      CHECK(r.b == 1);
      normal += r.normal.y();
    }
    const BodyForce on_bar = simulation.contact_forces()[1];
    CHECK(normal == Approx(-on_bar.fy).epsilon(1e-12));
    CHECK(normal == Approx(simulation.state().force(0)[1]).epsilon(1e-12));
    pressed = std::max(pressed, normal);
  }
  CHECK(pressed > 0);
  CHECK(simulation.state().pose_rate(0)[1] > -4);
  const Momenta m = simulation.momenta();
  const double momentum = 5 * model.bodies[0].mass;
  CHECK(std::abs(m.x_error) < 1e-12 * momentum);
  CHECK(std::abs(m.y_error) < 1e-12 * momentum);
  CHECK(std::abs(m.angular_error) < 1e-12 * momentum);

  model.contact.potential = area_choice();  // which quadrilaterals do not have
  CHECK_THROWS_WITH(Simulation(model, time, 1, 1), Catch::Contains("potentials of their own"));
}
