// A body that touches itself: energy against the definition of the depth at points, forces against
// the energy, momenta, outlines that do not, and the record of a contact.
#include <algorithm>
#include <catch2/catch.hpp>

#include "lib/mesh/fill_mesh.hpp"
#include "lib/mesh/rectangle_mesh.hpp"
#include "tests/contact/depth_fields.hpp"
#include "tests/contact/outline_pairs.hpp"

using namespace apothem;
using namespace apothem::test;

namespace {

ContactLaw self_law(const Friction& friction = {}) {
  ContactLaw law = law_of(1, friction);
  law.self = true;
  return law;
}

// One body that was simple once and is anywhere now.
struct Folded : Bodies {
  std::vector<Vec2> ring;

  Folded(const std::vector<Vec2>& simple, std::vector<Vec2> now, double reference)
      : Bodies(self_law(), .05), ring(std::move(now)) {
    add_ring(simple, reference);
    join();
    for (size_t i = 0; i < ring.size(); ++i) {
      displacement[2 * i] = ring[i].x() - simple[i].x();
      displacement[2 * i + 1] = ring[i].y() - simple[i].y();
      // The very places that the kernel sees.
      ring[i] = {simple[i].x() + displacement[2 * i], simple[i].y() + displacement[2 * i + 1]};
    }
    evaluate();
    find_forces();
  }
  [[nodiscard]] double depth() const { return contacts->surfaces().outlines().bodies[0].depth; }
  [[nodiscard]] double largest_force() const {
    double largest = 0;
    for (const double f : node_force) largest = std::max(largest, std::abs(f));
    return largest;
  }
};

double r_of(samples::Random& random) { return random.uniform(.02, .6); }

// Edges that all but turn back have bisectors that reach far away.
bool has_spikes(const std::vector<Vec2>& ring) {
  const size_t n = ring.size();
  for (size_t i = 0; i < n; ++i) {
    const Vec2 before = ring[i] - ring[(i + n - 1) % n], after = ring[(i + 1) % n] - ring[i];
    if (before.normalized().dot(after.normalized()) < -.98) return true;
  }
  return false;
}

Folded random_folded(samples::Random& random, double& reference) {
  const int n = random.integer(4, 12);
  const std::vector<Vec2> simple = samples::random_star_shaped(random, n, .5).vertices();
  const double by = random.integer(0, 1) == 0 ? .2 : 1;
  std::vector<Vec2> now;
  do {
    now = simple;
    for (Vec2& v : now) v += Vec2(random.uniform(-by, by), random.uniform(-by, by));
  } while (has_spikes(now));
  reference = r_of(random);
  return {simple, now, reference};
}

}  // namespace

TEST_CASE("a folded body: the energy is that of the depth where it lies twice",
          "[self_contact][contact]") {
  test::SeededRandom random(41);
  double worst = 0;
  int touch = 0;
  for (int i = 0; i < scaled(400); ++i) {
    double reference = 0;
    const Folded body = random_folded(random, reference);
    const double exact = by_points(body.ring, body.ring, body.depth(), true) / reference;
    const double energy = body.contacts->energy();
    worst = std::max(worst, std::abs(energy - exact) / std::max(1e-3, std::abs(exact)));
    touch += std::abs(exact) > 1e-6;
  }
  CAPTURE(worst, touch);
  CHECK(touch > least(scaled(200)));
  CHECK(worst < 1e-10);
}

TEST_CASE("a folded body: nodal forces are the gradient of the energy, and momenta balance",
          "[self_contact][contact]") {
  using Complex = std::complex<double>;
  samples::Random random(42);  // the same cases always: the bound is a measured one
  // The collar of a body with a sharp inner corner is thin, its forces are small, and their
  // round-off is larger relative to them.
  double worst = 0, worst_thin = 0, balance = 0;
  int touch = 0, deep = 0;
  for (int i = 0; i < scaled(400); ++i) {
    double reference = 0;
    const Folded body = random_folded(random, reference);
    const double size = body.largest_force();
    if (!(size > 1e-9)) continue;
    ++touch;
    deep += largest_relative_depth(*body.contacts) > 1;
    const bool thin = !body.contacts->surfaces().outlines().shallow.empty();
    double& largest = thin ? worst_thin : worst;
    NumberRing<Complex> ring(body.ring);
    size_t k = 0;
    for (size_t j = 0; j < ring.size(); ++j) {
      for (Complex* z : {&ring.x[j], &ring.y[j]}) {
        z->imag(1e-40);
        const Complex energy = closed_form(ring, ring, body.depth(), true) / reference;
        largest = std::max(largest, std::abs(energy.imag() / 1e-40 + body.node_force[k++]) / size);
        z->imag(0);
      }
    }
    Resultant sum;
    for (NodeIndex n = 0; n < body.nodes; ++n) {
      sum.force += body.on_node(n);
      sum.moment += cross(body.ring[n], body.on_node(n));
    }
    balance = std::max({balance, sum.force.norm() / size, std::abs(sum.moment) / size});
  }
  CAPTURE(worst, worst_thin, balance, touch, deep);
  CHECK(touch > least(scaled(200)));
  CHECK(deep > least(scaled(50)));
  CHECK(worst < 1e-11);
  CHECK(worst_thin < 1e-10);
  CHECK(balance < 1e-11);
}

