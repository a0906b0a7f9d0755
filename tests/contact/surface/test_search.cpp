// The broad phase: candidates against brute force, when they are renewed, who is left out.
#include <catch2/catch.hpp>
#include <limits>

#include "lib/contact/surface/search.hpp"
#include "lib/mesh/rectangle_mesh.hpp"
#include "tests/contact/bodies.hpp"

using namespace apothem;
using namespace apothem::test;

namespace {

constexpr double kSkin = .02;  // m

// Surfaces of bodies and their state, without any contact.
struct Shapes {
  std::deque<Potential> potentials;
  Surfaces surfaces;
  std::vector<double> pose, displacement;
  std::vector<BodyIndex> body_of_node;

  explicit Shapes(bool outlines = false) : surfaces(kSkin, kSkin, outlines) {}
  void add_polygon(const Polygon& polygon, const std::array<double, 3>& place = {},
                   const std::array<double, 3>& inverse_mass = {1, 1, 1}, double skin = HUGE_VAL) {
    potentials.push_back(about_centre(polygon));
    surfaces.add_polygon(potentials.back(),
                         {inverse_mass, 1 / potentials.back().steepest, true, skin});
    pose.insert(pose.end(), place.begin(), place.end());
  }
  void add_mesh(const Mesh& mesh, bool outline) {
    const int first = static_cast<int>(body_of_node.size());
    body_of_node.resize(body_of_node.size() + mesh.nodes.size(), surfaces.body_count());
    displacement.resize(2 * body_of_node.size());
    if (outline) {
      surfaces.add_outline(mesh, first, {});
    } else {
      surfaces.add_elements(mesh, first, {});
    }
  }
  void place() { surfaces.place_all({pose, displacement, {}, {}}); }
};

bool immovable(const Surfaces& s, SurfaceIndex i) {
  if (s.kind(i) != SurfaceKind::polygon) return false;
  const std::array<double, 3>& w = s.rigid(i).inverse_mass;
  return w[0] == 0 && w[1] == 0 && w[2] == 0;
}
bool may_touch(const Surfaces& s, SurfaceIndex i, SurfaceIndex j) {
  return s.body(i) != s.body(j) && !(immovable(s, i) && immovable(s, j));
}

// An edge of one body meets a face of the other one's collar.
bool outlines_touch(const OutlineSurfaces& o, BodyIndex a, BodyIndex b) {
  for (const auto& [p, q] : {std::pair(a, b), std::pair(b, a)}) {
    for (int e = o.bodies[p].first; e < o.bodies[p].end; ++e) {
      for (int f = o.bodies[q].first; f < o.bodies[q].end; ++f) {
        CollarPiece<double> piece;
        CollarCrossings<double> crossings;
        const Vec2 from = o.point(e), to = o.point(o.next[e]);
        if (collar_piece(o.face(f), from.x(), from.y(), to.x(), to.y(), piece, crossings))
          return true;
      }
    }
  }
  return false;
}

bool touch(const Surfaces& s, SurfaceIndex i, SurfaceIndex j, EdgeWorkspace& workspace) {
  if (s.kind(i) == SurfaceKind::outline || s.kind(j) == SurfaceKind::outline) {
    return outlines_touch(s.outlines(), s.body(i), s.body(j));
  }
  const PlacedShapes& shapes = s.shapes();
  return pair_integral(shapes.view(i), shapes.view(j), s.between(i, j), workspace).touching();
}

// Sizes from 1 to 100, the small ones being the most.
double random_size(samples::Random& random) { return .02 * std::pow(10., random.uniform(0, 2)); }

Mesh random_mesh(samples::Random& random) {
  const double size = random_size(random);
  const Vec2 at(random.uniform(0, 5), random.uniform(0, 5));
  const std::array cells{random.integer(1, 4), random.integer(1, 4)};
  const ElementShape shape =
      random.integer(0, 1) ? ElementShape::triangle : ElementShape::quadrilateral;
  return rectangle_mesh({size, size * random.uniform(.5, 1)}, cells, at, shape);
}

Shapes random_scene(samples::Random& random, int polygons, int meshes, bool outlines) {
  Shapes scene(outlines && meshes > 0);
  for (int i = 0; i < polygons; ++i) {
    const double size = random_size(random);
    const Polygon shape = random.integer(0, 3) ? samples::random_convex(random, 6)
                                               : samples::random_star_shaped(random, 8, .5);
    const std::array<double, 3> place{random.uniform(0, 5), random.uniform(0, 5),
                                      random.uniform(-3, 3)};
    const double mobility = random.integer(0, 3) ? 1 : 0;
    const double skin = random.uniform(.7, 1.5) * kSkin;  // its own, or that of the scene
    scene.add_polygon(samples::scaled(shape, size), place, {mobility, mobility, mobility}, skin);
  }
  for (int i = 0; i < meshes; ++i) scene.add_mesh(random_mesh(random), outlines);
  return scene;
}

// Every body drifts and turns; every node of a mesh drifts with its neighbours and deforms a
// little, so little that the smallest elements stay convex.
struct RandomMotion {
  std::vector<Vec2> drift;
  std::vector<double> spin;
};
RandomMotion random_motion(samples::Random& random, size_t bodies, bool with_fast_ones) {
  RandomMotion motion;
  for (size_t i = 0; i < bodies; ++i) {
    const double fastest = with_fast_ones && random.integer(0, 9) == 0 ? .1 : .002;
    motion.drift.emplace_back(random.uniform(-fastest, fastest), random.uniform(-fastest, fastest));
    motion.spin.push_back(random.uniform(-.001, .001));
  }
  return motion;
}
void move(Shapes& scene, const RandomMotion& motion, samples::Random& random) {
  for (size_t i = 0; i < scene.pose.size() / 3; ++i) {
    scene.pose[3 * i] += motion.drift[i].x();
    scene.pose[3 * i + 1] += motion.drift[i].y();
    scene.pose[3 * i + 2] += motion.spin[i];
  }
  for (size_t n = 0; n < scene.body_of_node.size(); ++n) {
    const Vec2& drift = motion.drift[static_cast<size_t>(scene.body_of_node[n])];
    scene.displacement[2 * n] += drift.x() + random.uniform(-1e-5, 1e-5);
    scene.displacement[2 * n + 1] += drift.y() + random.uniform(-1e-5, 1e-5);
  }
}

}  // namespace

