// The penetration that contacts report: the same for every kernel.
#include <catch2/catch.hpp>

#include "apothem/mesh/rectangle_mesh.hpp"
#include "contact/bodies.hpp"
#include "contact/outline_pairs.hpp"

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
    CHECK(bodies.contacts->largest_penetration().value == Approx(d).epsilon(1e-6));
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
      CHECK(bodies.contacts->largest_penetration().value == Approx(d).epsilon(1e-9));
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
  samples::Random random(1206);
  int found = 0, steeper = 0;
  for (int i = 0; i < scaled(200); ++i) {
    const std::optional<OutlinePair> pair = random_pair(random, 7, .4);
    if (!pair) continue;
    ++found;
    const Contacts& contacts = *pair->contacts;
    double deepest = 0, known = 0;
    for (const ContactRecord& r : contacts.records()) deepest = std::max(deepest, r.penetration);
    for (const Contact& c : contacts.contacts()) {
      known = std::max(known, c.depth);
      CHECK(c.depth <= c.at_most);
    }
    steeper += deepest > known * (1 + 1e-6);
    CHECK(contacts.largest_penetration().value == Approx(deepest).epsilon(1e-6));
  }
  CHECK(found > scaled(200) / 2);
  CHECK(steeper > 0);
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
  const PairPeak deepest = contacts.largest_penetration();
  CHECK(deepest.value == Approx(.04));
  CHECK(deepest.a == 0);
  CHECK(deepest.b == 1);
  CHECK(contacts.largest_penetration(.05).a == -1);
  CHECK(contacts.largest_penetration(.03).value == Approx(.04));
  const std::vector<double> lengths{2, 4, .5};
  const PairPeak relative = contacts.largest_penetration(0, lengths);
  CHECK(relative.value == Approx(.01 / .5));
  CHECK(relative.b == 2);
  CHECK(contacts.largest_penetration(.03, lengths).a == -1);
}
