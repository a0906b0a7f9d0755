#include "lib/run/start.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "lib/dynamics/unstable.hpp"
#include "lib/system/clock.hpp"

namespace apothem {
namespace {

constexpr size_t kNamedPairs = 3;
constexpr double kRounding = 1e-9;  // of the inradius; less is touching

std::string pair_text(const Model& model, const PairDepth& pair) {
  return fmt::format("\"{}\" and \"{}\" by {:.3g} m ({:.3g} % of the smaller inradius)",
                     model.name_of(pair.a), model.name_of(pair.b), pair.depth, 100 * pair.share);
}

std::string place_of(const Scene& scene, BodyIndex body) {
  const auto rigid = static_cast<BodyIndex>(scene.rigid_pointers.size());
  return body < rigid ? scene.rigid_pointers[body] : "/bodies";
}

// A resting body may press into its support a little; what is deeper would be shot out.
void refuse_overlaps(const Scene& scene, const Simulation& simulation) {
  const std::vector<PairDepth> pairs = simulation.overlaps();
  if (pairs.empty() || !(pairs.front().share > kSmallOverlap)) return;
  throw scene.error_at(
      place_of(scene, pairs.front().b),
      fmt::format("bodies overlap at the start: {}. This would drive them apart. Move them apart, "
                  "or say \"overlaps\": \"accept\" in \"contact\"",
                  describe_overlaps(simulation)));
}

[[noreturn]] void refuse(const Scene& scene, const Unrunnable& error) {
  throw scene.error_at(error.body() >= 0 ? place_of(scene, error.body()) : "/" + error.key(),
                       error.what());
}

// From flat to cornered, where there is a difference.
std::string depth_text(const Model& model, const ExpectedDepth& e) {
  const std::string corner =
      e.corner > 0 ? fmt::format(" flat to {:.2g} m by a corner", e.corner) : "";
  return fmt::format("about {:.2g} m{}, {}{:.3g} % of the inradius of \"{}\"", e.depth, corner,
                     e.corner > 0 ? "up to " : "", 100 * e.share, model.name_of(e.body));
}

}  // namespace

std::unique_ptr<Simulation> make_simulation(const Scene& scene, int threads, Start start,
                                            const std::function<bool()>& stop) {
  TimeSettings time = scene.time;
  if (start != Start::scene) time.settled = false;
  std::unique_ptr<Simulation> simulation;
  try {
    simulation =
        std::make_unique<Simulation>(scene.model, time, scene.output.frames, threads, stop);
  } catch (const Unrunnable& error) {
    refuse(scene, error);
  }
  if (start == Start::scene && !time.settled && !scene.model.contact.accepts_overlaps) {
    refuse_overlaps(scene, *simulation);
  }
  return simulation;
}

void settle(const Scene& scene, Simulation& simulation, const std::function<bool()>& stop) {
  try {
    simulation.settle(stop);
  } catch (const Unrunnable& error) {
    refuse(scene, error);
  }
}

std::string describe_settling(const Scene& scene, const Simulation& simulation) {
  double most = 1;
  std::string text;
  const auto note = [&](const std::string& name, double way, double inradius) {
    if (!(way > most * inradius)) return;
    most = way / inradius;
    text = fmt::format(
        "\"{}\" had to move by {:.3g} m, {:.3g} times its inradius, to come to rest at the start: "
        "it fell, tipped over or sank; draw bodies where they are to lie, or let them fall in a "
        "run without \"start\" and begin with that by --from",
        name, way, most);
  };
  const State& state = simulation.state();
  for (RigidIndex i = 0; i < state.layout.rigid_bodies; ++i) {
    const RigidBody& body = scene.model.bodies[i];
    if (body.motion != Motion::free) continue;
    note(body.name, (Vec2(state.pose(i).head<2>()) - body.position).norm(), body.inradius);
  }
  return text;
}

std::string describe_overlaps(const Simulation& simulation) {
  std::vector<PairDepth> pairs = simulation.overlaps();
  std::erase_if(pairs, [](const PairDepth& pair) { return pair.share < kRounding; });
  if (pairs.empty()) return {};
  std::string text;
  for (size_t i = 0; i < std::min(pairs.size(), kNamedPairs); ++i) {
    text += (i > 0 ? ", " : "") + pair_text(simulation.model(), pairs[i]);
  }
  if (pairs.size() > kNamedPairs) {
    text += fmt::format(", and {} more pairs", pairs.size() - kNamedPairs);
  }
  return text + fmt::format("; elastic energy {:.3g} J", simulation.energies().contact);
}

std::string describe_forecast(const Simulation& simulation) {
  const Forecast forecast = simulation.forecast();
  std::string text;
  for (const auto& [depth, when] : {std::pair(forecast.by_weight, "at rest, by weight, "),
                                    std::pair(forecast.by_speed, "in the first impacts ")}) {
    if (depth.body < 0) continue;
    text += (text.empty() ? "" : "; ") + (when + depth_text(simulation.model(), depth));
  }
  return text;
}

Trial try_steps(const Scene& scene, int threads, double seconds) {
  const std::unique_ptr<Simulation> simulation = make_simulation(scene, threads);
  Trial trial;
  const Clock::time_point start = Clock::now();
  try {
    const double rows = scene.output.history_interval;
    while (trial.seconds < seconds && simulation->state().time < scene.time.end) {
      simulation->step(std::min(scene.time.end, simulation->state().time + rows));
      trial.steps = simulation->own_steps();
      trial.seconds = seconds_since(start);
    }
  } catch (const Unstable& error) {
    trial.message = error.what();
  }
  return trial;
}

}  // namespace apothem