TEST_CASE("a strip folded flat on itself feels what two strips feel", "[self_contact][contact]") {
  // A hairpin: two legs of the width 1, whose gap closes until they overlap by d.
  const auto hairpin = [](double gap) {
    return std::vector<Vec2>{{0, -1},  {6, -1},  {6, 0},       {1, 0},
                             {1, gap}, {6, gap}, {6, 1 + gap}, {0, 1 + gap}};
  };
  for (const double d : {.05, .2, .6}) {
    const Folded body(hairpin(.5), hairpin(-d), .25);
    CAPTURE(d);
    const double h = std::min(d, .25), beyond = std::max(0., d - .25);
    // Both surfaces, over the length 5; the end of the gap lies in the bulk and feels nothing, but
    // the bisectors of its corners lean.
    const double pressure = 2 * h / .25;
    const std::vector<ContactRecord> records = body.contacts->records();
    REQUIRE(records.size() == 1);
    CHECK(records[0].a == 0);
    CHECK(records[0].b == 0);
    CHECK(records[0].normal.norm() == Approx(5 * pressure).epsilon(.15));
    CHECK(std::abs(records[0].normal.x()) < .15 * records[0].normal.norm());
    // Beyond the middle of a leg its other side is nearer.
    CHECK(records[0].penetration == Approx(std::min(d, .4)).epsilon(1e-9));
    CHECK(records[0].point.y() == Approx(-d / 2).margin(.05 + beyond));
    const std::vector<SurfaceRecord> surfaces = body.contacts->surface_records();
    CHECK(surfaces[2].pressure == Approx(pressure).epsilon(.15));
    CHECK(surfaces[4].pressure == Approx(pressure).epsilon(.15));
    CHECK(surfaces[0].pressure == Approx(0).margin(1e-12));
  }
}

TEST_CASE("the collar stays in the body at sharp inner corners", "[self_contact][contact]") {
  test::SeededRandom random(61);
  for (int i = 0; i < scaled(40); ++i) {
    const double angle = random.uniform(1, 80) * M_PI / 180, deep = random.uniform(.2, .5);
    const double wide = deep * std::tan(angle / 2), at = random.uniform(.3, .7);
    if (wide > .25) continue;
    const Polygon notched(
        {{0, 0}, {1, 0}, {1, .6}, {at + wide, .6}, {at, .6 - deep}, {at - wide, .6}, {0, .6}});
    const Mesh mesh = fill_mesh(notched, {}, random.uniform(.05, .2), ElementShape::triangle);
    Bodies body(self_law(), .05);
    body.add_mesh(mesh);
    body.join();
    body.evaluate();
    CAPTURE(angle, deep, at);
    CHECK(body.contacts->contacts().empty());
    CHECK(body.contacts->energy() == Approx(0).margin(1e-15));
    // Nor does it leave the body when the corner has closed to half its angle, which is at most
    // what the opposite side allows.
    const OutlineSurfaces& outlines = body.contacts->surfaces().outlines();
    const double height = (.6 - deep) * std::sin(angle / 2);
    CHECK(outlines.bodies[0].depth <= height / 2 * (1 + 1e-12));
    for (const auto& [of, corner] : outlines.shallow) {
      CHECK(outlines.bodies[of].depth == corner.height / 2);
      CHECK(corner.height == Approx(height).epsilon(1e-9));
      CHECK(corner.angle == Approx(angle).epsilon(1e-9));
      CHECK((corner.place - Vec2(at, .6 - deep)).norm() < 1e-12);
    }
  }
}