TEST_CASE("the search misses no touching pair of moving surfaces, large or small",
          "[search][contact]") {
  test::SeededRandom random(51);
  struct Mix {
    int polygons, meshes;
    bool outlines;
  };
  for (const Mix& mix :
       {Mix{80, 0, false}, {30, 12, false}, {0, 15, false}, {30, 20, true}, {0, 25, true}}) {
    CAPTURE(mix.polygons, mix.meshes, mix.outlines);
    int touching = 0, searches = 0, steps = 0, slow_steps = 0;
    for (int round = 0; round < scaled(6); ++round) {
      Shapes scene = random_scene(random, mix.polygons, mix.meshes, mix.outlines);
      const RandomMotion motion =
          random_motion(random, static_cast<size_t>(scene.surfaces.body_count()), round % 2 == 1);
      Search search;
      EdgeWorkspace workspace;
      for (int step = 0; step < 40; ++step, ++steps) {
        slow_steps += round % 2 == 0;
        // Bodies are taken out and put in again while the others move.
        if (step % 9 == 8) {
          std::vector<std::uint8_t> absent(motion.drift.size());
          for (std::uint8_t& flag : absent) flag = random.integer(0, 4) == 0;
          scene.surfaces.set_absent(absent);
          search.forget();
        }
        scene.place();
        if (search.stale(scene.surfaces)) {
          search.search(scene.surfaces);
          CHECK_FALSE(search.stale(scene.surfaces));
          searches += round % 2 == 0;
        }
        const std::span<const BoxPair> pairs = search.pairs();
        REQUIRE(std::is_sorted(pairs.begin(), pairs.end()));
        for (const BoxPair& pair : pairs) {
          REQUIRE(pair.first < pair.second);
          REQUIRE(may_touch(scene.surfaces, pair.first, pair.second));
          REQUIRE(scene.surfaces.is_present(pair.first));
          REQUIRE(scene.surfaces.is_present(pair.second));
        }
        for (SurfaceIndex i = 0; i < scene.surfaces.size(); ++i) {
          for (SurfaceIndex j = i + 1; j < scene.surfaces.size(); ++j) {
            if (!may_touch(scene.surfaces, i, j)) continue;
            if (!scene.surfaces.is_present(i) || !scene.surfaces.is_present(j)) continue;
            if (!touch(scene.surfaces, i, j, workspace)) continue;
            ++touching;
            if (!std::binary_search(pairs.begin(), pairs.end(), BoxPair{i, j})) {
              FAIL("surfaces " << i << " and " << j << " touch unseen in step " << step);
            }
          }
        }
        move(scene, motion, random);
      }
    }
    CHECK(touching > steps);
    CHECK(searches < slow_steps * 2 / 3);
  }
}

