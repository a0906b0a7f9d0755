// Outlines of meshes and polygons in contact: candidates, limits, threads, energy in motion.
#include <algorithm>
#include <catch2/catch.hpp>
#include <set>
#include <string>

#include "geometry/spatial/loops.hpp"
#include "lib/mesh/rectangle_mesh.hpp"
#include "lib/run/json_archive.hpp"
#include "tests/contact/outline_pairs.hpp"

using namespace apothem;
using namespace apothem::test;

namespace {

// Edges and the faces that they touch.
std::set<std::pair<int, int>> touching(const Contacts& contacts) {
  std::set<std::pair<int, int>> pairs;
  for (const Contact& c : contacts.contacts()) {
    REQUIRE(c.kernel == outline_kernel);
    if (c.relative_depth > 1) continue;  // inside a saturated region
    pairs.emplace(c.a, c.b);
  }
  return pairs;
}

// Every edge against every face of other bodies.
std::set<std::pair<int, int>> touching_of_all(const OutlineSurfaces& o) {
  std::set<std::pair<int, int>> pairs;
  for (int e = 0; e < o.size(); ++e) {
    for (int f = 0; f < o.size(); ++f) {
      const bool rigid = o.bodies[o.body[e]].is_rigid() && o.bodies[o.body[f]].is_rigid();
      if (o.body[e] == o.body[f] || rigid) continue;
      CollarPiece<double> piece;
      CollarCrossings<double> crossings;
      const int q = o.next[e];
      if (collar_piece(o.face(f), o.x[e], o.y[e], o.x[q], o.y[q], piece, crossings) &&
          piece.deepest > 0)
        pairs.emplace(e, f);
    }
  }
  return pairs;
}

}  // namespace

TEST_CASE("candidates miss no contact while bodies move and deform", "[outline_kernel][contact]") {
  test::SeededRandom random(21);
  Bodies bodies(law_of(1));
  bodies.add_rigid(about_centre(samples::block(-9, -.5, 9, .5)));
  bodies.add_rigid(about_centre(samples::block(-9, -.5, 9, .5)));
  std::vector<Vec2> velocity;
  const int meshes = 12;
  for (int i = 0; i < meshes; ++i) {
    const std::vector<Vec2> ring =
        samples::shifted(samples::random_star_shaped(random, 8, .6), {1.9 * (i % 4), 1.9 * (i / 4)})
            .vertices();
    bodies.add_ring(ring, .3);
    velocity.emplace_back(random.uniform(-.002, .002), random.uniform(-.002, .002));
  }
  bodies.join();
  int found = 0;
  const int steps = scaled(300);
  for (int step = 0; step < steps; ++step) {
    for (int i = 0; i < bodies.nodes; ++i) {
      bodies.displacement[2 * i] += velocity[i / 8].x() + random.uniform(-1e-4, 1e-4);
      bodies.displacement[2 * i + 1] += velocity[i / 8].y() + random.uniform(-1e-4, 1e-4);
    }
    const double t = .002 * step;
    bodies.pose = {2, -1.4 + t, .1 * t, 3, -1.2, -t};
    bodies.evaluate();
    const auto all = touching_of_all(bodies.contacts->surfaces().outlines());
    CHECK(touching(*bodies.contacts) == all);
    found += static_cast<int>(all.size());
  }
  CHECK(found > steps);
  CHECK(bodies.contacts->searches() < std::max(2, steps / 2));
}

