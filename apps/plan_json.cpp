#include "plan_json.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

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

Json deformable_body(const Model& model, const DeformableBody& body) {
  return {{"name", body.name},
          {"kind", "deformable"},
          {"material", model.materials[static_cast<size_t>(body.material)].name},
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

// JSON knows no infinity: where nothing limits the step, the limit is null.
Json time_step(const Scene& scene, const Simulation& simulation) {
  const StepChoice& choice = simulation.step_choice();
  return {{"step", choice.step},
          {"automatic", !scene.time.fixed_step.has_value()},
          {"limited_by", choice.limit.reason},
          {"stability_limit", choice.stability},
          {"steps", std::ceil(scene.time.end / choice.step)}};
}

Json output(const OutputSettings& settings, double end) {
  Json json{{"frames", settings.frames + 1},
            {"tracked_bodies", settings.track.size() + settings.track_deformables.size()},
            {"tracked_points", settings.points.size()},
            {"history_interval", settings.history_interval.value_or(end / 1000)}};
  json["checkpoint_interval"] =
      settings.checkpoint_interval ? Json(*settings.checkpoint_interval) : Json();
  return json;
}

}  // namespace

std::string plan_json(const Scene& scene, const Simulation& simulation) {
  const Model& model = scene.model;
  Json terms = Json::array(), settings = Json::object();
  for (const auto& term : simulation.terms()) terms.push_back(term->describe());
  for (const Setting& s : scene.settings) settings[s.path] = Json::parse(s.value);
  int elements = 0;
  for (const DeformableBody& body : model.deformables) elements += body.mesh.element_count();
  Json json{{"name", model.name},
            {"scene", scene.file},
            {"set", settings},
            {"mode", scene.time.statics ? "static" : "dynamic"},
            {"end", scene.time.end},
            {"gravity", {model.gravity.x(), model.gravity.y()}},
            {"bodies", bodies(model)},
            {"elements", elements},
            {"nodes", model.node_count()}};
  if (scene.time.statics) {
    json["load_steps"] = scene.time.load_steps;
    json["tolerance"] = scene.time.tolerance;
  } else {
    json["time_step"] = time_step(scene, simulation);
  }
  json["contacts_at_start"] = simulation.counts().touching_now;
  json["terms"] = terms;
  json["output"] = output(scene.output, scene.time.end);
  json["expectations"] = scene.expectations.size();
  return json.dump(2, ' ', false, Json::error_handler_t::replace);
}

}  // namespace apothem