TEST_CASE("candidates are found once and for all where nothing comes near", "[search][contact]") {
  Shapes scene;
  scene.add_polygon(samples::block(-.5, -.5, .5, .5), {0, 0, 0});
  scene.add_polygon(samples::block(-.5, -.5, .5, .5), {1 + .99 * kSkin, 0, 0});
  scene.add_polygon(samples::block(-.5, -.5, .5, .5), {0, 1 + 1.01 * kSkin, 0});
  scene.place();
  Search search;
  search.search(scene.surfaces);
  // Those within a skin of each other.
  REQUIRE(search.pairs().size() == 1);
  CHECK(search.pairs()[0] == BoxPair{0, 1});
}

TEST_CASE("candidates serve until a surface has left its box, grown by half the skin",
          "[search][contact]") {
  // Two polygons, then a mesh by its elements or its outline.
  for (const bool outline : {false, true}) {
    CAPTURE(outline);
    const auto scene = [&] {
      Shapes made(outline);
      made.add_polygon(samples::block(-.5, -.5, .5, .5), {0, 0, 0});
      made.add_polygon(samples::block(-.5, -.5, .5, .5), {3, 0, 0});
      made.add_mesh(rectangle_mesh({1, 1}, {2, 2}, {0, 2}, ElementShape::quadrilateral), outline);
      made.place();
      return made;
    };
    const auto stale_after = [&](auto&& change) {
      Shapes moved = scene();
      Search search;
      CHECK(search.stale(moved.surfaces));
      search.search(moved.surfaces);
      CHECK_FALSE(search.stale(moved.surfaces));
      change(moved);
      moved.place();
      return search.stale(moved.surfaces);
    };
    for (const double sign : {-1., 1.}) {
      for (const int axis : {0, 1}) {
        for (const double share : {.499, .501}) {
          CAPTURE(sign, axis, share);
          const double far = sign * share * kSkin;
          CHECK(stale_after([&](Shapes& s) { s.pose[3 + axis] += far; }) == (share > .5));
          CHECK(stale_after([&](Shapes& s) {
                  for (size_t k = axis; k < s.displacement.size(); k += 2) s.displacement[k] = far;
                }) == (share > .5));
        }
      }
    }
    // A corner of the mesh alone, and a turn that carries corners out of the box.
    CHECK(stale_after([](Shapes& s) { s.displacement[0] -= .6 * kSkin; }));
    CHECK(stale_after([](Shapes& s) { s.pose[2] += .1; }));
    CHECK_FALSE(stale_after([](Shapes& s) { s.pose[2] += .01; }));
  }
}

TEST_CASE("a search that has been forgotten is stale", "[search][contact]") {
  Shapes scene;
  scene.add_polygon(samples::block(0, 0, 1, 1));
  scene.place();
  Search search;
  search.search(scene.surfaces);
  CHECK_FALSE(search.stale(scene.surfaces));
  search.forget();
  CHECK(search.stale(scene.surfaces));

  // Contacts forget all of their searches at once.
  Bodies bodies(law_of(1));
  bodies.add_rigid(about_centre(samples::block(0, 0, 1, 1)));
  bodies.add_ring({{0, 2}, {1, 2}, {1, 3}, {0, 3}}, .5);
  bodies.join();
  bodies.place();
  CHECK_FALSE(bodies.contacts->search_if_stale());
  bodies.contacts->forget_search();
  CHECK(bodies.contacts->search_if_stale());
  CHECK_FALSE(bodies.contacts->search_if_stale());
  CHECK(bodies.contacts->searches() == 2);
}