TEST_CASE("bodies that meet, part and meet again feel what they would at first sight",
          "[outline_kernel][contact]") {
  const std::vector<Vec2> ring = split(samples::block(0, 0, 1, 1).vertices(), 5);
  const auto pair = [&] {
    Bodies bodies(law_of(1), .05);
    bodies.add_ring(ring, .3);
    bodies.add_ring(ring, .3);
    bodies.join();
    return bodies;
  };
  Bodies bodies = pair();
  std::vector<double>& u = bodies.displacement;
  int touched = 0, apart = 0, deep = 0;
  for (int step = 0; step < 2000; ++step) {
    // The second body goes round the first one; its corners swing as well.
    const double t = .003 * step;
    for (size_t i = 0; i < ring.size(); ++i) {
      const Vec2 x = samples::turned(ring[i], .3 * std::sin(3 * t));
      const size_t c = 2 * (ring.size() + i);
      u[c] = x.x() - ring[i].x() + (1.2 + .7 * std::cos(2.3 * t)) * std::cos(t);
      u[c + 1] = x.y() - ring[i].y() + (1.2 + .7 * std::cos(2.3 * t)) * std::sin(t);
    }
    bodies.evaluate();
    bodies.find_forces();
    Bodies fresh = pair();
    fresh.displacement = u;
    fresh.evaluate();
    fresh.find_forces();
    REQUIRE(touching(*bodies.contacts) == touching(*fresh.contacts));
    REQUIRE(bodies.contacts->energy() == fresh.contacts->energy());
    REQUIRE((bodies.node_force == fresh.node_force));
    deep += largest_relative_depth(*fresh.contacts) > 1;
    (fresh.contacts->contacts().empty() ? apart : touched)++;
  }
  CHECK(touched > 200);
  CHECK(apart > 200);
  CHECK(deep > 100);
  CHECK(bodies.contacts->searches() < 1000);
}

TEST_CASE("a rigid body feels what its polygon feels", "[outline_kernel][contact]") {
  test::SeededRandom random(22);
  double worst = 0;
  int pairs = 0;
  const int wanted = scaled(300);
  while (pairs < wanted) {
    const Polygon a = samples::random_convex(random, random.integer(3, 9));
    const Polygon b = samples::random_convex(random, random.integer(3, 9));
    const Potential potential_b = make_potential(b);
    const Vec2 offset(random.uniform(-2, 2), random.uniform(-2, 2));
    const double angle = random.uniform(-3, 3);
    const Polygon moved = samples::mapped(
        a, [&](const Vec2& v) -> Vec2 { return samples::turned(v, angle) + offset; });
    Bodies bodies(law_of(1));
    const double r_a = inscribed_circle(a).radius, r_b = inscribed_circle(b).radius;
    bodies.add_rigid(about_origin(a), {offset.x(), offset.y(), angle});
    bodies.add_ring(b.vertices(), r_b);
    bodies.join();
    bodies.evaluate();
    const double share = largest_relative_depth(*bodies.contacts);
    if (!(share > .02) || share > .98) continue;
    // Only where the collars are the roofs.
    std::vector<double> first = first_nodes(a.vertices());
    for (const double h : first_nodes(b.vertices())) first.push_back(h);
    const OutlineSurfaces& o = bodies.contacts->surfaces().outlines();
    if (std::ranges::any_of(bodies.contacts->contacts(), [&](const Contact& c) {
          return c.relative_depth * o.depth[c.b] > first[c.b];
        })) {
      continue;
    }
    ++pairs;
    bodies.find_forces();
    const PairResult edge = edge_method(moved, make_potential(moved), b, potential_b);
    const Resultant on_a = bodies.on_rigid(0);
    worst = std::max(worst, (on_a.force - edge.integral.force).norm() / edge.integral.weight);
    const Vec2 arm = samples::world_centroid(moved) - offset;
    const double moment = edge.integral.moment_a + cross(arm, edge.integral.force);
    worst = std::max(worst, std::abs(on_a.moment - moment) / edge.integral.weight);
    const double energy = bodies.contacts->energy();
    worst = std::max(worst, std::abs(energy - edge.volume.energy) / edge.volume.energy);
    const double stiffness = edge.integral.own_length_a / r_b + edge.integral.own_length_b / r_a;
    double bound = 0;
    for (const Contact& c : bodies.contacts->contacts()) bound += c.stiffness;
    CHECK(bound == Approx(stiffness).epsilon(1e-10));
    const std::vector<ContactRecord> record = bodies.contacts->records();
    REQUIRE(record.size() == 1);
    worst = std::max(worst, (record[0].normal - on_a.force).norm() / edge.integral.weight);
  }
  CAPTURE(worst);
  CHECK(worst < 1e-12);
}

