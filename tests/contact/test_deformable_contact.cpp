// Outlines of meshes and polygons in contact: candidates, limits, threads, energy in motion.
#include <catch2/catch.hpp>
#include <set>

#include "apothem/geometry/skeleton/skeleton.hpp"
#include "apothem/mesh/rectangle_mesh.hpp"
#include "contact/outline_pairs.hpp"

using namespace apothem;
using namespace apothem::test;

namespace {

std::set<std::pair<int, int>> touching(const DeformableContact& contact) {
  std::set<std::pair<int, int>> pairs;
  for (const EdgeFaceContact& c : contact.contacts()) pairs.emplace(c.edge, c.face);
  return pairs;
}

// Every edge against every face of other bodies.
std::set<std::pair<int, int>> touching_of_all(const DeformableContact& contact) {
  const Outlines& o = contact.outlines();
  std::set<std::pair<int, int>> pairs;
  for (int e = 0; e < o.size(); ++e) {
    for (int f = 0; f < o.size(); ++f) {
      const bool rigid = o.bodies[o.body[e]].rigid() && o.bodies[o.body[f]].rigid();
      if (o.body[e] == o.body[f] || rigid) continue;
      CollarPiece<double> piece;
      const int q = o.next[e];
      if (collar_piece(o.face(f), o.x[e], o.y[e], o.x[q], o.y[q], piece) && piece.deepest > 0)
        pairs.emplace(e, f);
    }
  }
  return pairs;
}

}  // namespace

TEST_CASE("candidates miss no contact while bodies move and deform", "[deformable_contact]") {
  samples::Random random(21);
  DeformableContact contact(1, 1, .1, 1);
  std::vector<Vec2> velocity;
  int nodes = 0;
  const int bodies = 12;
  for (int i = 0; i < bodies; ++i) {
    const std::vector<Vec2> ring =
        samples::shifted(samples::random_star_shaped(random, 8, .6), {1.9 * (i % 4), 1.9 * (i / 4)})
            .vertices();
    add_ring(contact, ring, nodes, .3);
    nodes += static_cast<int>(ring.size());
    velocity.emplace_back(random.uniform(-.002, .002), random.uniform(-.002, .002));
  }
  contact.add_rigid(samples::block(-9, -.5, 9, .5).vertices(), 0, .5);
  contact.add_rigid(samples::block(-9, -.5, 9, .5).vertices(), 1, .5);
  std::vector<double> u(2 * static_cast<size_t>(nodes));
  int found = 0;
  const int steps = scaled(300);
  for (int step = 0; step < steps; ++step) {
    for (int i = 0; i < nodes; ++i) {
      u[2 * i] += velocity[i / 8].x() + random.uniform(-1e-4, 1e-4);
      u[2 * i + 1] += velocity[i / 8].y() + random.uniform(-1e-4, 1e-4);
    }
    const double t = .002 * step;
    contact.update(u, std::vector<double>{2, -1.4 + t, .1 * t, 3, -1.2, -t});
    contact.evaluate();
    const auto all = touching_of_all(contact);
    CHECK(touching(contact) == all);
    found += static_cast<int>(all.size());
  }
  CHECK(found > steps);
  CHECK(contact.searches() < std::max(2, steps / 2));
}

