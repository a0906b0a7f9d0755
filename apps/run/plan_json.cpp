#include "apps/run/plan_json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>

#include "lib/scene/plausibility.hpp"

namespace apothem {
namespace {

using Json = nlohmann::ordered_json;

const char* name_of(Motion motion) {
  return motion == Motion::free ? "free" : motion == Motion::fixed ? "fixed" : "prescribed";
}

Json rigid_body(const Model& model, const RigidBody& body) {
  return {{"name", body.name},
          {"kind", "rigid"},
          {"material", model.materials[static_cast<size_t>(body.material)].name},
          {"motion", name_of(body.motion)},
          {"vertices", body.potential.size()},
          {"area", body.area},
          {"mass", body.mass},
          {"inradius", body.inradius}};
}

Json element_materials(const Model& model, const DeformableBody& body) {
  Json names = Json::array();
  for (const MaterialIndex material : body.materials()) {
    names.push_back(model.materials[static_cast<size_t>(material)].name);
  }
  return names;
}

Json deformable_body(const Model& model, const DeformableBody& body) {
  return {{"name", body.name},
          {"kind", "deformable"},
          {"material", model.materials[static_cast<size_t>(body.material)].name},
          {"element_materials", element_materials(model, body)},
          {"element", kElements[static_cast<size_t>(body.element)].name},
          {"elements", body.mesh.element_count()},
          {"nodes", body.mesh.nodes.size()},
          {"supports", body.supports.size()},
          {"loads", body.dead_loads.size() + body.pressures.size()}};
}

Json bodies(const Model& model) {
  Json list = Json::array();
  for (const RigidBody& body : model.bodies) list.push_back(rigid_body(model, body));
  for (const DeformableBody& body : model.deformables) {
    list.push_back(deformable_body(model, body));
  }
  return list;
}

Json imports(const Scene& scene) {
  Json list = Json::array();
  for (const ImportReport& import : scene.imports) {
    Json left_out = Json::array();
    for (const auto& [what, count] : import.left_out) {
      left_out.push_back({{"entity", what.first}, {"reason", what.second}, {"count", count}});
    }
    list.push_back({{"file", import.file},
                    {"bodies", import.bodies},
                    {"scale", import.scale},
                    {"unit", import.unit_source},
                    {"read", import.read},
                    {"left_out", left_out},
                    {"faults", import.faults},
                    {"renamed", import.renamed}});
  }
  return list;
}

// JSON knows no infinity: where nothing limits the step, the limit is null.
Json time_step(const Scene& scene, const Simulation& simulation) {
  const StepChoice& choice = simulation.step_choice();
  const bool automatic = !scene.time.fixed_step.has_value();
  Json accuracy;  // null where the scene gives the step or its safety
  if (automatic && !scene.time.safety) accuracy = scene.time.accuracy;
  return {{"step", choice.step},
          {"automatic", automatic},
          {"accuracy", accuracy},
          {"safety", automatic ? Json(choice.safety) : Json()},
          {"limited_by", choice.limit.reason},
          {"stability_limit", choice.stability},
          {"steps", std::ceil(scene.time.end / choice.step)}};
}

Json output(const OutputSettings& settings, const OutputCost& cost) {
  Json json{{"frames", settings.frames + 1},
            {"tracked_bodies", settings.track.size() + settings.track_deformables.size()},
            {"tracked_points", settings.points.size()},
            {"history_interval", settings.history_interval},
            {"files", cost.files},
            {"bytes", cost.bytes},
            {"seconds", cost.seconds}};
  json["checkpoint_interval"] =
      settings.checkpoint_interval ? Json(*settings.checkpoint_interval) : Json();
  return json;
}

Json run_time(const Scene& scene, const Simulation& simulation, const Trial& trial) {
  Json json{{"seconds", nullptr}, {"trial_steps", trial.steps}, {"trial_seconds", trial.seconds}};
  if (trial.message.empty()) {
    json["seconds"] = run_seconds(scene, simulation, trial);
  } else {
    json["message"] = trial.message;
  }
  return json;
}

Json overlaps(const Simulation& simulation) {
  Json pairs = Json::array();
  for (const PairDepth& pair : simulation.overlaps()) {
    pairs.push_back(
        {{"bodies", {simulation.model().name_of(pair.a), simulation.model().name_of(pair.b)}},
         {"depth", pair.depth},
         {"of_inradius", pair.share}});
  }
  return {{"pairs", pairs}, {"energy", simulation.energies().contact}};
}

Json depth(const Model& model, const ExpectedDepth& expected) {
  if (expected.body < 0) return nullptr;
  return {{"body", model.name_of(expected.body)},
          {"flat", expected.depth},
          {"corner", expected.corner > 0 ? Json(expected.corner) : Json()},
          {"of_inradius", expected.share}};
}

}  // namespace

PlanEstimates estimates_of(const Scene& scene) {
  constexpr double kTrial = 0.3;  // s
  const Model& model = scene.model;
  const OutputSettings& output = scene.output;
  PlanEstimates estimates;
  if (!scene.time.statics) estimates.trial = try_steps(scene, 1, kTrial);
  estimates.damped =
      model.contact.damping.normal > 0 || model.contact.mass_damping > 0 ||
      std::ranges::any_of(model.contact.rules,
                          [](const ContactRule& r) { return r.damping.has_value(); }) ||
      std::ranges::any_of(model.materials, [](const Material& m) {
        return m.mass_damping > 0 || m.stiffness_damping > 0;
      });
  estimates.dissipates = estimates.damped || model.contact.friction.coefficient > 0 ||
                         std::ranges::any_of(model.contact.rules, [](const ContactRule& r) {
                           return r.friction && r.friction->coefficient > 0;
                         });
  estimates.empty_history = scene.model.regions.empty() && output.track.empty() &&
                            output.track_deformables.empty() && output.points.empty() &&
                            output.track_surfaces.empty();
  estimates.warnings = scene.warnings;
  std::ranges::move(unlikely_values(scene), std::back_inserter(estimates.warnings));
  return estimates;
}

Phases phases_of(const Scene& scene, const Simulation& simulation, bool dissipates) {
  Phases phases;
  if (scene.time.scheme != TimeScheme::automatic) return phases;
  const QuietMotion quiet(scene.model, simulation.degrees_of_freedom(), scene.time.accuracy);
  const double step = simulation.step_size();
  const double landing = simulation.forecast().last_landing;
  // A body that sets out to fall hardly moves at first.
  phases.from_start =
      landing <= QuietMotion::kSteps * step && quiet.holds(simulation.state(), step);
  if (phases.from_start) {
    phases.text =
        "implicit steps from the start, where no body moves noticeably; velocity Verlet once one "
        "does";
    return phases;
  }
  phases.until = landing;
  phases.text = "velocity Verlet while bodies move";
  if (phases.until > 0) {
    phases.text +=
        fmt::format(", at least to t = {:.3g} s, when the last one has fallen", phases.until);
  }
  phases.text += dissipates ? "; implicit steps where they have come to rest"
                            : "; nothing takes the energy of impacts, so that they may never rest";
  return phases;
}

double run_seconds(const Scene& scene, const Simulation& simulation, const Trial& trial) {
  const double steps = std::ceil(scene.time.end / simulation.step_choice().step);
  return steps * trial.seconds / static_cast<double>(trial.steps);
}

std::string plan_json(const Scene& scene, const Simulation& simulation,
                      const PlanEstimates& estimates, const OutputCost& cost) {
  const Model& model = scene.model;
  Json terms = Json::array(), settings = Json::object();
  for (const auto& term : simulation.terms()) terms.push_back(term->describe());
  for (const Setting& s : scene.settings) settings[s.path] = Json::parse(s.value);
  int elements = 0;
  for (const DeformableBody& body : model.deformables) elements += body.mesh.element_count();
  Json json{{"name", model.name},      {"scene", scene.file},
            {"set", settings},         {"mode", scene.time.statics ? "static" : "dynamic"},
            {"end", scene.time.end},   {"gravity", {model.gravity.x(), model.gravity.y()}},
            {"bodies", bodies(model)}, {"imports", imports(scene)},
            {"elements", elements},    {"nodes", model.node_count()}};
  for (const LoadHistory::Point& p : model.gravity_history.points) {
    json["gravity_history"].push_back({p.time, p.factor});
  }
  if (scene.time.statics) {
    json["load_steps"] =
        scene.time.automatic_load_steps ? Json("auto") : Json(scene.time.load_steps);
    json["rigid"] = scene.rigid;
    json["tolerance"] = scene.time.tolerance;
  } else {
    json["time_step"] = time_step(scene, simulation);
  }
  if (model.contact.penetration) json["normal_stiffness"] = model.contact.normal_stiffness;
  json["contacts_at_start"] = simulation.counts().touching_now;
  json["terms"] = terms;
  json["output"] = output(scene.output, cost);
  if (const Phases phases = phases_of(scene, simulation, estimates.dissipates);
      !phases.text.empty()) {
    json["phases"] = {{"implicit_from_start", phases.from_start}, {"verlet_until", phases.until}};
  }
  if (estimates.trial) json["run_time"] = run_time(scene, simulation, *estimates.trial);
  const Forecast forecast = simulation.forecast();
  json["expected_penetration"] = {{"by_weight", depth(model, forecast.by_weight)},
                                  {"by_speed", depth(model, forecast.by_speed)}};
  json["overlaps_at_start"] = overlaps(simulation);
  json["damped"] = estimates.damped;
  json["empty_history"] = estimates.empty_history;
  json["warnings"] = estimates.warnings;
  json["expectations"] = scene.expectations.size();
  return json.dump(2, ' ', false, Json::error_handler_t::replace);
}

}  // namespace apothem