TEST_CASE("swapping two outlines changes round-off only", "[outline_kernel][contact]") {
  test::SeededRandom random(23);
  for (int i = 0; i < scaled(300); ++i) {
    const auto pair = random_pair(random, 8, .5);
    if (!pair) continue;
    const OutlinePair swapped(pair->b, pair->a, pair->reference_b, pair->reference_a);
    const double size = pair->largest_force();
    const size_t n = 2 * pair->a.size(), m = 2 * pair->b.size();
    for (size_t k = 0; k < n; ++k)
      CHECK(std::abs(pair->node_force[k] - swapped.node_force[m + k]) < 1e-14 * size);
    CHECK(pair->contacts->energy() == Approx(swapped.contacts->energy()).epsilon(1e-14));
  }
}

TEST_CASE("outlines of meshes: nodes, holes, references", "[outline_kernel][contact]") {
  const Mesh mesh = rectangle_mesh({2, 1}, {4, 4}, {0, 0}, ElementShape::quadrilateral);
  CHECK(boundary_inradius(mesh, boundary(mesh)) == Approx(.125));
  Bodies bodies(law_of(2), .01, .5);
  // 1 mm into the upper side.
  const Polygon tip({{0, 0}, {.2, 1}, {-.2, 1}});
  bodies.add_rigid(about_origin(tip, length_choice(.15)), {1.1, .999, 0});
  bodies.add_mesh(mesh, {}, 0, 3);
  bodies.join();
  bodies.evaluate();
  bodies.find_forces();
  const std::vector<double>& f = bodies.node_force;
  CHECK(f[0] == 0);
  double down = 0;
  for (size_t i = 1; i < f.size(); i += 2) {
    down += f[i];
    if (f[i] != 0) CHECK(mesh.nodes[i / 2 - 3].y() == 1);
  }
  const Resultant on_tip = bodies.on_rigid(0);
  CHECK(down == Approx(-on_tip.force.y()).epsilon(1e-12));
  const double slope = .2, d = .001;  // apex on flat
  const double expected = 2 * .5 * d * d * slope * (1 / .125 + std::sin(std::atan(slope)) / .15);
  CHECK(on_tip.force.y() == Approx(expected).epsilon(1e-10));
  const std::vector<Contact> contacts = bodies.contacts->contacts();
  const auto worst = std::max_element(
      contacts.begin(), contacts.end(),
      [](const Contact& p, const Contact& q) { return p.relative_depth < q.relative_depth; });
  const double limit = bodies.contacts->surfaces().outlines().depth[worst->b];
  CHECK(worst->relative_depth == Approx(d / limit).epsilon(1e-9));

  // A corner node carries half of two edges.
  std::vector<double> mass(mesh.nodes.size() + 3, 1e9);
  mass[3] = 7;
  const double bound = 2 * 2 * .5 * (1 / .125 + 1 / .15) * .375;
  CHECK(bodies.contacts->node_rate(mass) == Approx(bound / 7));
  mass[3] = 0;  // a held node has no rate
  CHECK(bodies.contacts->node_rate(mass) < bound / 1e8);
}

