#include <catch2/catch.hpp>

#include "geometry/integrals/placed_shapes.hpp"
#include "lib/dynamics/simulation.hpp"
#include "lib/dynamics/unstable.hpp"
#include "tests/support.hpp"

using namespace apothem;

namespace {

RigidBody make_body(const Model& model, const std::string& name, const Polygon& polygon,
                    Motion motion = Motion::free) {
  RigidBody body;
  body.name = name;
  body.motion = motion;
  set_shape(body, polygon, model);
  return body;
}

Model falling_model(double stiffness = 20e9) {
  Model model;
  model.gravity = {0, -9.81};
  model.materials = {{"rock", 2000}};
  model.contact.normal_stiffness = stiffness;
  return model;
}

// Benchmark geometry A, case 1: equilateral triangles, apex on apex, x and angle locked.
Model bouncing_triangle() {
  const double c = std::sqrt(.75);
  Model model = falling_model();
  model.bodies.push_back(
      make_body(model, "target", Polygon({{-.5, -c}, {.5, -c}, {0, 0}}), Motion::fixed));
  model.bodies.push_back(
      make_body(model, "falling", Polygon({{0, .1}, {.5, .1 + c}, {-.5, .1 + c}})));
  model.bodies[1].held = {true, false, true};
  return model;
}

double drop_energy(const Model& model) { return model.bodies[1].mass * 9.81 * .1; }

// A dense heap: bodies of different shapes in a box of four walls.
Model heap(int columns, int rows) {
  samples::Random random(20);
  Model model = falling_model(1e8);
  const double w = columns * 2.2, h = rows * 2.2 + 5;
  const auto wall = [&](const char* name, double x0, double y0, double x1, double y1) {
    model.bodies.push_back(
        make_body(model, name, Polygon({{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}), Motion::fixed));
  };
  wall("floor", -2, -2, w + 2, 0);
  wall("left", -2, 0, 0, h);
  wall("right", w, 0, w + 2, h);
  for (int i = 0; i < columns; ++i) {
    for (int j = 0; j < rows; ++j) {
      const Polygon p = samples::posed(samples::random_convex(random, random.integer(3, 8)),
                                       {1.1 + 2.2 * i, 1.1 + 2.2 * j}, 0);
      model.bodies.push_back(make_body(model, std::to_string(i) + "-" + std::to_string(j), p));
      model.bodies.back().velocity = {random.uniform(-3, 3), random.uniform(-6, 0)};
      model.bodies.back().spin = random.uniform(-1, 1);
    }
  }
  return model;
}

}  // namespace

TEST_CASE("energy is second order in the step inside a contact", "[dynamics]") {
  const Model model = bouncing_triangle();
  double previous = 0;
  // Independent prototype: largest error while the first contact lasts, over m g h0.
  for (const auto& [dt, prototype] :
       {std::pair(1e-4, 1.72e-4), std::pair(3e-5, 1.55e-5), std::pair(1e-5, 1.73e-6)}) {
    Simulation simulation(model, {.end = .2, .fixed_step = dt}, 1, 1);
    double worst = 0;
    while (simulation.state().time < .2) {
      simulation.step();
      if (simulation.counts().touching_now > 0) {
        worst = std::max(worst, std::abs(simulation.energies().total_error) / drop_energy(model));
      }
    }
    INFO("step " << dt << ", error " << worst);
    CHECK(worst == Approx(prototype).epsilon(.15));
    if (previous > 0)
      CHECK(std::log(previous / worst) / std::log(dt > 2e-5 ? 1e-4 / 3e-5 : 3.0) ==
            Approx(2).margin(.15));
    previous = worst;
  }
}

TEST_CASE("energy does not grow over many bounces", "[dynamics]") {
  const Model model = bouncing_triangle();
  struct Row {
    double dt;
    int bounces;
    double limit;
  };
  // Benchmark table: energy error over m g h0 after so many bounces.
  for (const Row& row :
       {Row{1e-4, 1, 2e-7}, Row{1e-4, 100, 7e-6}, Row{3e-5, 1, 1e-9}, Row{3e-5, 10, 3e-8}}) {
    const double period = 2 * std::sqrt(2 * .1 / 9.81) + .0101;  // about; the end is in free flight
    Simulation simulation(model, {.end = 1000, .fixed_step = row.dt}, 1, 1);
    double worst = 0;
    double worst_late = 0;
    while (simulation.state().time < row.bounces * period) {
      simulation.step();
      if (simulation.state().step % 500 == 0 && simulation.counts().touching_now == 0) {
        const double error = std::abs(simulation.energies().total_error) / drop_energy(model);
        (simulation.state().time < row.bounces * period / 2 ? worst : worst_late) = std::max(
            simulation.state().time < row.bounces * period / 2 ? worst : worst_late, error);
      }
    }
    INFO("step " << row.dt << ", " << row.bounces << " bounces: " << worst << ", " << worst_late);
    CHECK(std::max(worst, worst_late) < 5 * row.limit);
  }
}

TEST_CASE("the automatic step keeps the energy of 100 bounces", "[dynamics]") {
  const Model model = bouncing_triangle();
  Simulation simulation(model, {.end = 29.57, .safety = .1}, 100, 1);
  double first = 0, last = 0;
  while (simulation.state().time < (test::scaled(100) > 2 ? 29.57 : 1)) {
    simulation.step();
    if (simulation.state().step % 1000 != 0 || simulation.counts().touching_now > 0) continue;
    const double error = std::abs(simulation.energies().total_error) / drop_energy(model);
    if (simulation.state().time < 3) first = std::max(first, error);
    last = std::max(last, error);
  }
  CHECK(last < 1e-8);
  CHECK(last < 100 * first + 1e-10);
}

TEST_CASE("the stability limit of a square at rest on a flat block", "[dynamics]") {
  Model model = falling_model();
  model.bodies.push_back(
      make_body(model, "flat", Polygon({{-2, -1}, {2, -1}, {2, 0}, {-2, 0}}), Motion::fixed));
  model.bodies.push_back(
      make_body(model, "square", Polygon({{-.5, 0}, {.5, 0}, {.5, 1}, {-.5, 1}})));
  const double limit = contact_step_limit(model).step;
  CHECK(limit == Approx(3.1623e-4).epsilon(1e-4));
  CHECK_THROWS_WITH(Simulation(model, {.end = 1, .fixed_step = 1.01 * limit}, 1, 1),
                    Catch::Contains("stability limit of 0.000316"));
  // Our own Verlet loop on the kernel, at and beyond the limit: it is the real one.
  const Polygon flat({{-2, -1}, {2, -1}, {2, 0}, {-2, 0}});
  const double mass = model.bodies[1].mass;
  const double rest = mass * 9.81 / (20e9 * (2 + 2));  // static penetration, to first order
  const auto acceleration = [&](double y) {
    const PairResult r = test::edge(Polygon({{-.5, y}, {.5, y}, {.5, 1 + y}, {-.5, 1 + y}}), flat);
    return 20e9 * r.integral.force.y() / mass - 9.81;
  };
  const auto growth = [&](double dt) {
    double y = -1.001 * rest, v = 0, a = acceleration(y), largest = 0;
    for (int i = 0; i < 2000; ++i) {
      v += dt / 2 * a;
      y += dt * v;
      a = acceleration(y);
      v += dt / 2 * a;
      largest = std::max(largest, std::abs(y + rest) / (.001 * rest));
    }
    return largest;
  };
  CHECK(growth(.99 * limit) < 20);
  CHECK(growth(1.01 * limit) > 1e3);
  // And the whole simulation runs at 0.99 of it.
  model.bodies[1].position.y() -= rest * 1.001;
  Simulation simulation(model, {.end = 1, .fixed_step = .99 * limit}, 1, 1);
  for (int i = 0; i < 2000; ++i) simulation.step();
  CHECK(std::abs(simulation.state().pose_rate(1)[1]) < 1e-3);
}

TEST_CASE("the stability limit is that of the stiffest pair, also among equal bodies",
          "[dynamics]") {
  test::SeededRandom random(57);
  for (int i = 0; i < test::scaled(40); ++i) {
    Model model = falling_model();
    model.gravity = Vec2::Zero();
    if (i % 2 == 0) model.contact.friction = {.4, 0, .7};
    std::vector<RigidBody> bodies;
    // Each shape several times, at places where its corners are rounded differently.
    for (int shape = 0; shape < 3; ++shape) {
      const Polygon one = samples::random_convex(random, random.integer(3, 7));
      const int times = random.integer(1, 5);
      for (int k = 0; k < times; ++k) {
        const Vec2 place(random.uniform(-50, 50), random.uniform(-50, 50));
        const Motion motion = random.integer(0, 3) > 0 ? Motion::free : Motion::fixed;
        bodies.push_back(
            make_body(model, std::to_string(bodies.size()), samples::shifted(one, place), motion));
      }
    }
    double least = HUGE_VAL;
    for (size_t a = 0; a < bodies.size(); ++a) {
      for (size_t b = 0; b < a; ++b) {
        model.bodies = {bodies[a], bodies[b]};
        least = std::min(least, contact_step_limit(model).step);
      }
    }
    model.bodies = bodies;
    if (std::isinf(least)) {
      CHECK(std::isinf(contact_step_limit(model).step));
    } else {
      CHECK(contact_step_limit(model).step == Approx(least).epsilon(1e-9));
    }
  }
}

TEST_CASE("momenta and energy of free bodies that collide", "[dynamics]") {
  Model model = falling_model(2e9);
  model.gravity = Vec2::Zero();
  samples::Random random(21);
  for (int i = 0; i < 6; ++i) {
    const double angle = i * M_PI / 3;
    const Polygon p = samples::posed(samples::random_convex(random, random.integer(3, 7)),
                                     2.5 * Vec2(std::cos(angle), std::sin(angle)), 0);
    model.bodies.push_back(make_body(model, std::to_string(i), p));
    model.bodies.back().velocity = -3 * Vec2(std::cos(angle + .1), std::sin(angle + .1));
    model.bodies.back().spin = random.uniform(-2, 2);
  }
  Simulation simulation(model, {.end = 1.5, .safety = .05}, 1, 1);
  const Momenta start = simulation.momenta();
  const double kinetic = simulation.energies().kinetic;
  int touched = 0;
  while (simulation.state().time < 1.5 * (1 - 1e-9)) {
    simulation.step();
    touched += simulation.counts().touching_now;
  }
  REQUIRE(touched > 100);
  const Momenta p = simulation.momenta();
  const double scale = model.bodies[0].mass * 3;
  CHECK(std::abs(p.x - start.x) < 1e-10 * scale);
  CHECK(std::abs(p.y - start.y) < 1e-10 * scale);
  CHECK(std::abs(p.angular - start.angular) < 1e-10 * std::abs(start.angular));
  CHECK(std::abs(simulation.energies().total_error) < 1e-4 * kinetic);
}

TEST_CASE("ledgers close with walls, gravity, held and driven bodies", "[dynamics]") {
  Model model = heap(3, 3);
  model.bodies.push_back(
      make_body(model, "ram", Polygon({{2, 8}, {4, 8}, {4, 9}, {2, 9}}), Motion::prescribed));
  model.bodies.back().history.velocity = {{0, {0, -4}}, {.5, {0, -8}}, {1.2, {1, 0}}};
  model.bodies.back().history.spin = {{0, .5}};
  model.bodies[5].held = {true, false, false};
  model.bodies[5].velocity.x() = 0;
  model.bodies[8].held = {false, false, true};
  model.bodies[8].spin = 0;
  Simulation simulation(model, {.end = 2, .safety = .05}, 1, 1);
  while (simulation.state().time < 2 * (1 - 1e-9)) simulation.step();
  const Energies e = simulation.energies();
  const Momenta p = simulation.momenta();
  CHECK(std::abs(e.external_work) > 100);  // the ram has done something
  CHECK(std::abs(e.total_error) < 1e-3 * (e.kinetic + std::abs(e.gravity)));
  CHECK(std::abs(p.x_error) < 1e-6);
  CHECK(std::abs(p.y_error) < 1e-6);
  CHECK(std::abs(p.angular_error) < 1e-5);
  CHECK(simulation.state().pose(5)[0] == model.bodies[5].position.x());
  CHECK(simulation.state().pose_rate(8)[2] == 0);
  // The prescribed path, integrated by hand: 0.5 s at -6, 0.7 s at -4 with x 0 -> 1, 0.8 s at (1,
  // 0).
  const Eigen::Vector3d ram = simulation.state().pose(static_cast<int>(model.bodies.size()) - 1);
  CHECK(ram[0] == Approx(3 + .35 + .8).epsilon(1e-12));
  CHECK(ram[1] == Approx(8.5 - 3 - 2.8).epsilon(1e-12));
  CHECK(ram[2] == Approx(1).epsilon(1e-12));
}

TEST_CASE("the same bits for any number of threads", "[dynamics][slow]") {
  Model model = falling_model(1e8);
  test::SeededRandom random(22);
  for (int i = 0; i < 1600; ++i) {  // squares with gaps inside the skin: enough pairs for threads
    const Polygon square({{0, 0}, {1, 0}, {1, 1}, {0, 1}});
    model.bodies.push_back(make_body(
        model, std::to_string(i), samples::posed(square, {1.02 * (i % 40), 1.02 * (i / 40)}, 0)));
    model.bodies.back().velocity = {random.uniform(-3, 3), random.uniform(-3, 3)};
    model.bodies.back().spin = random.uniform(-1, 1);
  }
  std::vector<State> finals;
  for (const int threads : {1, 2, 3}) {
    Simulation simulation(model, {.end = 1, .safety = .8}, 1, threads);
    for (int i = 0; i < test::scaled(200) + 20; ++i) simulation.step();
    finals.push_back(simulation.state());
    REQUIRE(simulation.counts().candidate_pairs / simulation.state().step > 2000);
  }
  for (const State& s : finals) {
    CHECK(s.x == finals[0].x);
    CHECK(s.v == finals[0].v);
    CHECK(s.f == finals[0].f);
  }
}

TEST_CASE("a pair search with a skin changes nothing", "[dynamics]") {
  // Every pair of every step, by hand, must be among the candidates whenever it touches.
  const Model model = heap(3, 4);
  Simulation simulation(model, {.end = 1, .safety = .2}, 1, 1);
  PlacedShapes shapes;
  for (const RigidBody& body : model.bodies) shapes.add(body.potential);
  EdgeWorkspace workspace;
  const int n = shapes.size();
  for (int step = 0; step < test::scaled(3000); ++step) {
    simulation.step();
    const std::vector<double>& x = simulation.state().x;
    int touching = 0;
    for (int i = 0; i < n; ++i) shapes.place(i, x[3 * i], x[3 * i + 1], x[3 * i + 2]);
    for (int i = 0; i < n; ++i) {
      for (int j = i + 1; j < n; ++j) {
        if (!model.bodies[i].can_move() && !model.bodies[j].can_move()) continue;
        touching += pair_integral(shapes.view(i), shapes.view(j),
                                  {x[3 * i] - x[3 * j], x[3 * i + 1] - x[3 * j + 1]}, workspace)
                        .touching();
      }
    }
    REQUIRE(touching == simulation.counts().touching_now);
  }
  CHECK(simulation.counts().searches < simulation.state().step / 2);
}

TEST_CASE("large bodies do not widen the search among small ones", "[dynamics]") {
  Model model = falling_model(1e8);
  const Polygon square({{0, 0}, {1, 0}, {1, 1}, {0, 1}});
  // Gaps of a fifth of the small ones, which is twice their skin.
  constexpr int kColumns = 30;
  for (int i = 0; i < kColumns * kColumns; ++i) {
    const Vec2 place(.012 * (i % kColumns), .012 * (i / kColumns));
    model.bodies.push_back(make_body(model, std::to_string(i),
                                     samples::posed(samples::scaled(square, .01), place, 0)));
  }
  for (int i = 0; i < 10; ++i) {
    model.bodies.push_back(make_body(model, "large", samples::posed(square, {1.5 * i, -1.002}, 0)));
  }
  Simulation simulation(model, {.end = 1}, 1, 1);
  simulation.step();
  CHECK(simulation.counts().candidate_pairs == 0);
}

TEST_CASE("a scene far from the world's zero moves as near it", "[dynamics]") {
  const auto fall = [](const Vec2& offset) {
    Model model = falling_model();
    const Polygon target = samples::shifted(Polygon({{-1, 0}, {.25, -1.25}, {1, 0}}), offset);
    const Polygon falling = samples::shifted(Polygon({{0, .125}, {.5, 1}, {-.5, 1}}), offset);
    Box box = bounding_box(target);
    for (const Vec2& v : falling.vertices()) box.include(v.x(), v.y());
    model.origin = local_origin(box);
    model.bodies.push_back(make_body(model, "target", target, Motion::fixed));
    model.bodies.push_back(make_body(model, "falling", falling));
    Simulation simulation(model, {.end = .3, .fixed_step = 1e-5}, 1, 1);
    for (int i = 0; i < 30000; ++i) simulation.step();
    return simulation.state().pose(1)[1] + (model.origin - offset).y();
  };
  const double here = fall({0, 0});
  CHECK(std::abs(here - (.125 + 7.0 / 12)) < .01);  // it has bounced back
  CHECK(std::abs(fall({0x1p20, -0x1p20}) - here) < 1e-12);
  CHECK(std::abs(fall({0x1p30, 0x1p30}) - here) < 1e-12);
}

TEST_CASE("what round-off moves is no energy error", "[dynamics]") {
  for (const double w : {.1, .3, .7, 1.0, 3.0}) {
    Model model = falling_model();  // squares that touch exactly
    model.gravity = Vec2::Zero();
    for (int i = 0; i < 12; ++i) {
      model.bodies.push_back(
          make_body(model, std::to_string(i),
                    Polygon({{i * w, 0}, {(i + 1) * w, 0}, {(i + 1) * w, w}, {i * w, w}})));
    }
    Simulation simulation(model, {.end = 1}, 1, 1);
    for (int i = 0; i < 100; ++i) {
      simulation.step();
      REQUIRE_NOTHROW(simulation.check_energy());
    }
  }
  Model model = falling_model();  // a short fall from far up
  model.bodies.push_back(
      make_body(model, "floor", Polygon({{-1, -1}, {1, -1}, {1, 0}, {-1, 0}}), Motion::fixed));
  model.bodies.push_back(make_body(model, "high", Polygon({{0, 100}, {.5, 101}, {-.5, 101}})));
  Simulation simulation(model, {.end = 1e-5}, 100, 1);
  for (int i = 0; i < 100; ++i) {
    simulation.step();
    REQUIRE_NOTHROW(simulation.check_energy());
  }
}

TEST_CASE("the step respects rotation", "[dynamics]") {
  Model model = falling_model(1e8);
  model.gravity = Vec2::Zero();
  model.bodies.push_back(
      make_body(model, "bar", Polygon({{-5, -.2}, {5, -.2}, {5, .2}, {-5, .2}})));
  model.bodies.push_back(make_body(
      model, "square", Polygon({{4.55, 1.25}, {4.85, 1.25}, {4.85, 1.55}, {4.55, 1.55}})));
  model.bodies[0].spin = 1500;
  const double radius = std::hypot(5, .2);
  CHECK(motion_step_limit(model).step * 1500 * radius <= kLargestStride * .15 * (1 + 1e-12));
  model.bodies[0].spin = 0;
  model.bodies[0].motion = Motion::prescribed;
  model.bodies[0].history.spin = {{0, 1500}};
  CHECK(motion_step_limit(model).step * 1500 * radius <= kLargestStride * .15 * (1 + 1e-12));
}

TEST_CASE("magnitudes that leave no step are refused", "[dynamics]") {
  for (const int which : {0, 1, 2}) {
    Model model = bouncing_triangle();
    TimeSettings time{.end = 1};
    if (which == 0) model.gravity = {0, -1e308};
    if (which == 1) time.end = 1e308;
    if (which == 2) model.contact.normal_stiffness = 1.7e308;
    INFO(which);
    CHECK_THROWS_AS(Simulation(model, time, 1, 1), Unrunnable);
  }
}

TEST_CASE("a run that leaves the method's range stops and says where", "[dynamics]") {
  {
    Model model = bouncing_triangle();  // far too soft: falls through
    model.contact.normal_stiffness = 1e3;
    Simulation simulation(model, {.end = 2}, 1, 1);
    CHECK_THROWS_WITH(
        [&] {
          while (true) simulation.step();
        }(),
        Catch::Contains("\"target\"") && Catch::Contains("falling") && Catch::Contains("t = ") &&
            Catch::Contains("normal_stiffness"));
  }
  {
    Model model = bouncing_triangle();  // too fast for its step
    model.contact.normal_stiffness = 1e3;
    model.bodies[1].velocity = {0, -1000};
    Simulation simulation(model, {.end = 2, .fixed_step = 1e-2}, 1, 1);
    CHECK_THROWS_WITH(simulation.step(), Catch::Contains("moves 10 m in one step"));
  }
  {
    Model model = bouncing_triangle();
    model.bodies[1].velocity = {0, std::nan("")};
    Simulation simulation(model, {.end = 2}, 1, 1);
    CHECK_THROWS_WITH(simulation.step(), Catch::Contains("not finite"));
  }
  {
    Model model = bouncing_triangle();  // one on top of the other from the start
    model.bodies[1].position = model.bodies[0].position;
    CHECK_THROWS_AS(Simulation(model, {.end = 2}, 1, 1), Unrunnable);
  }
}
