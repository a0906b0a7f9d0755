// Polygons on a slope, rigid or meshed, in static runs: below the friction angle they stand, above
// it they are refused because they slide.
#include <fmt/format.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "tests/run/scenes.hpp"

using namespace apothem;
using namespace apothem::test;

namespace static_slopes {
namespace {

using Points = std::vector<Vec2>;

Vec2 centre_of(const Points& ring) {
  double area = 0;
  Vec2 sum = Vec2::Zero();
  for (size_t i = 0; i < ring.size(); ++i) {
    const Vec2 &a = ring[i], &b = ring[(i + 1) % ring.size()];
    const double part = cross(a, b);
    area += part, sum += part * (a + b);
  }
  return sum / (3 * area);
}

// A convex polygon with its base on y = 0, of about 1 m, that does not topple where the floor is
// turned by the angle. Its vertices lie on an ellipse.
Points polygon(SeededRandom& random, double angle) {
  for (;;) {
    const int corners = random.integer(3, 9);
    const double wide = random.uniform(.4, .6), high = random.uniform(.2, .5);
    const double low = random.uniform(.2, .7);  // of the base, rad below the middle
    std::vector<double> at{-low, std::numbers::pi + low};
    while (std::ssize(at) < corners) at.push_back(random.uniform(-low, std::numbers::pi + low));
    std::ranges::sort(at);
    Points ring;
    for (const double t : at) {
      ring.emplace_back(wide * std::cos(t), high * (std::sin(t) + std::sin(low)));
    }
    double shortest = HUGE_VAL;
    for (size_t i = 0; i < ring.size(); ++i) {
      shortest = std::min(shortest, (ring[i] - ring[(i + 1) % ring.size()]).norm());
    }
    const double half = wide * std::cos(low);
    const Vec2 centre = centre_of(ring);
    const double foot = centre.x() - centre.y() * std::tan(angle);
    if (shortest > .12 && std::abs(foot) < .7 * half) return ring;
  }
}

std::string text_of(const Points& ring, double angle, bool meshed, double size) {
  std::string text;
  for (const Vec2& p : ring) {
    text += fmt::format("{}[{}, {}]", text.empty() ? "" : ", ",
                        std::cos(angle) * p.x() - std::sin(angle) * p.y(),
                        std::sin(angle) * p.x() + std::cos(angle) * p.y());
  }
  return meshed
             ? fmt::format(R"("mesh": {{ "fill": {{ "polygon": [{}], "size": {} }} }})", text, size)
             : fmt::format(R"("polygon": [{}])", text);
}

struct Member {
  double friction, angle;
  bool body_meshed, slope_meshed;
  std::string text;
};

Member member(SeededRandom& random, bool stands) {
  Member m;
  m.friction = random.uniform(.2, 1);
  m.angle = std::atan(m.friction) * (stands ? random.uniform(0, .97) : random.uniform(1.03, 1.3));
  m.body_meshed = random.integer(0, 2) > 0, m.slope_meshed = random.integer(0, 1) > 0;
  const double young = std::pow(10, random.uniform(6.5, 10));
  const Points ring = polygon(random, m.angle);
  const Points slope{{-2, -.3}, {2, -.3}, {2, 0}, {-2, 0}};
  m.text = fmt::format(
      R"({{ "gravity": {{ "value": [0, -9.81], "history": [[0, 0], [1, 1]] }},
      "materials": {{ "m": {{ "density": 2000, "young": {}, "poisson": {}, "law": "{}", "plane": "strain" }},
                      "s": {{ "density": 2000, "young": {}, "poisson": 0.2, "plane": "strain" }} }},
      "contact": {{ "normal_stiffness": {}, "friction": {{ "coefficient": {} }} }},
      "bodies": [ {{ "name": "slope", "material": "s", {}, {} }}, {{ "name": "body", "material": "m", {} }} ],
      "time": {{ "end": 1, "mode": "static", "load_steps": {} }} }})",
      young, random.uniform(.1, .45),
      random.integer(0, 1) > 0 ? "neo_hookean" : "st_venant_kirchhoff", 10 * young,
      std::pow(10, random.uniform(7, 10)), m.friction,
      text_of(slope, m.angle, m.slope_meshed, random.uniform(.15, .3)),
      m.slope_meshed ? R"("supports": [ { "where": { "group": "edge-0" }, "fix": ["x", "y"] } ])"
                     : R"("motion": "fixed")",
      text_of(ring, m.angle, m.body_meshed, random.uniform(.08, .2)), random.integer(1, 3));
  return m;
}

// The force of the slope on the body, along it and across, as the records of the contacts say, N.
Vec2 force_on_body(const Run& run, const Member& m) {
  BodyIndex body = -1;
  const Model& model = run.scene().model;
  for (BodyIndex b = 0; b < 2; ++b) body = model.name_of(b) == "body" ? b : body;
  Vec2 sum = Vec2::Zero();
  for (const ContactRecord& c : run.simulation().contacts()) {
    sum += (c.a == body ? 1 : -1) * (c.normal + c.tangential);
  }
  const Vec2 along(std::cos(m.angle), std::sin(m.angle));
  return {sum.dot(along), cross(along, sum)};
}

double weight_of(const Run& run) {
  const Model& model = run.scene().model;
  for (const RigidBody& body : model.bodies) {
    if (body.name == "body") return 9.81 * body.mass;
  }
  for (const DeformableBody& body : model.deformables) {
    if (body.name != "body") continue;
    double mass = 0;
    for (size_t i = 0; i < body.mesh.nodes.size(); ++i) {
      mass += run.simulation().node_mass()[static_cast<size_t>(body.first_node) + i];
    }
    return 9.81 * mass;
  }
  return 0;
}

}  // namespace
}  // namespace static_slopes

TEST_CASE("a polygon stands on a slope below the friction angle, and slides above it",
          "[static][friction]") {
  using namespace static_slopes;
  SeededRandom random(44);
  const int cases = long_run() ? 160 : scaled(64);
  int relaxed = 0;  // members for which Newton's method finds nothing
  for (int i = 0; i < cases; ++i) {
    const bool stands = i % 2 == 0;
    const Member m = member(random, stands);
    CAPTURE(i, m.friction, m.angle, m.text);
    const Folder folder;
    Run run(scene_of(folder, m.text), {});
    const Run::Status status = run.run();
    INFO(run.message());
    if (!stands) {
      CHECK(status == Run::Status::unstable);
      CHECK_THAT(run.message(),
                 Catch::Contains("\"body\" slides on \"slope\", with friction at its limit"));
      continue;
    }
    CHECK(status == Run::Status::done);
    if (status != Run::Status::done) continue;
    relaxed += std::ranges::any_of(run.load_steps(), &LoadStep::relaxed);
    const double weight = weight_of(run);
    const Vec2 force = force_on_body(run, m);
    CHECK(force.x() == Approx(weight * std::sin(m.angle)).margin(1e-6 * weight));
    CHECK(force.y() == Approx(weight * std::cos(m.angle)).margin(1e-6 * weight));
  }
  CHECK(relaxed <= 1 + cases / 20);
}
