// What a simulated second of a scene at rest costs: with implicit steps, and what velocity Verlet
// takes for it in the same run of the program.

#include <memory>

#include "apps/benchmark/bench.hpp"
#include "apps/benchmark/piles.hpp"
#include "apps/cases/samples.hpp"
#include "lib/dynamics/islands.hpp"
#include "lib/dynamics/simulation.hpp"
#include "lib/system/clock.hpp"

namespace apothem {
namespace {

constexpr double kSide = .5;           // of a box, m
constexpr double kEnd = 1e6;           // s
constexpr double kInterval = 1. / 60;  // of the output, s
constexpr int kVerletSteps = 50;       // per repetition

void add_box(Model& model, double x, double y) {
  RigidBody box;
  box.name = std::to_string(model.bodies.size());
  set_shape(box, samples::block(x - kSide / 2, y, x + kSide / 2, y + kSide), model);
  model.bodies.push_back(std::move(box));
}

// Rows of boxes on a plate, each with one box less than the one below; or one box in each row.
Model boxes(int rows, bool pyramid, double stiffness) {
  Model model = empty_model();
  model.contact.normal_stiffness = stiffness;
  const double half = rows * kSide;
  add_wall(model, -half, -1, half, 0);
  for (int row = 0; row < rows; ++row) {
    const int count = pyramid ? rows - row : 1;
    for (int i = 0; i < count; ++i) {
      add_box(model, (i - (count - 1) / 2.) * 1.05 * kSide, row * kSide);
    }
  }
  return model;
}

// Columns of boxes on a plate, and a last box beside them.
Model columns(int count, int rows, double stiffness) {
  Model model = empty_model();
  model.contact.normal_stiffness = stiffness;
  add_wall(model, -4 * kSide, -1, 2 * count * kSide, 0);
  for (int i = 0; i < count; ++i) {
    for (int row = 0; row < rows; ++row) add_box(model, 2 * i * kSide, row * kSide);
  }
  add_box(model, -2 * kSide, 0);
  return model;
}

struct Rest {
  Model model;
  std::unique_ptr<Simulation> verlet, automatic;
  double verlet_seconds = 0, verlet_time = 0;  // of the processor, and simulated
  double seconds = 0, time = 0;                // the same with implicit steps
};

std::unique_ptr<Simulation> settled(const Model& model, TimeScheme scheme, int threads,
                                    double end = kEnd) {
  TimeSettings time{.end = end, .longest_step = kInterval};
  time.scheme = scheme;
  time.settled = true;
  return std::make_unique<Simulation>(model, time, 1, threads);
}

// `rows`: of the output, in each repetition.
Work compare(const std::shared_ptr<Rest>& both, int rows) {
  const auto timed = [](double& seconds, double& time, Simulation& simulation, const auto& run) {
    const double from = simulation.state().time, begin = processor_time();
    run();
    seconds += processor_time() - begin;
    time += simulation.state().time - from;
  };
  return {.once =
              [=] {
                Simulation& s = *both->automatic;
                const double from = s.state().time;
                timed(both->seconds, both->time, s, [&] {
                  const double begin = s.state().time;
                  for (int i = 1; i <= rows; ++i) {
                    while (s.state().time < begin + i * kInterval) s.step(begin + i * kInterval);
                  }
                });
                return s.state().time - from;
              },
          .before =
              [=] {
                timed(both->verlet_seconds, both->verlet_time, *both->verlet, [&] {
                  for (int i = 0; i < kVerletSteps; ++i) both->verlet->step();
                });
              },
          .extras =
              [=] {
                const double gain =
                    both->verlet_seconds / both->verlet_time / (both->seconds / both->time);
                return std::vector<Extra>{{"verlet_over_auto", gain}};
              }};
}

Work rest(int rows, bool pyramid, double stiffness, int threads) {
  const auto both = std::make_shared<Rest>();
  both->model = boxes(rows, pyramid, stiffness);
  both->verlet = settled(both->model, TimeScheme::verlet, threads);
  both->automatic = settled(both->model, TimeScheme::automatic, threads);
  return compare(both, 600);
}

// The last box flies for as long as the run lasts.
Work flight(int count, int rows, double stiffness, int threads) {
  constexpr double kFlight = 40;  // s
  const auto both = std::make_shared<Rest>();
  both->model = columns(count, rows, stiffness);
  both->verlet = settled(both->model, TimeScheme::verlet, threads, kFlight);
  both->automatic = settled(both->model, TimeScheme::automatic, threads, kFlight);
  for (Simulation* simulation : {both->verlet.get(), both->automatic.get()}) {
    std::vector<double> velocities(simulation->state().v.size(), 0);
    velocities[velocities.size() - 2] = kFlight * -both->model.gravity.y() / 2;
    simulation->set_velocities(velocities);
  }
  Simulation& automatic = *both->automatic;
  const std::int64_t resting = std::int64_t{count} * rows;
  while (automatic.islands()->count() < resting) automatic.step();
  return compare(both, 12);
}

}  // namespace

std::vector<BenchmarkCase> rest_cases() {
  std::vector<BenchmarkCase> cases;
  const auto enter = [&](const std::string& name, int rows, bool pyramid, double stiffness) {
    cases.push_back(
        {.name = "rest/" + name,
         .item = "simulated s",
         .about = "boxes at rest, with implicit steps",
         .prepare = [=](int threads) { return rest(rows, pyramid, stiffness, threads); }});
  };
  enter("stack/10", 10, false, 2e9);
  enter("stack/30", 30, false, 2e9);
  enter("pyramid/465", 30, true, 2e8);
  cases.push_back({.name = "rest/flight/3000",
                   .item = "simulated s",
                   .about = "boxes at rest, while another one flies",
                   .prepare = [](int threads) { return flight(100, 30, 2e9, threads); }});
  return cases;
}

}  // namespace apothem
