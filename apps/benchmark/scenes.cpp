// Whole steps of scenes: piles at rest of quadrilaterals, crosses and meshed blocks, and two scenes
// that come with the program.

#include <malloc.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <memory>
#include <numeric>
#include <optional>

#include "apps/benchmark/bench.hpp"
#include "apps/benchmark/data_scene.hpp"
#include "apps/benchmark/piles.hpp"
#include "apps/cases/samples.hpp"
#include "lib/dynamics/simulation.hpp"
#include "lib/system/clock.hpp"

namespace apothem {
namespace {

// A line of what Linux tells of this process, in bytes.
std::optional<double> status_of_process(const std::string& key) {
  std::ifstream file("/proc/self/status");
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with(key + ":")) return 1024 * std::stod(line.substr(key.size() + 1));
  }
  return {};
}

// How much memory the process has taken at most, since this object was made, beyond what it had.
class MemoryGrowth {
 public:
  MemoryGrowth() {
    malloc_trim(0);
    before_ = status_of_process("VmRSS");
    // From here on the largest size counts anew, where the system allows it.
    std::ofstream(kReset) << "5" << std::flush;
    const std::optional<double> peak = status_of_process("VmHWM");
    constexpr double kNear = 1 << 20;
    if (!before_ || !peak || *peak > *before_ + kNear) before_.reset();
  }
  [[nodiscard]] std::optional<double> bytes() const {
    const std::optional<double> peak = status_of_process("VmHWM");
    if (!before_ || !peak) return {};
    return *peak - *before_;
  }

 private:
  static constexpr const char* kReset = "/proc/self/clear_refs";
  std::optional<double> before_;
};

// Smaller scenes grow by less than what the system hands out beside it.
constexpr double kBodiesForMemory = 3000;

std::vector<Extra> shares(const PhaseSeconds& seconds) {
  const double all = std::accumulate(seconds.begin(), seconds.end(), 0.);
  std::vector<Extra> extras;
  for (size_t i = 0; i < seconds.size(); ++i) {
    extras.push_back({kPhaseNames[i], all > 0 ? seconds[i] / all : 0});
  }
  return extras;
}

// A scene in motion or at rest, one step after the other.
class SteppedScene {
 public:
  /// The model is made here, so that its memory counts.
  SteppedScene(const std::function<Model()>& make, int threads)
      : model_(make()), simulation_(model_, time_of_piles(), 1, threads) {
    bodies_ = static_cast<double>(model_.deformables.size());
    for (const RigidBody& body : model_.bodies) bodies_ += body.motion == Motion::free;
    // Friction springs find their forces in the copies again. Large piles get fewer steps, because
    // they would take minutes.
    const int relax = static_cast<int>(std::clamp(1e6 / bodies_, 100., 1000.));
    for (int i = 0; i < relax; ++i) simulation_.step();
    counts_ = simulation_.counts();
    phases_ = simulation_.phase_seconds();
    first_step_ = simulation_.state().step;
  }

  void step() { simulation_.step(); }
  [[nodiscard]] double bodies() const { return bodies_; }
  [[nodiscard]] double elements() const {
    double count = 0;
    for (const DeformableBody& body : model_.deformables) count += body.mesh.element_count();
    return count;
  }
  [[nodiscard]] const State& state() const { return simulation_.state(); }

  [[nodiscard]] std::vector<Extra> extras() const {
    const auto steps = static_cast<double>(state().step - first_step_);
    const ContactCounts now = simulation_.counts();
    const double per_body = 1 / (steps * bodies_);
    std::vector<Extra> extras{
        {"touching", per_body * static_cast<double>(now.touching_pairs - counts_.touching_pairs)},
        {"candidates",
         per_body * static_cast<double>(now.candidate_pairs - counts_.candidate_pairs)},
        {"speed", speed()}};
    const std::optional<double> memory = memory_.bytes();
    if (memory && bodies_ >= kBodiesForMemory) extras.push_back({"memory", *memory / bodies_});
    PhaseSeconds seconds = simulation_.phase_seconds();
    // Both are extrapolated from samples, so that a rare phase may come out below nothing.
    for (size_t i = 0; i < seconds.size(); ++i) seconds[i] = std::max(0., seconds[i] - phases_[i]);
    for (const Extra& share : shares(seconds)) extras.push_back(share);
    return extras;
  }