TEST_CASE("meshes that do not cross themselves feel nothing", "[self_contact][contact]") {
  test::SeededRandom random(43);
  int bodies = 0;
  const auto check = [&](const Mesh& mesh) {
    Bodies body(self_law(), .05);
    body.add_mesh(mesh);
    body.join();
    body.evaluate();
    CAPTURE(bodies++);
    CHECK(body.contacts->contacts().empty());
    CHECK(body.contacts->energy() == Approx(0).margin(1e-15));
  };
  for (int i = 0; i < scaled(30); ++i) {
    const Polygon star = samples::random_star_shaped(random, random.integer(4, 30), .4);
    for (const ElementShape shape : {ElementShape::triangle, ElementShape::quadrilateral}) {
      check(fill_mesh(star, {}, .1, shape));
    }
  }
  // One element thick, a slot, a frame with a hole.
  check(rectangle_mesh({1, .02}, {50, 1}, {0, 0}, ElementShape::quadrilateral));
  check(fill_mesh(Polygon({{0, 0}, {1, 0}, {1, .49}, {.3, .49}, {.3, .5}, {1, .5}, {1, 1}, {0, 1}}),
                  {}, .1, ElementShape::triangle));
  check(fill_mesh(samples::block(0, 0, 1, 1), {samples::block(.1, .1, .9, .9)}, .1,
                  ElementShape::triangle));
}

TEST_CASE("without self contact a folded body feels nothing", "[self_contact][contact]") {
  Bodies bodies(law_of(1), .05);
  bodies.add_ring({{0, 0}, {3, 0}, {3, 3}, {2, 3}, {2, 1}, {1, 1}, {1, 3}, {0, 3}}, .3);
  bodies.join();
  bodies.displacement[4] = bodies.displacement[6] = -1.2;
  bodies.evaluate();
  CHECK(bodies.contacts->contacts().empty());
  CHECK(bodies.contacts->candidates() == 0);
}

TEST_CASE("the normal stiffness of a pair of materials is that of outlines as well",
          "[self_contact][contact]") {
  ContactLaw law = law_of(2);
  ContactRule rule{{ContactRule::Party{false, 0}, ContactRule::Party{false, 1}}};
  rule.normal_stiffness = 6;
  law.rules = {rule};
  const std::vector<Vec2> a = samples::block(0, 0, 1, 1).vertices();
  std::vector<Vec2> b = a;
  for (Vec2& v : b) v += Vec2(.3, .95);
  for (const double deeper : {0., .3}) {
    std::vector<Vec2> at = b;
    for (Vec2& v : at) v.y() -= deeper;
    const OutlinePair same(a, at, .2, .2, law, {0, 0});
    const OutlinePair different(a, at, .2, .2, law, {0, 1});
    CHECK(same.largest_force() > .1);
    CHECK(different.contacts->energy() == Approx(3 * same.contacts->energy()).epsilon(1e-14));
    for (size_t i = 0; i < same.node_force.size(); ++i) {
      CHECK(different.node_force[i] == Approx(3 * same.node_force[i]).margin(1e-12));
    }
    CHECK(different.contacts->records()[0].normal.y() ==
          Approx(3 * same.contacts->records()[0].normal.y()));
  }
}

TEST_CASE("an inner corner whose collar leaves the body is named", "[self_contact][contact]") {
  const auto slit = [](double half_breadth, double thickness) {
    return std::vector<Vec2>{{0, 0},
                             {2, 0},
                             {2, thickness + .7},
                             {1 + half_breadth, thickness + .7},
                             {1, thickness},
                             {1 - half_breadth, thickness + .7},
                             {0, thickness + .7}};
  };
  const auto notch = [&](double half_breadth, double thickness) {
    const Folded body(slit(.4, thickness), slit(half_breadth, thickness), .1);
    return body.contacts->surfaces().outlines().closed_notch();
  };
  // The collar is .1 deep and reaches .1 / sin of half the angle.
  CHECK_FALSE(notch(.4, .3));
  CHECK_FALSE(notch(.3, .3));
  CHECK_FALSE(notch(.05, 3));
  const std::optional<OutlineSurfaces::Notch> closed = notch(.05, .3);
  REQUIRE(closed);
  CHECK(closed->vertex == 4);
  CHECK(closed->angle == Approx(2 * std::atan(.05 / .7)));
}