TEST_CASE("the collar is as deep as r, or a part of the smallest thickness",
          "[outline_kernel][contact]") {
  const auto depth_of = [](const Mesh& mesh, std::optional<double> reference = {}) {
    OutlineSurfaces outlines;
    outlines.add_mesh(mesh, boundary(mesh), 0, reference);
    return outlines.bodies[0].depth;
  };
  const auto bar = [](double height, int rows, ElementShape shape) {
    return rectangle_mesh({2, height}, {20, rows}, {0, 0}, shape);
  };
  for (const ElementShape shape : {ElementShape::quadrilateral, ElementShape::triangle}) {
    // One row of elements: a quarter of its thickness; two rows or more: r.
    CHECK(depth_of(bar(.1, 1, shape)) == Approx(std::min(.025, depth_of(bar(.2, 2, shape)))));
    const Mesh two = bar(.2, 2, shape);
    CHECK(depth_of(two) == Approx(boundary_inradius(two, boundary(two))));
  }
  // Fins count, wedges and round ends do not.
  const std::vector<Vec2> comb{{0, 0}, {3, 0}, {3, 2}, {2.8, 2}, {2.8, 1}, {1, 1}, {1, 3}, {0, 3}};
  CHECK(depth_of(one_element(comb), .2) == Approx(.1));
  CHECK(smallest_thickness({comb}, 9) == Approx(.2));
  const std::vector<Vec2> wedge{{0, 0}, {3, -.3}, {3, .3}};
  CHECK(smallest_thickness({split(wedge, 9)}, 9) == 9);
  std::vector<Vec2> round;
  for (int i = 0; i < 60; ++i) round.push_back(samples::turned({1, 0}, M_PI / 30 * i));
  CHECK(smallest_thickness({round}, 9) == 9);
  // A ring is as thick as its wall.
  std::vector<Vec2> hole;
  for (int i = 0; i < 60; ++i) hole.push_back(samples::turned({.8, 0}, -M_PI / 30 * i));
  CHECK(smallest_thickness({round, hole}, 9) == Approx(.2).epsilon(.01));
  // A given r, and a rigid body: half of its thickness.
  CHECK(depth_of(bar(1, 10, ElementShape::quadrilateral), .2) == .2);
  OutlineSurfaces outlines;
  outlines.add_rigid({comb}, 0, .4);
  CHECK(outlines.bodies[0].depth == Approx(.1));
  outlines.add_rigid({samples::block(0, 0, 4, 1).vertices()}, 1, .5);
  CHECK(outlines.bodies[1].depth == .5);
}

TEST_CASE("a body pushed through the collar meets a constant pressure there",
          "[outline_kernel][contact]") {
  const std::vector<Vec2> bar = split(samples::block(-2, -1, 2, 0).vertices(), 8);
  // A stamp between two nodes of the bar; both have collars of 1/8.
  for (const double d : {.1, .2, .4, .7}) {
    const OutlinePair pair(bar, split(samples::block(-.8, -d, .7, 2).vertices(), 4), .125, .125);
    CAPTURE(d);
    CHECK((largest_relative_depth(*pair.contacts) > 1) == (d > .125));
    CHECK_FALSE(pair.contacts->fault());
    // On the stamp, and on the bar, whose edges go into the sides of the stamp as well.
    const double h = std::min(d, .125);
    CHECK(pair.on(1).force.y() == Approx(1.5 * h / .125 + (1.5 * h - h * h) / .125).epsilon(1e-12));
    CHECK(largest_penetration(*pair.contacts) == Approx(std::min(d, .75)).epsilon(1e-9));
    const std::vector<ContactRecord> records = pair.contacts->records();
    REQUIRE(records.size() == 1);
    CHECK((records[0].normal - pair.on(0).force).norm() < 1e-12);
    CHECK(records[0].penetration == Approx(std::min(d, .75)).epsilon(1e-9));
    CHECK(records[0].phi == Approx(h / .125));
  }
}

TEST_CASE("a vertex of an outline that is nowhere is an error", "[outline_kernel][contact]") {
  Bodies bodies(law_of(1), .01);
  bodies.add_ring(samples::block(0, 0, 1, 1).vertices(), .5);
  bodies.join();
  bodies.displacement[3] = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_AS(bodies.place(), std::domain_error);
}