 private:
  // Root of the mean square of the velocities of free bodies, and of all nodes.
  [[nodiscard]] double speed() const {
    double squares = 0, count = 0;
    for (size_t i = 0; i < model_.bodies.size(); ++i) {
      if (model_.bodies[i].motion != Motion::free) continue;
      squares += state().pose_rate(static_cast<int>(i)).head<2>().squaredNorm();
      ++count;
    }
    for (int n = 0; n < model_.node_count(); ++n) {
      squares += state().node_velocity(n).squaredNorm();
      ++count;
    }
    return std::sqrt(squares / count);
  }

  MemoryGrowth memory_;
  Model model_;
  Simulation simulation_;
  double bodies_ = 0;
  ContactCounts counts_;
  PhaseSeconds phases_{};
  std::int64_t first_step_ = 0;
};

Work stepped(const std::function<Model()>& make, int threads, bool per_element = false) {
  const auto scene = std::make_shared<SteppedScene>(make, threads);
  const double items = per_element ? scene->elements() : scene->bodies();
  return {.once =
              [scene, items] {
                scene->step();
                return items;
              },
          .extras = [scene] { return scene->extras(); }};
}

Model quadrilaterals(int count) {
  const Pile& pile = pile_of_quadrilaterals();
  return troughs(pile, count / static_cast<int>(pile.bodies.size()), pile.height);
}

Model meshes(int count) {
  const Pile& pile = pile_of_meshes();
  return troughs(pile, count / static_cast<int>(pile.deformables.size()), pile.height);
}

// 6000 quadrilaterals that carry eight squares ten times and one a hundred times as large.
Model sizes() {
  const Pile& pile = pile_of_quadrilaterals();
  const int copies = 20;
  const double side = std::sqrt(kBlockArea), gap = .02 * side;
  // The large ones must not stand on the walls.
  Model model = troughs(pile, copies, pile.height - 4 * side);
  const auto add = [&](double left, double size) {
    RigidBody body;
    body.name = "large";
    const double low = pile.height + gap;
    set_shape(body, samples::block(left, low, left + size, low + size), model);
    model.bodies.push_back(std::move(body));
  };
  add(2, 100 * side);
  for (int i = 0; i < 8; ++i) add(14 + 2 * i, 10 * side);
  return model;
}

// Blocks of the pile, so far from each other that no contact comes into question.
Model meshes_apart(int count) {
  Model model = empty_model();
  model.gravity.setZero();
  const Pile& pile = pile_of_meshes();
  const int columns = static_cast<int>(std::ceil(std::sqrt(count)));
  const double pitch = 4 * std::sqrt(kBlockArea);
  for (int i = 0; i < count; ++i) {
    DeformableBody body = pile.deformables[static_cast<size_t>(i) % pile.deformables.size()];
    const Vec2 by = pitch * Vec2(i % columns, i / columns) - body.mesh.nodes[0];
    for (Vec2& node : body.mesh.nodes) node += by;
    body.displacement.clear();
    body.node_velocity.clear();
    body.first_node = i * static_cast<int>(body.mesh.nodes.size());
    model.deformables.push_back(std::move(body));
  }
  return model;
}

// The same scene with one thread and with two, in turn. Two are timed.
Work two_threads(const std::function<Model()>& make, bool per_element = false) {
  struct Both {
    SteppedScene one, two;
    double one_seconds = 0, two_seconds = 0;
  };
  const auto both = std::shared_ptr<Both>(new Both{.one = {make, 1}, .two = {make, 2}});
  const auto timed_step = [](SteppedScene& scene, double& seconds) {
    const Clock::time_point begin = Clock::now();
    scene.step();
    seconds += seconds_since(begin);
  };
  return {.once =
              [=] {
                timed_step(both->two, both->two_seconds);
                return per_element ? both->two.elements() : both->two.bodies();
              },
          .before = [=] { timed_step(both->one, both->one_seconds); },
          .extras =
              [=] {
                const bool same = both->one.state().x == both->two.state().x &&
                                  both->one.state().v == both->two.state().v;
                return std::vector<Extra>{{"speedup", both->one_seconds / both->two_seconds},
                                          {"same_bits", same ? 1. : 0.}};
              }};
}

