// apothem check: validates a scene and prints the plan of its run.

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "apps/commands.hpp"
#include "apps/run/plan_json.hpp"
#include "lib/run/cost.hpp"
#include "lib/run/run.hpp"
#include "lib/run/warnings.hpp"

namespace apothem {
namespace {

void say(const char* what, const std::string& text) { fmt::print("{:<12} {}\n", what, text); }

void say_bodies(const Model& model) {
  int free = 0, fixed = 0, prescribed = 0, held = 0, vertices = 0, roofs = 0, fields = 0;
  for (const RigidBody& body : model.bodies) {
    (body.motion == Motion::free ? free : body.motion == Motion::fixed ? fixed : prescribed)++;
    held += body.held[0] || body.held[1] || body.held[2];
    vertices += body.potential.size();
    roofs += body.potential.roof.has_value();
    fields += body.potential.distance.has_value();
  }
  size_t supports = 0;
  for (const DeformableBody& body : model.deformables) supports += body.supports.size();
  say("bodies",
      fmt::format("{} rigid ({} free, {} fixed, {} prescribed), {} vertices; {} deformable",
                  model.bodies.size(), free, fixed, prescribed, vertices,
                  model.deformables.size()));
  if (held > 0) say("held", fmt::format("coordinates of {} rigid bodies", held));
  if (supports > 0) say("supports", fmt::format("{}", supports));
  if (roofs > 0) say("skeletons", fmt::format("of {} bodies that are not convex", roofs));
  if (fields > 0) {
    const bool height = model.contact.potential.reference == PotentialChoice::Reference::roof;
    say("distances", fmt::format("distance field of {} bodies that are not convex{}", fields,
                                 height ? ", reference length by the straight skeleton" : ""));
  }
}

void say_imports(const Scene& scene) {
  for (const ImportReport& import : scene.imports) {
    say("import", fmt::format("{}: {} {} from {}; its unit is {:.10g} m ({})", import.file,
                              import.bodies, import.bodies == 1 ? "body" : "bodies",
                              import.read_in_words(), import.scale, import.unit_source));
    const std::string left_out = import.left_out_in_words();
    if (!left_out.empty()) say("", "left out: " + left_out);
    for (const std::string& fault : import.faults) say("", "fault: " + fault);
    for (const std::string& name : import.renamed) say("", "renamed: " + name);
  }
}

void say_step(const Scene& scene, const Simulation& simulation) {
  const StepChoice& choice = simulation.step_choice();
  const bool phases = scene.time.scheme == TimeScheme::automatic;
  if (scene.time.statics) {
    const std::string count = scene.time.automatic_load_steps
                                  ? "load steps of automatic size, as far as the loads can grow"
                                  : fmt::format("{} load steps", scene.time.load_steps);
    say("run",
        fmt::format("static, {:g} s in {}, tolerance {:g}{}", scene.time.end, count,
                    scene.time.tolerance, scene.rigid ? "; in the limit of rigid bodies" : ""));
    return;
  }
  say("run", fmt::format("{:g} s in {}{:.0f} steps", scene.time.end, phases ? "at most " : "",
                         std::ceil(scene.time.end / choice.step)));
  const bool by_elements = choice.limit.reason.starts_with("elements");
  const TimeSettings& time = scene.time;
  std::string how = "fixed";
  if (!time.fixed_step) {
    how = fmt::format("auto, {:.3g} of the limit",
                      by_elements ? choice.element_safety : choice.safety);
    if (!time.safety) how += fmt::format(" for an accuracy of {:g}", time.accuracy);
  }
  say("time step", fmt::format("{} s ({}); limited by: {}; stability limit {:.6g} s", choice.step,
                               how, choice.limit.reason, choice.stability));
}

double steps_of(const Scene& scene, const Simulation& simulation) {
  return scene.time.statics ? static_cast<double>(scene.time.load_steps)
                            : std::ceil(scene.time.end / simulation.step_choice().step);
}

std::string duration(double seconds) {
  if (seconds < 100) return fmt::format("{:.2g} s", seconds);
  if (seconds < 6000) return fmt::format("{:.2g} min", seconds / 60);
  return seconds < 360000 ? fmt::format("{:.2g} h", seconds / 3600)
                          : fmt::format("{:.2g} days", seconds / 86400);
}

// A trial sees the contacts of the start only.
void say_run_time(const Scene& scene, const Simulation& simulation, const Trial& trial,
                  const OutputCost& cost) {
  if (!trial.message.empty()) {
    say("run time", "none: after a few steps, " + trial.message);
    return;
  }
  const bool phases = scene.time.scheme == TimeScheme::automatic;
  const double steps = run_seconds(scene, simulation, trial);
  say("run time",
      fmt::format(
          "about {} on one thread{}: {} of steps, of which {} have taken {:.2g} s each, and "
          "{} of output",
          duration(steps + cost.seconds), phases ? " if it goes on as it begins" : "",
          duration(steps), trial.steps, trial.seconds / static_cast<double>(trial.steps),
          duration(cost.seconds)));
}

std::string size_text(double bytes) {
  const auto [unit, name] = bytes < 1e6   ? std::pair(1e3, "kB")
                            : bytes < 1e9 ? std::pair(1e6, "MB")
                                          : std::pair(1e9, "GB");
  return fmt::format("{:.{}f} {}", bytes / unit, bytes < 10 * unit ? 1 : 0, name);
}

void say_output(const Scene& scene, bool empty_history, const OutputCost& cost) {
  const OutputSettings& output = scene.output;
  const size_t bodies = output.track.size() + output.track_deformables.size();
  say("output",
      fmt::format("{} frames, histories of {} bodies, {} points and {} regions every {:g} s",
                  output.frames + 1, bodies, output.points.size(), scene.model.regions.size(),
                  output.history_interval));
  say("", fmt::format("about {:.0f} files and {}", cost.files, size_text(cost.bytes)));
  if (empty_history) {
    say("",
        "history.csv will hold the time alone: name up to a few bodies in output.history.track "
        "(a scene of more than 20 bodies has none by default)");
  }
  say("checkpoint", output.checkpoint_interval
                        ? fmt::format("every {:g} s of wall clock", *output.checkpoint_interval)
                        : "off; one is written when the run is stopped");
}

void say_chosen_stiffness(const Model& model) {
  if (!model.contact.penetration) return;
  const double share = *model.contact.penetration;
  const NeededStiffness needed = stiffness_for(model, share);
  std::string text = fmt::format(
      "k_n = {:g} Pa, with which no penetration should exceed {:g} % of the smallest inradius",
      model.contact.normal_stiffness, 100 * share);
  if (needed.flat > 0 && needed.flat < needed.corner) {
    text += fmt::format("; {:g} Pa would do if no body landed on a corner", needed.flat);
  }
  say("stiffness", text);
}

void say_contact_at_start(const Simulation& simulation) {
  say_chosen_stiffness(simulation.model());
  const std::string overlaps = describe_overlaps(simulation);
  say("at t = 0", fmt::format("{} contacts", simulation.counts().touching_now));
  if (!overlaps.empty()) say("overlaps", overlaps);
  const std::string depths = describe_forecast(simulation);
  if (!depths.empty()) say("penetration", depths);
}

}  // namespace

int check_command(const CheckOptions& options) {
  Scene scene = read_scene(options.scene, settings_of(options.set, options.scene));
  scene.drop_rings();
  // First the trial, so that its simulation is gone when the other one is made.
  PlanEstimates estimates = estimates_of(scene);
  const std::unique_ptr<Simulation> simulation = make_simulation(scene, 1);
  std::ranges::move(excessive_costs(scene, steps_of(scene, *simulation)),
                    std::back_inserter(estimates.warnings));
  if (std::string sentence = rules_in_vain(scene.model, scene.stops, simulation->state());
      !sentence.empty()) {
    estimates.warnings.push_back(std::move(sentence));
  }
  const OutputCost cost = output_cost(scene, steps_of(scene, *simulation));
  if (options.json) {
    fmt::print("{}\n", plan_json(scene, *simulation, estimates, cost));
    return exit_code::done;
  }
  const Model& model = scene.model;
  fmt::print("{}: a valid scene\n", scene.file);
  say("name", model.name);
  say_bodies(model);
  say_imports(scene);
  if (model.has_gravity()) {
    std::string factors;
    if (!model.gravity_parts.empty()) factors = " at t = 0, and later as the terms say";
    for (const LoadHistory::Point& p : model.gravity_history.points) {
      factors +=
          fmt::format("{}{:g} at {:g} s", factors.empty() ? ", times " : ", ", p.factor, p.time);
    }
    say("gravity",
        fmt::format("[{:g}, {:g}] m/s^2{}", model.gravity.x(), model.gravity.y(), factors));
  }
  say_step(scene, *simulation);
  const Phases phases = phases_of(scene, *simulation, estimates.dissipates);
  if (!phases.text.empty()) say("phases", phases.text);
  if (estimates.trial) say_run_time(scene, *simulation, *estimates.trial, cost);
  say_output(scene, estimates.empty_history, cost);
  say("expects", fmt::format("{} results", scene.expectations.size()));
  say("damping",
      estimates.damped ? "present, see the terms below" : "none: only friction ends a motion");
  say_contact_at_start(*simulation);
  fmt::print("terms of the step: {}\n", simulation->terms().empty() ? "none" : "");
  for (const auto& term : simulation->terms()) fmt::print("  + {}\n", term->describe());
  for (const std::string& warning : estimates.warnings) fmt::print("warning: {}\n", warning);
  return exit_code::done;
}

}  // namespace apothem