TEST_CASE("contact of outlines has the same bits for any number of threads",
          "[outline_kernel][contact]") {
  const Mesh lower = rectangle_mesh({40, .1}, {4000, 10}, {0, 0}, ElementShape::quadrilateral);
  const Mesh upper = rectangle_mesh({39, .1}, {3700, 10}, {.5, .097}, ElementShape::quadrilateral);
  std::vector<double> before;
  for (const int threads : {1, 2, 3}) {
    Bodies bodies(law_of(1), .002, 1, threads);
    bodies.add_mesh(lower);
    bodies.add_mesh(upper);
    bodies.join();
    std::vector<double>& u = bodies.displacement;
    for (size_t i = 0; i < u.size(); ++i) u[i] = 1e-4 * std::sin(static_cast<double>(i));
    bodies.evaluate();
    CHECK(bodies.contacts->candidates() > 10000);
    bodies.find_forces();
    if (threads > 1) CHECK((bodies.node_force == before));
    before = bodies.node_force;
  }
}

namespace {

struct Slid {
  std::vector<double> nodes, rigid, springs;
  double loss = 0, damping_loss = 0;
  bool operator==(const Slid&) const = default;
};

// Strips on strips and rigid blocks on these, which slide.
Slid slide_strips(int threads, bool search_often) {
  constexpr int kStrips = 7, kCells = 400;
  ContactLaw law = law_of(1, {.3, .8});
  law.damping = {.3, .3, 0};
  Bodies bodies(law, .002, 1, threads);
  for (int k = 0; k < kStrips; ++k) {
    const Polygon block = samples::block(5. * k + 1, .197, 5. * k + 3, .4);
    bodies.add_polygon(block, {1, 1, 2});
  }
  for (const double y : {0., .0985}) {
    for (int k = 0; k < kStrips; ++k) {
      bodies.add_mesh(
          rectangle_mesh({4, .1}, {kCells, 2}, {5. * k + .3 * y, y}, ElementShape::quadrilateral));
    }
  }
  bodies.join();
  for (int n = 0; n < 4; ++n) {
    for (size_t i = 0; i < bodies.node_velocity.size(); ++i) {
      bodies.node_velocity[i] = .02 * std::sin(static_cast<double>(i) + n);
      bodies.displacement[i] += .01 * bodies.node_velocity[i];
    }
    for (size_t i = 0; i < bodies.pose_rate.size(); ++i) {
      bodies.pose_rate[i] = .02 * std::sin(static_cast<double>(i) + 2 * n);
      bodies.pose[i] += .01 * bodies.pose_rate[i];
    }
    if (search_often) bodies.contacts->forget_search();
    bodies.evaluate();
    bodies.update_friction(.01);
  }
  Slid found{bodies.node_force,
             bodies.rigid_force,
             {},
             bodies.contacts->friction_loss(),
             bodies.contacts->damping_loss()};
  for (const Spring& s : bodies.contacts->friction().springs()) found.springs.push_back(s.force);
  return found;
}

}  // namespace

TEST_CASE("friction and damping of outlines have the same bits for any number of threads",
          "[outline_kernel][outline_friction][contact][slow]") {
  const Slid one = slide_strips(1, false);
  REQUIRE(Threads(2).worth(static_cast<int>(one.springs.size()), 80));
  CHECK(one.loss != 0);
  CHECK(one.damping_loss > 0);
  for (const int threads : {2, 3, 7}) CHECK((slide_strips(threads, false) == one));
}