Work impact() {
  struct Run {
    Scene scene = data_scene("impact-asymmetric");
    std::unique_ptr<Simulation> simulation;
  };
  const auto run = std::make_shared<Run>();
  return {.once =
              [run] {
                Simulation& s = *run->simulation;
                while (s.state().time < run->scene.time.end) s.step();
                return static_cast<double>(s.own_steps());
              },
          .before =
              [run] {
                run->simulation = std::make_unique<Simulation>(run->scene.model, run->scene.time,
                                                               run->scene.output.frames, 1);
              }};
}

// The whole impacted beam, contacts by the bodies' surfaces or by potentials of elements.
Work beam(bool by_elements, int threads) {
  struct Run {
    Scene scene = data_scene("impacted-beam");
    PhaseSeconds seconds{};
  };
  const auto run = std::make_shared<Run>();
  if (by_elements) {
    run->scene.model.contact.surface = ContactSurface::element;
    run->scene.model.contact.distribution = ForceDistribution::resultant;
  }
  return {.once =
              [run, threads] {
                Simulation s(run->scene.model, run->scene.time, run->scene.output.frames, threads);
                while (s.state().time < run->scene.time.end) s.step();
                const PhaseSeconds seconds = s.phase_seconds();
                for (size_t i = 0; i < seconds.size(); ++i) run->seconds[i] += seconds[i];
                return static_cast<double>(s.own_steps());
              },
          .extras = [run] { return shares(run->seconds); }};
}

}  // namespace

std::vector<BenchmarkCase> scene_cases() {
  std::vector<BenchmarkCase> cases;
  add_family(
      cases,
      {.name = "quads",
       .item = "body",
       .about = "step of a pile of quadrilaterals at rest, friction 0.5"},
      {300, 3000, 30000, 99900},
      [](int count, int threads) {
        pile_of_quadrilaterals();  // its memory does not count
        return stepped([count] { return quadrilaterals(count); }, threads);
      },
      30000);
  cases.push_back({.name = "quads_sizes/6000",
                   .item = "body",
                   .about = "the same, with bodies 10 and 100 times as large on top",
                   .prepare = [](int threads) {
                     pile_of_quadrilaterals();
                     return stepped(sizes, threads);
                   }});
  cases.push_back({.name = "quads_two_threads/3000",
                   .item = "body",
                   .about = "two threads, compared with one",
                   .prepare = [](int) { return two_threads([] { return quadrilaterals(3000); }); },
                   .clock = ClockKind::wall});
  add_family(cases,
             {.name = "crosses",
              .item = "body",
              .about = "step of a pile of crosses at rest, friction 0.5"},
             {300, 3000}, [](int count, int threads) {
               const Pile& pile = pile_of_crosses();
               const int copies = count / static_cast<int>(pile.bodies.size());
               return stepped([&] { return troughs(pile, copies, pile.height); }, threads);
             });
  add_family(
      cases,
      {.name = "blocks",
       .item = "element",
       .about = "step of a pile of blocks of 5 x 5 Q4, friction 0.5"},
      {300, 3000, 30000},
      [](int count, int threads) {
        pile_of_meshes();
        return stepped([count] { return meshes(count); }, threads, true);
      },
      3000);
  cases.push_back({.name = "blocks_two_threads/300",
                   .item = "element",
                   .about = "two threads, compared with one",
                   .prepare = [](int) { return two_threads([] { return meshes(300); }, true); },
                   .clock = ClockKind::wall});
  cases.push_back({.name = "blocks_apart/300",
                   .item = "element",
                   .about = "the same blocks, and nothing touches",
                   .prepare = [](int threads) {
                     pile_of_meshes();
                     return stepped([] { return meshes_apart(300); }, threads, true);
                   }});
  cases.push_back({.name = "impact_steps",
                   .item = "step",
                   .about = "the scene impact-asymmetric, most of it in free flight",
                   .prepare = [](int) { return impact(); }});
  for (const bool by_elements : {false, true}) {
    cases.push_back({.name = std::string("beam_run/elements:") + (by_elements ? "1" : "0"),
                     .item = "step",
                     .about = by_elements ? "the same, contact by potentials of elements"
                                          : "the whole scene impacted-beam, 1100 Q4",
                     .prepare = [by_elements](int threads) { return beam(by_elements, threads); }});
  }
  return cases;
}

}  // namespace apothem
