// The penetration that contacts report: the same for every kernel.
#include <catch2/catch.hpp>

#include "lib/mesh/rectangle_mesh.hpp"
#include "tests/contact/bodies.hpp"
#include "tests/contact/outline_pairs.hpp"

using namespace apothem;
using namespace apothem::test;

namespace {

const Polygon kU({{-1, -1}, {2, -1}, {2, 2}, {1, 2}, {1, 0}, {0, 0}, {0, 2}, {-1, 2}});

enum class Block { rigid, outline, elements };

// A block 1 + 2 d wide in a U that is 1 wide inside, its lower end .5 above the bottom.
Bodies squeezed(Block block, double d) {
  Bodies bodies(block == Block::elements ? element_law(1, ForceDistribution::resultant)
                                         : law_of(1));
  bodies.add_polygon(kU);
  if (block == Block::rigid) {
    bodies.add_polygon(samples::block(-d, .5, 1 + d, 1.5), {1, 1, 1});
  } else {
    bodies.add_mesh(rectangle_mesh({1 + 2 * d, 1}, {4, 5}, {-d, .5}, ElementShape::quadrilateral));
  }
  bodies.join();
  bodies.evaluate();
  bodies.find_forces();
  return bodies;
}

}  // namespace

TEST_CASE("a block squeezed in a U has two patches, each as deep as its overlap",
          "[contact][penetration]") {
  const double d = 1e-4;
  for (const Block block : {Block::rigid, Block::outline, Block::elements}) {
    CAPTURE(static_cast<int>(block));
    const Bodies bodies = squeezed(block, d);
    CHECK(largest_penetration(*bodies.contacts) == Approx(d).epsilon(1e-6));
    const std::vector<ContactRecord> records = bodies.contacts->records();
    REQUIRE(records.size() == 2);
    for (const ContactRecord& record : records) {
      CHECK(record.penetration == Approx(d).epsilon(1e-9));
    }
  }
}

TEST_CASE("a tip on a row of elements is as deep as it is in the body, not in an element",
          "[contact][penetration]") {
  const Polygon tip({{0, 0}, {1, 1}, {-1, 1}});
  const double d = .05;
  for (const bool by_elements : {false, true}) {
    for (const double x : {0., .2, .5}) {  // in the middle of an element, and between two
      CAPTURE(by_elements, x);
      Bodies bodies(by_elements ? element_law(1, ForceDistribution::resultant) : law_of(1));
      bodies.add_polygon(samples::shifted(tip, {x, -d}));
      bodies.add_mesh(rectangle_mesh({9, 1}, {9, 1}, {-4.5, -1}, ElementShape::quadrilateral));
      bodies.join();
      bodies.evaluate();
      CHECK(largest_penetration(*bodies.contacts) == Approx(d).epsilon(1e-9));
      double deepest = 0;
      for (const ContactRecord& r : bodies.contacts->records()) {
        deepest = std::max(deepest, r.penetration);
      }
      CHECK(deepest == Approx(d).epsilon(1e-9));
    }
  }
}

TEST_CASE("the largest penetration of outlines is that of their patches",
          "[contact][penetration]") {
  test::SeededRandom random(1206);
  int found = 0;
  for (int i = 0; i < scaled(200); ++i) {
    const std::optional<OutlinePair> pair = random_pair(random, 7, .4);
    if (!pair) continue;
    ++found;
    const Contacts& contacts = *pair->contacts;
    double deepest = 0, least = 0, most = 0;
    for (const ContactRecord& r : contacts.records()) deepest = std::max(deepest, r.penetration);
    for (const Contact& c : contacts.contacts()) {
      least = std::max(least, c.depth);
      most = std::max(most, c.at_most);
    }
    CHECK(least <= deepest * (1 + 1e-12));
    CHECK(deepest <= most * (1 + 1e-12));
    CHECK(largest_penetration(contacts) == Approx(deepest).epsilon(1e-6));
  }
  CHECK(found > least(scaled(200) / 2));
}

TEST_CASE("a tip in a narrow notch is as far in as it is below the bottom of the notch",
          "[contact][penetration]") {
  const double tangent = std::tan(.3), d = .02;
  const std::vector<Vec2> notched{{-2, -2}, {2, -2},       {2, 1}, {tangent, 1},
                                  {0, 0},   {-tangent, 1}, {-2, 1}};
  const std::vector<Vec2> wedge{{0, -d}, {.1, 1}, {-.1, 1}};
  const OutlinePair meshes(notched, wedge, .3, .05);
  Bodies rigid(law_of(1));
  rigid.add_polygon(Polygon(notched));
  rigid.add_polygon(Polygon(wedge), {1, 1, 1});
  rigid.join();
  rigid.evaluate();
  for (const Contacts* contacts : {meshes.contacts.get(), rigid.contacts.get()}) {
    double known = 0;
    for (const Contact& c : contacts->contacts()) known = std::max(known, c.depth);
    CHECK(known < .4 * d);  // the height of the roof
    CHECK(largest_penetration(*contacts) == Approx(d).epsilon(1e-9));
    double deepest = 0;
    for (const ContactRecord& r : contacts->records()) deepest = std::max(deepest, r.penetration);
    CHECK(deepest == Approx(d).epsilon(1e-9));
  }
}

TEST_CASE("a largest penetration counts above a floor, and relative to lengths of the bodies",
          "[contact][penetration]") {
  // Two blocks on a floor: one large and deep, one small and less deep.
  Bodies bodies(law_of(1));
  bodies.add_polygon(samples::block(-9, -4, 9, 0));
  bodies.add_polygon(samples::block(-8, -.04, 0, 8), {1, 1, 1});
  bodies.add_polygon(samples::block(1, -.01, 2, 1), {1, 1, 1});
  bodies.join();
  bodies.evaluate();
  const Contacts& contacts = *bodies.contacts;
  const std::vector<double> lengths{2, 4, .25};
  const Penetrations found = contacts.penetrations(lengths);
  CHECK(found.largest.value == Approx(.04));
  CHECK(found.largest.a == 0);
  CHECK(found.largest.b == 1);
  CHECK(found.relative.value == Approx(.01 / .25));
  CHECK(found.relative.b == 2);
  const Penetrations above = contacts.penetrations(lengths, {{.05}, {.03}});
  CHECK(above.largest.value == .05);
  CHECK(above.largest.a == -1);
  CHECK(above.relative.b == 2);
  CHECK(contacts.penetrations(lengths, {{.03}, {.05}}).relative.a == -1);
}