TEST_CASE("a surface that is nowhere is an error that names its body", "[search][contact]") {
  for (const double nowhere :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
        -std::numeric_limits<double>::infinity()}) {
    for (const bool outline : {false, true}) {
      const auto body_of = [&](auto&& change) -> BodyIndex {
        Shapes scene(outline);
        scene.add_polygon(samples::block(0, 0, 1, 1), {0, 0, 0});
        scene.add_polygon(samples::block(0, 0, 1, 1), {5, 0, 0});
        scene.add_mesh(one_element({{0, 5}, {1, 5}, {1, 6}, {0, 6}}), outline);
        scene.add_mesh(one_element({{5, 5}, {6, 5}, {6, 6}, {5, 6}}), outline);
        scene.place();
        change(scene);
        try {
          scene.place();
        } catch (const NotFinite& error) {
          return error.body();
        }
        return -1;
      };
      CAPTURE(nowhere, outline);
      CHECK(body_of([](Shapes&) {}) == -1);
      for (const size_t k : {0, 1, 2}) {
        CHECK(body_of([&](Shapes& s) { s.pose[k] = nowhere; }) == 0);
        CHECK(body_of([&](Shapes& s) { s.pose[3 + k] = nowhere; }) == 1);
      }
      for (const size_t k : {0, 1, 6, 7}) {
        CHECK(body_of([&](Shapes& s) { s.displacement[k] = nowhere; }) == 2);
        CHECK(body_of([&](Shapes& s) { s.displacement[8 + k] = nowhere; }) == 3);
      }
    }
  }
}

TEST_CASE("pairs that no force can move, and pairs of one body, are left out",
          "[search][contact]") {
  const Polygon unit = samples::block(-.5, -.5, .5, .5);
  Shapes scene;
  scene.add_polygon(unit, {0, 0, 0}, {0, 0, 0});
  scene.add_polygon(unit, {.1, 0, 0}, {0, 0, 0});
  scene.add_polygon(unit, {.2, 0, 0}, {0, 0, 1});  // may turn only
  scene.add_mesh(rectangle_mesh({1, 1}, {2, 1}, {-.5, -.5}, ElementShape::quadrilateral), false);
  scene.place();
  Search search;
  search.search(scene.surfaces);
  const std::vector<BoxPair> expected{{0, 2}, {0, 3}, {0, 4}, {1, 2},
                                      {1, 3}, {1, 4}, {2, 3}, {2, 4}};
  CHECK((std::vector(search.pairs().begin(), search.pairs().end()) == expected));
}

TEST_CASE("the search finds the same on any number of threads", "[search][contact][parallel]") {
  // Slabs that nothing moves, and squares on a lattice, so many that threads divide all loops.
  constexpr int kAcross = 120;
  const Potential square = about_centre(samples::block(-.5, -.5, .5, .5));
  const Potential slab = about_centre(samples::block(-60, -.5, 60, .5));
  const auto scene = [&] {
    Shapes made;
    for (int i = 0; i < kAcross * kAcross; ++i) {
      made.surfaces.add_polygon(square, {{1, 1, 1}, 2, 1, .5, true, HUGE_VAL});
      made.pose.insert(made.pose.end(), {1.01 * (i % kAcross), 1.01 * (i / kAcross), 0});
    }
    for (int k = 0; k < 2; ++k) {
      made.surfaces.add_polygon(slab, {{0, 0, 0}, 2, 60, .5, true, HUGE_VAL});
      made.pose.insert(made.pose.end(), {60, -.8 + .1 * k, 0});
    }
    made.place();
    return made;
  };
  const auto found = [&](int threads, bool some_absent) {
    Shapes moved = scene();
    Search search;
    std::vector<BoxPair> all;
    const auto look = [&] {
      search.search(moved.surfaces, Threads(threads));
      all.insert(all.end(), search.pairs().begin(), search.pairs().end());
      all.push_back({-1, -1});
    };
    look();
    samples::Random random(52);
    for (int again = 0; again < 4; ++again) {
      for (size_t i = 0; i < moved.pose.size() / 3; ++i) {
        if (random.integer(0, again < 3 ? 9 : 1) == 0) moved.pose[3 * i] += random.uniform(-.1, .1);
      }
      if (some_absent && again == 2) {
        std::vector<std::uint8_t> absent(moved.pose.size() / 3);
        for (std::uint8_t& flag : absent) flag = random.integer(0, 4) == 0;
        moved.surfaces.set_absent(absent);
        search.forget();
      }
      moved.place();
      look();
    }
    return all;
  };
  for (const bool absent : {false, true}) {
    const std::vector<BoxPair> one = found(1, absent);
    CHECK(one.size() > 5 * 2 * kAcross * kAcross);
    for (const int threads : {2, 3, 7}) CHECK((found(threads, absent) == one));
  }
}
