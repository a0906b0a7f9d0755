// The memory of friction: springs by key, what is inherited, what is lost, the ledger.
#include <catch2/catch.hpp>

#include "lib/contact/law/contact.hpp"
#include "lib/contact/law/coulomb_spring.hpp"
#include "lib/contact/law/friction_memory.hpp"
#include "lib/run/json_archive.hpp"
#include "tests/support.hpp"

using namespace apothem;

namespace {

Spring spring(const ContactKey& key, double force, double stiffness = 2) {
  return {key, force, stiffness, {0, 1}};
}

// Springs of three pairs: two parts of the first one, one of the others.
const std::vector<Spring> kThreePairs{
    spring({polygon_kernel, 0, 3, 0}, 1), spring({polygon_kernel, 0, 3, 1}, -2),
    spring({polygon_kernel, 1, 2, 0}, 3), spring({outline_kernel, 1, 2, 0}, -4)};

FrictionMemory with(const std::vector<Spring>& springs) {
  FrictionMemory memory;
  memory.begin_step();
  for (const Spring& s : springs) memory.keep(s);
  memory.end_step(0);
  return memory;
}

bool same(const Spring& s, const Spring& t) {
  return s.key == t.key && s.force == t.force && s.stiffness == t.stiffness &&
         s.tangent == t.tangent;
}
bool same(std::span<const Spring> s, std::span<const Spring> t) {
  return std::equal(s.begin(), s.end(), t.begin(), t.end(),
                    [](const Spring& p, const Spring& q) { return same(p, q); });
}

}  // namespace

TEST_CASE("a spring follows the slip, and Coulomb's limit ends it", "[friction_memory][contact]") {
  CHECK(CoulombSpring<double>{2, 10}.after(0, .1) == -.2);
  CHECK(CoulombSpring<double>{2, 10}.after(.5, .1) == .3);
  CHECK(CoulombSpring<double>{2, 10}.after(.5, 0) == .5);
  CHECK(CoulombSpring<double>{2, 10}.after(0, 100) == -10);
  CHECK(CoulombSpring<double>{2, 10}.after(0, -100) == 10);
  CHECK(CoulombSpring<double>{2, 3}.after(8, 0) == 3);  // less pressure, less friction
  CHECK(CoulombSpring<double>{2, 3}.after(-8, 0) == -3);
  CHECK(CoulombSpring<double>{2, 0}.after(8, 1) == 0);
  // Sliding on and back again: the spring goes back by all of its reach.
  double force = 0;
  for (int i = 0; i < 10; ++i) force = CoulombSpring<double>{2, 3}.after(force, 1);
  CHECK(force == -3);
  CHECK(CoulombSpring<double>{2, 3}.after(force, -.5) == -2);
  CHECK(CoulombSpring<double>{2, 3}.after(force, -3) == 3);
}

TEST_CASE("springs are kept in the order of their keys", "[friction_memory][contact]") {
  const FrictionMemory memory = with(kThreePairs);
  CHECK(same(memory.springs(), kThreePairs));
  CHECK(std::is_sorted(memory.springs().begin(), memory.springs().end(),
                       [](const Spring& s, const Spring& t) { return s.key < t.key; }));
}

TEST_CASE("a pair finds its own springs of the step before, whoever comes and goes",
          "[friction_memory][contact]") {
  const std::span<const Spring> all(kThreePairs);
  FrictionMemory memory = with(kThreePairs);
  memory.begin_step();
  CHECK(memory.springs().empty());
  ContactWalk<const Spring> walk = memory.before(polygon_kernel);
  CHECK(walk.find({polygon_kernel, 0, 2, 0}).empty());  // new, before all others
  CHECK(same(walk.find({polygon_kernel, 0, 3, 0}), all.first(2)));
  CHECK(walk.find({polygon_kernel, 1, 1, 0}).empty());  // new, in between
  CHECK(same(walk.find({polygon_kernel, 1, 2, 0}), all.subspan(2, 1)));
  CHECK(walk.find({polygon_kernel, 7, 9, 0}).empty());  // new, behind all others
  walk = memory.before(element_kernel);
  CHECK(walk.find({element_kernel, 1, 2, 0}).empty());  // of another law
  walk = memory.before(outline_kernel);
  CHECK(same(walk.find({outline_kernel, 1, 2, 0}), all.subspan(3, 1)));

  // Pairs that are not asked for are passed over, and told.
  std::vector<std::span<const Spring>> passed;
  const auto note = [&](std::span<const Spring> springs) { passed.push_back(springs); };
  walk = memory.before(polygon_kernel);
  CHECK(same(walk.find({polygon_kernel, 1, 2, 0}, note), all.subspan(2, 1)));
  REQUIRE(passed.size() == 1);
  CHECK(same(passed[0], all.first(2)));
  walk = memory.before(polygon_kernel);
  walk.finish(note);
  REQUIRE(passed.size() == 3);
  CHECK(same(passed[1], all.first(2)));
  CHECK(same(passed[2], all.subspan(2, 1)));

  // Only those of a part of the list.
  walk = memory.before({polygon_kernel, 0, 4, 0}, {polygon_kernel, 1, 3, 0});
  CHECK(same(walk.find({polygon_kernel, 1, 2, 0}, note), all.subspan(2, 1)));
  CHECK(passed.size() == 3);

  // Only the step before counts.
  memory.end_step(0);
  memory.begin_step();
  walk = memory.before(polygon_kernel);
  CHECK(walk.find({polygon_kernel, 0, 3, 0}).empty());
}

