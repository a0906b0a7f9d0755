// Work and precision: the energy error of whole runs against their time, for some parts of the
// stability limit, as velocity Verlet takes the steps ("plain") and with contacts that begin or end
// within a step corrected. The number in a name is the part of the limit in thousandths.
//
//   apothem benchmark --filter ^work/ --repeat 1 -o out/precision
//   gnuplot docs/images/work-precision.gnuplot

#include <cmath>
#include <memory>

#include "apps/benchmark/bench.hpp"
#include "apps/benchmark/data_scene.hpp"
#include "apps/cases/impacts.hpp"
#include "apps/cases/samples.hpp"
#include "lib/dynamics/simulation.hpp"

namespace apothem {
namespace {

TimeSettings time_of(double end, double safety, bool corrected) {
  return {.end = end, .safety = safety, .element_safety = safety, .onsets = corrected};
}

Model rigid_model(double stiffness) {
  Model model;
  model.materials = {{"rock", 2000}};
  model.contact.normal_stiffness = stiffness;
  return model;
}

void add(Model& model, const Polygon& polygon, const Vec2& velocity, double spin) {
  RigidBody body;
  body.name = std::to_string(model.bodies.size());
  set_shape(body, polygon, model);
  body.velocity = velocity, body.spin = spin;
  model.bodies.push_back(body);
}

void add_wall(Model& model, double x0, double y0, double x1, double y1) {
  add(model, samples::block(x0, y0, x1, y1), Vec2::Zero(), 0);
  model.bodies.back().motion = Motion::fixed;
}

// A square falls on a floor, flat and nearly flat, from 16 heights: the largest error after the
// separation, over the kinetic energy.
double impact(double safety, bool corrected) {
  double worst = 0, step = 0;
  for (const double tilt : {0., 3e-4, 3e-3, .03}) {
    for (int phase = 0; phase < 16; ++phase) {
      Model model = rigid_model(2e8);
      add_wall(model, -5, -1, 5, 0);
      const double low = .5 * (std::cos(tilt) + std::sin(tilt));
      add(model,
          samples::shifted(samples::turned(samples::block(-.5, -.5, .5, .5), tilt),
                           {0, low + .003 + phase * step / 16}),
          {0, -1}, 0);
      Simulation simulation(model, time_of(1, safety, corrected), 1, 1);
      step = simulation.step_size();
      const double kinetic = simulation.energies().kinetic;
      bool touched = false;
      for (int apart = 0; apart < 3;) {
        simulation.step();
        const bool touching = simulation.counts().touching_now > 0;
        touched = touched || touching;
        apart = touched && !touching ? apart + 1 : 0;
      }
      worst = std::max(worst, std::abs(simulation.energies().total_error) / kinetic);
    }
  }
  return worst;
}

// 16 random polygons in a closed box, 300 impacts: the root of the mean squared error of an impact,
// over the kinetic energy of a body.
double gas(double safety, bool corrected) {
  Model model = rigid_model(2e9);
  const double side = 6.4;
  add_wall(model, -1, -1, side + 1, 0), add_wall(model, -1, side, side + 1, side + 1);
  add_wall(model, -1, 0, 0, side), add_wall(model, side, 0, side + 1, side);
  samples::Random random(5);
  for (int i = 0; i < 16; ++i) {
    const int column = i % 4, row = i / 4;
    const Vec2 place(.8 + 1.6 * column, .8 + 1.6 * row);
    const Polygon p = samples::scaled(samples::random_quad(random), .5);
    const Vec2 velocity(random.uniform(-2, 2), random.uniform(-2, 2));
    add(model, samples::shifted(p, place), velocity, random.uniform(-1, 1));
  }
  Simulation simulation(model, time_of(1e3, safety, corrected), 1, 1);
  return samples::error_per_impact(simulation, 300, simulation.energies().kinetic / 16);
}

// 100 quadrilaterals fall into a box and come to rest, with friction and normal damping: the error
// over what is dissipated.
double pack(double safety, bool corrected) {
  Model model = rigid_model(2e8);
  model.gravity = {0, -9.81};
  model.contact.friction = {.5, 1.2e8};
  model.contact.damping.normal = .3;
  const double side = 12;
  add_wall(model, -1, -1, side + 1, 0);
  add_wall(model, -1, 0, 0, 3 * side), add_wall(model, side, 0, side + 1, 3 * side);
  samples::Random random(7);
  for (int i = 0; i < 100; ++i) {
    const int column = i % 10, row = i / 10;
    const Vec2 place(.9 + 1.1 * column + random.uniform(-.04, .04), .7 + 1.1 * row);
    const Polygon p = samples::scaled(samples::random_quad(random), .5);
    const double sideways = random.uniform(-.3, .3);
    add(model, samples::shifted(p, place), {sideways, -1}, random.uniform(-1, 1));
  }
  Simulation simulation(model, time_of(1.5, safety, corrected), 1, 1);
  while (simulation.state().time < 1.5) simulation.step();
  const Energies e = simulation.energies();
  return std::abs(e.total_error) / (e.friction_loss + e.damping_loss);
}

// A scene of the data folder: the largest error over the kinetic energy at the start.
std::function<double(double, bool)> shipped(const std::string& name) {
  return [name](double safety, bool corrected) {
    const Scene scene = data_scene(name);
    Simulation simulation(scene.model, time_of(scene.time.end, safety, corrected), 1, 1);
    const double kinetic = simulation.energies().kinetic;
    double worst = 0;
    for (int step = 0; simulation.state().time < scene.time.end; ++step) {
      simulation.step();
      if (step % 16 != 0) continue;
      worst = std::max(worst, std::abs(simulation.energies().total_error) / kinetic);
    }
    return worst;
  };
}

}  // namespace

std::vector<BenchmarkCase> work_cases() {
  std::vector<BenchmarkCase> cases;
  const auto enter = [&](const std::string& name, const std::string& about,
                         const std::function<double(double, bool)>& run,
                         std::initializer_list<int> thousandths) {
    for (const bool corrected : {false, true}) {
      for (const int part : thousandths) {
        const auto prepare = [=](int) {
          const auto error = std::make_shared<double>(0);
          return Work{.once =
                          [=] {
                            *error = run(static_cast<double>(part) / 1000, corrected);
                            return 1.;
                          },
                      .extras =
                          [error] {
                            return std::vector<Extra>{{"error", *error}};
                          }};
        };
        cases.push_back({.name = "work/" + name + (corrected ? "/corrected/" : "/plain/") +
                                 std::to_string(part),
                         .item = "run",
                         .about = about,
                         .prepare = prepare,
                         .on_request = true});
      }
    }
  };
  enter("impact", "64 landings of a square, and the worst error", impact,
        {50, 80, 120, 160, 250, 400});
  enter("gas", "300 impacts of 16 polygons, and their error", gas, {50, 80, 120, 160, 250, 400});
  enter("pack", "100 quadrilaterals come to rest, and the error", pack,
        {50, 80, 120, 160, 250, 400, 600});
  enter("beam", "impacted beam, and the largest error", shipped("impacted-beam-coarse"),
        {50, 100, 200, 400});
  enter("discs", "oblique discs, and the largest error", shipped("oblique-discs"),
        {50, 100, 200, 400});
  return cases;
}

}  // namespace apothem