TEST_CASE("bodies that meet, part and meet again feel what they would at first sight",
          "[deformable_contact]") {
  const std::vector<Vec2> ring = split(samples::block(0, 0, 1, 1).vertices(), 5);
  const auto pair = [&] {
    DeformableContact contact(1, 1, .05, 1);
    add_ring(contact, ring, 0, .3);
    add_ring(contact, ring, static_cast<int>(ring.size()), .3);
    return contact;
  };
  DeformableContact contact = pair();
  std::vector<double> u(4 * ring.size());
  int touched = 0, apart = 0;
  for (int step = 0; step < 2000; ++step) {
    // The second body goes round the first one; its corners swing as well.
    const double t = .003 * step;
    for (size_t i = 0; i < ring.size(); ++i) {
      const Vec2 x = samples::turned(ring[i], .3 * std::sin(3 * t));
      const size_t c = 2 * (ring.size() + i);
      u[c] = x.x() - ring[i].x() + (1.35 + .3 * std::cos(2.3 * t)) * std::cos(t);
      u[c + 1] = x.y() - ring[i].y() + (1.35 + .3 * std::cos(2.3 * t)) * std::sin(t);
    }
    contact.update(u, {});
    contact.evaluate();
    std::vector<double> f(u.size()), expected(u.size());
    contact.add_forces(f);
    DeformableContact fresh = pair();
    fresh.update(u, {});
    fresh.evaluate();
    fresh.add_forces(expected);
    // Where a collar ends is measured at a search.
    if (std::max(contact.depth().ratio, fresh.depth().ratio) > .5) continue;
    REQUIRE(touching(contact) == touching(fresh));
    REQUIRE(contact.energy() == fresh.energy());
    REQUIRE((f == expected));
    (touching(fresh).empty() ? apart : touched)++;
  }
  CHECK(touched > 200);
  CHECK(apart > 200);
  CHECK(contact.searches() < 1000);
}

TEST_CASE("a rigid body feels what its polygon feels", "[deformable_contact]") {
  samples::Random random(22);
  double worst = 0;
  int pairs = 0;
  const int wanted = scaled(300);
  while (pairs < wanted) {
    const Polygon a = samples::random_convex(random, random.integer(3, 9));
    const Polygon b = samples::random_convex(random, random.integer(3, 9));
    const Potential potential_a = make_potential(a), potential_b = make_potential(b);
    const Vec2 offset(random.uniform(-2, 2), random.uniform(-2, 2));
    const double angle = random.uniform(-3, 3);
    const Polygon moved = samples::mapped(
        a, [&](const Vec2& v) -> Vec2 { return samples::turned(v, angle) + offset; });
    DeformableContact contact(1, 1, .1, 1);
    const double r_a = inscribed_circle(a).radius, r_b = inscribed_circle(b).radius;
    contact.add_rigid(a.vertices(), 0, r_a);
    add_ring(contact, b.vertices(), 0, r_b);
    contact.update(std::vector<double>(2 * b.vertices().size()),
                   std::vector<double>{offset.x(), offset.y(), angle});
    contact.evaluate();
    if (!(contact.depth().ratio > .02) || contact.depth().ratio > .98) continue;
    ++pairs;
    const PairResult edge = edge_method(moved, make_potential(moved), b, potential_b);
    const auto on_a = contact.resultant(0);
    worst = std::max(worst, (on_a.force - edge.integral.force).norm() / edge.integral.weight);
    const Vec2 arm = samples::world_centroid(moved) - offset;
    const double moment = edge.integral.moment_a + cross(arm, edge.integral.force);
    worst = std::max(worst, std::abs(on_a.moment - moment) / edge.integral.weight);
    worst = std::max(worst, std::abs(contact.energy() - edge.volume.energy) / edge.volume.energy);
    const double stiffness = edge.integral.own_length_a / r_b + edge.integral.own_length_b / r_a;
    CHECK(contact.stiffness(0) == Approx(stiffness).epsilon(1e-10));
    const std::vector<BodyContact> record = contact.body_contacts();
    REQUIRE(record.size() == 1);
    worst = std::max(worst, (record[0].force - on_a.force).norm() / edge.integral.weight);
  }
  CAPTURE(worst);
  CHECK(worst < 1e-12);
}

TEST_CASE("swapping the bodies changes round-off only", "[deformable_contact]") {
  samples::Random random(23);
  for (int i = 0; i < scaled(300); ++i) {
    const auto pair = random_pair(random, 8, .5);
    if (!pair) continue;
    const OutlinePair swapped(pair->b, pair->a, pair->reference_b, pair->reference_a);
    const double size = pair->largest_force();
    const size_t n = 2 * pair->a.size(), m = 2 * pair->b.size();
    for (size_t k = 0; k < n; ++k)
      CHECK(std::abs(pair->force[k] - swapped.force[m + k]) < 1e-14 * size);
    CHECK(pair->contact.energy() == Approx(swapped.contact.energy()).epsilon(1e-14));
  }
}