TEST_CASE("many random pairs inherit by their keys", "[friction_memory][contact]") {
  test::SeededRandom random(61);
  FrictionMemory memory;
  std::vector<Spring> before;
  for (int step = 0; step < test::scaled(50); ++step) {
    memory.begin_step();
    std::vector<Spring> now;
    for (int law = 0; law < kernel_kinds; ++law) {
      ContactWalk<const Spring> walk = memory.before(law);
      for (int a = 0; a < 6; ++a) {
        for (int b = a + 1; b < 7; ++b) {
          if (random.integer(0, 2) == 0) continue;
          std::vector<Spring> expected;
          for (const Spring& s : before) {
            if (s.key.law == law && s.key.a == a && s.key.b == b) expected.push_back(s);
          }
          REQUIRE(same(walk.find({law, a, b, 0}), expected));
          for (int part = 0, n = random.integer(0, 3); part < n; ++part) {
            now.push_back(spring({law, a, b, part}, random.uniform(-1, 1)));
            memory.keep(now.back());
          }
        }
      }
    }
    memory.end_step(0);
    REQUIRE(same(memory.springs(), now));
    before = now;
  }
}

TEST_CASE("records that threads write stand before those that are kept, and a step is taken back",
          "[friction_memory][contact]") {
  ContactHistory<Spring> history;
  const auto step = [&](int count, double force) {
    history.begin_step();
    const std::span<Spring> room = history.make_room(static_cast<size_t>(count));
    REQUIRE(room.size() == static_cast<size_t>(count));
    for (int i = 0; i < count; ++i) {
      room[static_cast<size_t>(i)] = spring({polygon_kernel, i, i + 1, 0}, force);
    }
    std::vector<Spring> more{spring({element_kernel, 1, 2, 0}, force)};
    history.keep(more);
    history.keep(spring({outline_kernel, 1, 2, 0}, force));
  };
  const auto check = [](std::span<const Spring> springs, int count, double force) {
    REQUIRE(springs.size() == static_cast<size_t>(count) + 2);
    CHECK(std::ranges::is_sorted(springs, {}, &Spring::key));
    for (const Spring& s : springs) CHECK(s.force == force);
  };
  step(7, 1);
  step(3, 2);
  check(history.now(), 3, 2);
  check(history.before(), 7, 1);
  step(0, 3);
  check(history.now(), 0, 3);
  history.undo_step();
  check(history.now(), 3, 2);
  step(5, 4);
  check(history.now(), 5, 4);
  check(history.before(), 3, 2);
  JsonWriter writer;
  history.fields(writer, "history");
  const nlohmann::json json = writer.json();
  JsonLoader loader(json);
  ContactHistory<Spring> loaded;
  loaded.fields(loader, "history");
  check(loaded.now(), 5, 4);
}

TEST_CASE("springs store half their force squared over their stiffness",
          "[friction_memory][contact]") {
  CHECK(spring({}, 3, 2).energy() == 9. / 4);
  CHECK(spring({}, -3, 2).energy() == 9. / 4);
  CHECK(spring({}, 3, 0).energy() == 0);
  CHECK(with(kThreePairs).energy() == (1. + 4 + 9 + 16) / 4);
  CHECK(FrictionMemory().energy() == 0);
}