TEST_CASE("what touches is the same for any number of threads",
          "[outline_kernel][onset][contact][slow]") {
  // Strips on strips, with more units of candidates than one thread works on.
  constexpr int kStrips = 6, kCells = 1500;
  std::string before;
  for (const int threads : {1, 2, 3, 7}) {
    Bodies bodies(law_of(1), .002, 1, threads);
    for (const double y : {0., .0985}) {
      for (int k = 0; k < kStrips; ++k) {
        bodies.add_mesh(rectangle_mesh({4, .1}, {kCells, 2}, {4. * k + 20 * y, y},
                                       ElementShape::quadrilateral));
      }
    }
    bodies.join();
    std::vector<double>& u = bodies.displacement;
    for (size_t i = 0; i < u.size(); ++i) u[i] = 1e-4 * std::sin(static_cast<double>(i));
    bodies.evaluate();
    CHECK_FALSE(bodies.contacts->find_event_impulses(bodies.kinematics(), {}, 0));
    JsonWriter archive;
    archive("contacts", *bodies.contacts);
    const std::string saved = archive.json().dump();
    CHECK(saved.find("\"touching\"") != std::string::npos);
    CHECK(std::count(saved.begin(), saved.end(), '{') > 2 * kStrips);
    if (threads > 1) CHECK(saved == before);
    before = saved;
  }
}

TEST_CASE("friction and damping of outlines do not depend on when they were searched for",
          "[outline_kernel][outline_friction][contact]") {
  CHECK((slide_strips(1, true) == slide_strips(1, false)));
}

TEST_CASE("energy of a bounce of two soft bodies converges with the step squared",
          "[outline_kernel][contact]") {
  const std::vector<Vec2> a = split(samples::block(-.5, -.5, .5, .5).vertices(), 2);
  std::vector<Vec2> b = a;
  for (Vec2& v : b) v = samples::turned(v, .5) + Vec2(.2, 1.3);
  const int n = static_cast<int>(a.size());
  std::vector<Vec2> x0 = a;
  x0.insert(x0.end(), b.begin(), b.end());
  const double spring = 40, stiffness = 30;
  const auto run = [&](double dt) {
    OutlinePair pair(a, b, .25, .25, law_of(stiffness));
    std::vector<double>& u = pair.displacement;
    std::vector<double> v(u.size());
    for (int i = 0; i < n; ++i) v[2 * i + 1] = .5, v[2 * (n + i) + 1] = -.5;
    std::vector<double> f(u.size());
    double springs = 0;
    const auto forces = [&] {
      pair.evaluate();
      pair.find_forces();
      f = pair.node_force;
      springs = 0;
      for (int i = 0; i < 2 * n; ++i) {
        for (int j = i + 1; j < (i < n ? n : 2 * n); ++j) {
          const Vec2 rest = x0[j] - x0[i];
          const Vec2 now = rest + Vec2(u[2 * j] - u[2 * i], u[2 * j + 1] - u[2 * i + 1]);
          const double stretch = now.norm() - rest.norm();
          springs += spring / 2 * stretch * stretch;
          const Vec2 pull = spring * stretch * now.normalized();
          f[2 * i] += pull.x(), f[2 * i + 1] += pull.y();
          f[2 * j] -= pull.x(), f[2 * j + 1] -= pull.y();
        }
      }
    };
    const auto kick = [&] {
      for (size_t k = 0; k < u.size(); ++k) v[k] += dt / 2 * f[k];
    };
    forces();
    double start = -1, worst = 0;
    double deepest = 0, spin = 0;
    for (int step = 0; step * dt < 3; ++step) {
      kick();
      for (size_t k = 0; k < u.size(); ++k) u[k] += dt * v[k];
      forces();
      kick();
      double energy = springs + pair.contacts->energy();
      for (const double w : v) energy += w * w / 2;
      if (start < 0) start = energy;
      worst = std::max(worst, std::abs(energy - start) / start);
      deepest = std::max(deepest, largest_relative_depth(*pair.contacts));
    }
    for (int i = 0; i < 2 * n; ++i) {
      spin += cross(x0[i] + Vec2(u[2 * i], u[2 * i + 1]), Vec2(v[2 * i], v[2 * i + 1]));
    }
    double momentum = 0;
    for (const double w : v) momentum += w;
    CHECK(std::abs(momentum) < 1e-12);
    // At the start: each mass of b moves down, each of a up.
    double spin0 = 0;
    for (int i = 0; i < n; ++i) spin0 += .5 * a[i].x() - .5 * b[i].x();
    CHECK(spin == Approx(spin0).epsilon(1e-12));
    CHECK(deepest > .1);
    CHECK(deepest < 1);
    return worst;
  };
  const double coarse = run(.004), fine = run(.002), finest = run(.001);
  CAPTURE(coarse, fine, finest);
  CHECK(coarse < 1e-3);
  CHECK(coarse / fine == Approx(4).epsilon(.1));
  CHECK(fine / finest == Approx(4).epsilon(.1));
}