TEST_CASE("outlines of meshes: nodes, holes, references", "[deformable_contact]") {
  const Mesh mesh = rectangle_mesh({2, 1}, {4, 4}, {0, 0}, ElementShape::quadrilateral);
  const Boundary outline = boundary(mesh);
  CHECK(boundary_inradius(mesh, outline) == Approx(.125));
  DeformableContact contact(2, .5, .01, 1);
  contact.add_deformable(mesh, outline, 3);
  // 1 mm into the top.
  contact.add_rigid({{0, 0}, {.2, 1}, {-.2, 1}}, 0, .15);
  std::vector<double> u(2 * (mesh.nodes.size() + 3)), f(u.size());
  contact.update(u, std::vector<double>{1.1, .999, 0});
  contact.evaluate();
  contact.add_forces(f);
  CHECK(f[0] == 0);
  double down = 0;
  for (size_t i = 1; i < f.size(); i += 2) {
    down += f[i];
    if (f[i] != 0) CHECK(mesh.nodes[i / 2 - 3].y() == 1);
  }
  const auto on_tip = contact.resultant(1);
  CHECK(down == Approx(-on_tip.force.y()).epsilon(1e-12));
  const double slope = .2, d = .001;  // apex on flat
  const double expected = 2 * .5 * d * d * slope * (1 / .125 + std::sin(std::atan(slope)) / .15);
  CHECK(on_tip.force.y() == Approx(expected).epsilon(1e-10));
  CHECK(contact.depth().ratio == Approx(d / contact.depth().limit).epsilon(1e-9));

  // A corner node carries half of two edges.
  std::vector<double> mass(mesh.nodes.size() + 3, 1e9);
  mass[3] = 7;
  const auto rate = contact.rate(mass);
  CHECK(rate.value == Approx(2 * 2 * .5 * (1 / .125 + 1 / .15) * .375 / 7));
  CHECK(rate.body == 0);
}

TEST_CASE("the collar ends where fronts meet", "[deformable_contact]") {
  // Half of a bar's thickness, however fine its edges; and its inradius where that is less.
  for (const int parts : {1, 3}) {
    DeformableContact contact(1, 1, .01, 1);
    add_ring(contact, split(samples::block(0, 0, 4, .5).vertices(), parts), 0, 10);
    contact.update(std::vector<double>(100), {});
    for (int i = 0; i < contact.outlines().size(); ++i) {
      const double h = contact.outlines().depth[i];
      CHECK(h <= .25 + 1e-15);
      if (parts == 1) CHECK(h == Approx(.25));
    }
  }
  // Where CGAL's skeleton has its first node over an edge, the collar has ended.
  samples::Random random(24);
  for (int i = 0; i < scaled(200); ++i) {
    const Polygon polygon = samples::random_star_shaped(random, random.integer(4, 12), .5);
    Skeleton skeleton;
    try {
      skeleton = straight_skeleton(polygon);
    } catch (const SkeletonFailure&) {
      continue;
    }
    DeformableContact contact(1, 1, .01, 1);
    add_ring(contact, polygon.vertices(), 0, 10);
    contact.update(std::vector<double>(2 * static_cast<size_t>(polygon.size())), {});
    for (int e = 0; e < polygon.size(); ++e) {
      double first = 10;
      for (const int node : skeleton.faces[e]) {
        if (node >= polygon.size()) first = std::min(first, skeleton.nodes[node].height);
      }
      CAPTURE(i, e);
      CHECK(contact.outlines().depth[e] <= first * (1 + 1e-9));
    }
  }
}

TEST_CASE("a body pushed through the collar is noticed", "[deformable_contact]") {
  const std::vector<Vec2> bar = split(samples::block(-2, -.5, 2, 0).vertices(), 8);
  for (const double d : {.1, .24, .26, .4, .49, .51, .8}) {
    const OutlinePair pair(bar, {{.05, -d}, {1.05, 1 - d}, {-.95, 1 - d}}, .25, .4);
    CAPTURE(d);
    CHECK((pair.contact.depth().ratio < 1) == (d < .25));
    if (d < .25) CHECK(pair.contact.depth().ratio == Approx(d / .25));
  }
}