TEST_CASE("what bodies lose and springs do not store is dissipated", "[friction_memory][contact]") {
  FrictionMemory memory;
  // The bodies work on a spring, which stores all of it.
  memory.begin_step();
  memory.keep(spring({0, 0, 1, 0}, 2, 2));
  memory.end_step(-1);
  CHECK(memory.energy() == 1);
  CHECK(memory.loss() == 0);
  // It slides at its limit: three of four joules are lost.
  memory.begin_step();
  memory.keep(spring({0, 0, 1, 0}, std::sqrt(8.), 2));
  memory.end_step(-4);
  CHECK(memory.energy() == Approx(2));
  CHECK(memory.loss() == Approx(3));
  // It gives back what it has stored: nothing is lost.
  memory.begin_step();
  memory.keep(spring({0, 0, 1, 0}, 0, 2));
  memory.end_step(2);
  CHECK(memory.energy() == 0);
  CHECK(memory.loss() == Approx(3));
}

TEST_CASE("springs of contact that has ended count as dissipated", "[friction_memory][contact]") {
  FrictionMemory memory;
  memory.begin_step();
  for (const Spring& s : kThreePairs) memory.keep(s);
  memory.end_step(-7.5);
  CHECK(memory.loss() == 0);
  memory.begin_step();
  memory.keep(kThreePairs[2]);
  memory.end_step(0);
  CHECK(memory.energy() == 9. / 4);
  CHECK(memory.loss() == 7.5 - 9. / 4);
  memory.begin_step();
  memory.end_step(0);
  CHECK(memory.energy() == 0);
  CHECK(memory.loss() == 7.5);
}

TEST_CASE("what laws say that their springs lose is dissipated, and no balance counts it twice",
          "[friction_memory][contact]") {
  FrictionMemory memory;
  memory.begin_step();
  memory.add({.energy = 5, .loss = .25, .damping_loss = .125});  // of a law with springs of its own
  memory.lose(.25);
  memory.keep(spring({outline_kernel, 5, 6, 0}, 6));
  memory.end_step(-9);  // of the last spring alone
  CHECK(memory.energy() == 5 + 9);
  CHECK(memory.loss() == .5);
  CHECK(memory.damping_loss() == .125);
  // Its springs give back what they store.
  memory.begin_step();
  memory.lose(5);
  memory.keep(spring({outline_kernel, 5, 6, 0}, 6));
  memory.end_step(0);
  CHECK(memory.energy() == 9);
  CHECK(memory.loss() == 5.5);
  // The step is taken back.
  memory.undo_step();
  CHECK(memory.energy() == 5 + 9);
  CHECK(memory.loss() == .5);
}

TEST_CASE("a ledger that starts anew forgets losses and keeps springs",
          "[friction_memory][contact]") {
  FrictionMemory memory;
  memory.begin_step();
  for (const Spring& s : kThreePairs) memory.keep(s);
  memory.end_step(-10);
  CHECK(memory.loss() == 2.5);
  memory.start_ledger();
  CHECK(memory.loss() == 0);
  CHECK(memory.energy() == 7.5);
  CHECK(memory.springs().size() == 4);
  memory.begin_step();
  memory.end_step(0);
  CHECK(memory.loss() == 7.5);
}

TEST_CASE("a memory saved and loaded goes on as if nothing had happened",
          "[friction_memory][contact]") {
  FrictionMemory memory;
  memory.begin_step();
  for (Spring s : kThreePairs) {
    s.force /= 3, s.tangent = Vec2(std::cos(s.force), std::sin(s.force));
    memory.keep(s);
  }
  memory.end_step(-M_PI);

  JsonWriter writer;
  writer("memory", memory);
  FrictionMemory loaded = with({spring({element_kernel, 5, 6, 0}, 1)});
  // Numbers go through a text, as in a checkpoint.
  const nlohmann::json json = nlohmann::json::parse(writer.json().dump());
  JsonLoader loader(json);
  loader("memory", loaded);
  CHECK(same(loaded.springs(), memory.springs()));
  CHECK(loaded.energy() == memory.energy());
  CHECK(loaded.loss() == memory.loss());

  for (FrictionMemory* m : {&memory, &loaded}) {
    m->begin_step();
    const std::span<const Spring> before =
        m->before(polygon_kernel).find({polygon_kernel, 0, 3, 0});
    REQUIRE(before.size() == 2);
    m->keep(before[1]);
    m->end_step(.1);
  }
  CHECK(same(loaded.springs(), memory.springs()));
  CHECK(loaded.energy() == memory.energy());
  CHECK(loaded.loss() == memory.loss());
}