// Meshes and rigid bodies that fly about: some are near another one, others are near nothing.
TEST_CASE("what bodies that are near nothing leave out changes no bit",
          "[outline_kernel][contact]") {
  ContactLaw law = law_of(1, {.4, .8});
  law.damping = {.3, .3, 0};
  const auto swarm = [&] {
    samples::Random random(19);
    auto bodies = std::make_unique<Bodies>(law, 1e-3);
    for (int i = 0; i < 8; ++i) {
      const Polygon shape = samples::random_convex(random, 5);
      bodies->add_rigid(about_centre(shape), {2.8 * (i % 4), 5.6 * (i / 4), 0}, {1, 1, 2});
    }
    for (int i = 0; i < 8; ++i) {
      std::vector<Vec2> ring = split(samples::random_star_shaped(random, 6, .7).vertices(), 2);
      for (Vec2& v : ring) v += Vec2(2.8 * (i % 4), 2.8 + 5.6 * (i / 4));
      bodies->add_ring(ring, .3);
    }
    bodies->join();
    return bodies;
  };
  const auto bodies = swarm(), searched = swarm();
  samples::Random random(20);
  const double dt = .02;
  size_t least = 16, most = 0;
  int touching = 0;
  for (int step = 0; step < 400; ++step) {
    if (step % 50 == 0) {  // all fly another way; meshes keep their shapes
      for (double& v : bodies->pose_rate) v = random.uniform(-1, 1);
      for (size_t n = 0; n < bodies->node_velocity.size(); n += 24) {
        const double vx = random.uniform(-1, 1), vy = random.uniform(-1, 1);
        for (size_t k = n; k < n + 24; k += 2) {
          bodies->node_velocity[k] = vx, bodies->node_velocity[k + 1] = vy;
        }
      }
    }
    for (size_t i = 0; i < bodies->pose.size(); ++i) bodies->pose[i] += dt * bodies->pose_rate[i];
    for (size_t i = 0; i < bodies->displacement.size(); ++i) {
      bodies->displacement[i] += dt * bodies->node_velocity[i];
    }
    searched->pose = bodies->pose, searched->pose_rate = bodies->pose_rate;
    searched->displacement = bodies->displacement;
    searched->node_velocity = bodies->node_velocity;
    bodies->evaluate();
    searched->contacts->place_all(searched->kinematics());
    searched->contacts->forget_search();  // as Contacts::refresh does
    searched->contacts->search_if_stale();
    searched->contacts->evaluate();
    for (Bodies* b : {bodies.get(), searched.get()}) b->update_friction(dt);

    const size_t active = bodies->contacts->surfaces().outlines().active().size();
    least = std::min(least, active), most = std::max(most, active);
    touching += bodies->contacts->contacts().size() > 0;
    REQUIRE((bodies->node_force == searched->node_force));
    REQUIRE((bodies->rigid_force == searched->rigid_force));
    REQUIRE(bodies->contacts->friction_loss() == searched->contacts->friction_loss());
    REQUIRE(bodies->contacts->damping_loss() == searched->contacts->damping_loss());
  }
  CHECK(least < 12);
  CHECK(most > least);
  CHECK(touching > 100);
  CHECK(bodies->contacts->friction_loss() > 0);
  CHECK(bodies->contacts->damping_loss() > 0);
}