TEST_CASE("a body that has swallowed the end of a collar is noticed", "[deformable_contact]") {
  const std::vector<Vec2> block = samples::block(-2, -4, 2, 0).vertices();
  // The top of the triangle's collar is at (0, y + 1).
  for (const double y : {-.3, -.8, -.95, -1.05, -1.2, -1.4}) {
    const OutlinePair pair(block, {{0, y}, {.866, y + 1.5}, {-.866, y + 1.5}}, 2, 1);
    CAPTURE(y);
    CHECK((pair.contact.depth().ratio < 1) == (y > -1));
  }
}

TEST_CASE("edges of one body that cross are noticed", "[deformable_contact]") {
  // A horseshoe whose right arm is bent into the left one.
  const std::vector<Vec2> ring{{0, 0}, {3, 0}, {3, 3}, {2, 3}, {2, 1}, {1, 1}, {1, 3}, {0, 3}};
  DeformableContact contact(1, 1, .01, 1);
  add_ring(contact, ring, 0, .3);
  std::vector<double> u(16);
  contact.update(u, {});
  CHECK_FALSE(contact.self_contact());
  u[4] = u[6] = -1.2;  // both upper nodes of the right arm
  contact.update(u, {});
  REQUIRE(contact.self_contact());
  CHECK(contact.self_contact()->body == 0);
  CHECK(contact.self_contact()->place.x() == Approx(1).margin(.2));
}

TEST_CASE("a vertex that is nowhere is an error", "[deformable_contact]") {
  DeformableContact contact(1, 1, .01, 1);
  add_ring(contact, samples::block(0, 0, 1, 1).vertices(), 0, .5);
  std::vector<double> u(8);
  u[3] = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_AS(contact.update(u, {}), std::domain_error);
}

TEST_CASE("deformable contact has the same bits for any number of threads",
          "[deformable_contact]") {
  const Mesh lower = rectangle_mesh({40, .1}, {4000, 10}, {0, 0}, ElementShape::quadrilateral);
  const Mesh upper = rectangle_mesh({39, .1}, {3700, 10}, {.5, .097}, ElementShape::quadrilateral);
  const int first = static_cast<int>(lower.nodes.size());
  std::vector<double> u(2 * (lower.nodes.size() + upper.nodes.size()));
  for (size_t i = 0; i < u.size(); ++i) u[i] = 1e-4 * std::sin(static_cast<double>(i));
  std::vector<double> before;
  for (const int threads : {1, 2, 3}) {
    DeformableContact contact(1, 1, .002, threads);
    contact.add_deformable(lower, boundary(lower), 0);
    contact.add_deformable(upper, boundary(upper), first);
    contact.update(u, {});
    contact.evaluate();
    CHECK(contact.candidates().size() > 10000);
    std::vector<double> f(u.size());
    contact.add_forces(f);
    if (threads > 1) CHECK(f == before);
    before = f;
  }
}

// Point masses on springs between all of a body, in a few Verlet steps.
TEST_CASE("energy of a bounce of two soft bodies converges with the step squared",
          "[deformable_contact]") {
  const std::vector<Vec2> a = split(samples::block(-.5, -.5, .5, .5).vertices(), 2);
  std::vector<Vec2> b = a;
  for (Vec2& v : b) v = samples::turned(v, .5) + Vec2(.2, 1.3);
  const int n = static_cast<int>(a.size());
  std::vector<Vec2> x0 = a;
  x0.insert(x0.end(), b.begin(), b.end());
  const double spring = 40, stiffness = 30;
  const auto run = [&](double dt) {
    OutlinePair pair(a, b, .25, .25, stiffness);
    std::vector<double>& u = pair.displacement;
    std::vector<double> v(u.size());
    for (int i = 0; i < n; ++i) v[2 * i + 1] = .5, v[2 * (n + i) + 1] = -.5;
    std::vector<double> f(u.size());
    double springs = 0;
    const auto forces = [&] {
      pair.evaluate();
      f = pair.force;
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
      double energy = springs + pair.contact.energy();
      for (const double w : v) energy += w * w / 2;
      if (start < 0) start = energy;
      worst = std::max(worst, std::abs(energy - start) / start);
      deepest = std::max(deepest, pair.contact.depth().ratio);
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
