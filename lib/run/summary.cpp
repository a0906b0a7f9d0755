#include "lib/run/summary.hpp"

#include <array>
#include <nlohmann/json.hpp>

#include "lib/dynamics/islands.hpp"
#include "lib/output/files.hpp"
#include "lib/run/hash.hpp"
#include "lib/run/other_run.hpp"
#include "lib/run/run.hpp"
#include "version.hpp"

namespace apothem {
namespace {

using Json = nlohmann::ordered_json;

// In the order of Run::Status.
constexpr std::array kStatusNames{"running", "done", "interrupted", "unstable", "failed"};

Json wall_time(const Run& run, double seconds) {
  Json parts;
  const PhaseSeconds phases = run.simulation().phase_seconds();
  for (size_t i = 0; i < phases.size(); ++i) parts[kPhaseNames[i]] = phases[i];
  parts["output"] = run.output_seconds();
  parts["total"] = seconds;
  return parts;
}

void add_peaks(Json& json, const Run& run) {
  const Model& model = run.scene().model;
  const auto where = [&](const Peak& p) {
    std::vector<std::string> names;
    if (p.a >= 0) names = {model.name_of(p.a), model.name_of(p.b)};
    return Json{{"time", p.time}, {"bodies", names}};
  };
  const Extremes extremes = run.simulation().extremes();
  json["largest_penetration"] = extremes.penetration.value;
  json["largest_penetration_at"] = where(extremes.penetration);
  const Peak& relative = extremes.relative_penetration;
  json["largest_relative_penetration"] = relative.value;
  json["largest_relative_penetration_at"] = where(relative);
  json["largest_contact_force"] = extremes.force.value;
  json["largest_contact_force_at"] = where(extremes.force);
  json["largest_energy_error"] = extremes.energy_error;
  json["energy_in_play"] = extremes.energy_in_play;
}

void add_load_steps(Json& json, const Run& run) {
  const Model& model = run.scene().model;
  json.erase("steps_per_second");
  json["stability_limit"] = nullptr;
  Json& found = json["load_steps"] = Json::array();
  for (const LoadStep& s : run.load_steps()) {
    found.push_back({{"time", s.time},
                     {"iterations", s.iterations},
                     {"method", s.relaxed ? "relaxation" : "newton"},
                     {"negative_pivots", s.negative_pivots < 0 ? Json() : Json(s.negative_pivots)},
                     {"residual", s.residual},
                     {"imbalance", s.imbalance},
                     {"of", model.name_of(s.worst)}});
  }
  Json& balance = json["balance"] = Json::array();
  if (run.load_steps().empty()) return;
  const LoadStep& last = run.load_steps().back();
  for (size_t i = 0; i < last.off.size(); ++i) {
    if (i < model.bodies.size() && model.bodies[i].motion != Motion::free) continue;
    balance.push_back({{"body", model.name_of(static_cast<BodyIndex>(i))},
                       {"force", last.off[i]},
                       {"of_load", imbalance_of_load(last, i)}});
  }
}

Json collapse(const Run& run) {
  const Collapse& c = *run.collapse();
  const Model& model = run.scene().model;
  Json bodies = Json::array();
  for (const MovingBody& b : moving_bodies(model, run.state(), c.motion)) {
    bodies.push_back({{"body", model.name_of(b.body)}, {"x", b.x}, {"y", b.y}, {"angle", b.angle}});
  }
  return {{"factor", c.factor()},
          {"lower", c.factor() - c.error()},
          {"upper", c.factor() + c.error()},
          {"mechanism", c.frame < 0 ? Json() : Json(c.frame)},
          {"scale", c.scale},
          {"bodies", std::move(bodies)}};
}

Json rigid_limit(const Run& run) {
  const RigidLimit& limit = run.rigid_limit();
  Json passes = Json::array();
  for (const RigidPass& pass : limit.passes) {
    Json entry{{"normal_stiffness", pass.stiffness}, {"collapse", nullptr}};
    if (pass.collapsed) {
      entry["collapse"] = {{"factor", pass.factor()}, {"lower", pass.lower}, {"upper", pass.upper}};
    }
    passes.push_back(std::move(entry));
  }
  return {{"change", limit.collapses() ? Json() : Json(limit.change)},
          {"passes", std::move(passes)}};
}

Json settings(const Scene& scene) {
  Json json = Json::object();
  for (const Setting& s : scene.settings) json[s.path] = Json::parse(s.value);
  return json;
}

Json beginning(const Run& run) {
  const Beginning& start = run.beginning();
  return {{"folder", start.folder},
          {"time", start.time},
          {"bodies", start.bodies.size()},
          {"others", not_moved(run.scene().model, start)}};
}

Json expectations(const Run& run) {
  Json list = Json::array();
  for (size_t i = 0; i < run.outcomes().size(); ++i) {
    const Expectation& e = run.scene().expectations[i];
    list.push_back({{"label", e.label},
                    {"quantity", e.quantity},
                    {"take", kTakes[static_cast<size_t>(e.take)]},
                    {"unit", e.unit},
                    {"basis", e.basis ? Json(kBases[static_cast<size_t>(*e.basis)]) : Json()},
                    {"source", e.source},
                    {"expected", e.value},
                    {"tolerance", e.tolerance},
                    {"value", run.outcomes()[i].value},
                    {"met", run.outcomes()[i].met}});
  }
  return list;
}

// Null where a measure has no value.
Json measures(const Run& run) {
  Json values = Json::object();
  const std::vector<Measure>& measures = run.scene().measures;
  for (size_t i = 0; i < measures.size(); ++i) {
    Json& value = values[measures[i].name] = nullptr;
    if (i >= run.measures().size()) continue;
    if (measures[i].stopped_by.empty()) {
      value = run.measures()[i];
    } else {
      value = run.measures()[i] > 0;
    }
  }
  return values;
}

Json step_changes(const Run& run) {
  const StepChanges& changes = run.simulation().step_changes();
  Json list = Json::array();
  for (const StepChange& c : changes.first) {
    Json entry{{"t", c.time}, {"step", c.step}, {"dt", c.size}, {"body", nullptr}};
    if (c.body >= 0) entry["body"] = run.scene().model.name_of(c.body);
    list.push_back(std::move(entry));
  }
  return {{"shortened", changes.shortened},
          {"lengthened", changes.lengthened},
          {"smallest_dt", changes.shortest},
          {"first", std::move(list)}};
}

}  // namespace

double imbalance_of_load(const LoadStep& step, size_t body) {
  return step.load > 0 ? step.off[body] / step.load : 0;
}

std::string summary_text(const Run& run) {
  const Scene& scene = run.scene();
  const Simulation& simulation = run.simulation();
  const State& state = run.state();
  const ContactCounts counts = simulation.counts();
  const double steps = std::max(static_cast<double>(state.step), 1.0);
  const double wall = run.seconds();
  Json json{{"name", scene.model.name},
            {"scene", scene.file},
            {"scene_hash", run.hash_of_scene()},
            {"set", settings(scene)},
            {"version", kVersion},
            {"status", kStatusNames[static_cast<size_t>(run.status())]},
            {"stopped_by", nullptr},
            {"threads", run.settings().threads},
            {"time", state.time},
            {"steps", state.step},
            {"dt", simulation.step_size()},
            {"dt_limited_by", scene.time.fixed_step ? "time.step of the scene"
                                                    : simulation.step_choice().limit.reason},
            {"stability_limit", simulation.step_choice().stability},
            {"dt_changes", step_changes(run)},
            {"steps_per_second", static_cast<double>(simulation.own_steps()) / wall},
            {"wall_time", wall_time(run, wall)},
            {"processor_time", run.processor_seconds()},
            {"pairs_per_step",
             {{"candidates", static_cast<double>(counts.candidate_pairs) / steps},
              {"touching", static_cast<double>(counts.touching_pairs) / steps}}},
            {"searches", counts.searches}};
  if (const ImplicitCounts* implicit = simulation.implicit_counts()) {
    json["implicit"] = {{"steps", implicit->steps},
                        {"in_place_of", implicit->ticks},
                        {"phases", implicit->phases},
                        {"rejected", implicit->rejected},
                        {"iterations", implicit->iterations},
                        {"numerical_loss", simulation.energies().numerical_loss}};
  }
  if (const Islands* islands = simulation.islands()) {
    json["resting"] = {
        {"bodies", islands->count()}, {"stopped", islands->stopped()}, {"woken", islands->woken()}};
  }
  const ContactLaw& law = scene.model.contact;
  if (law.penetration) json["normal_stiffness"] = law.normal_stiffness;
  if (const std::optional<double> share = run.quiet_share()) json["at_rest"] = *share;
  if (!run.beginning().folder.empty()) json["from"] = beginning(run);
  add_peaks(json, run);
  json["final_state_hash"] = state_hash(state);
  if (scene.time.statics) add_load_steps(json, run);
  if (scene.rigid) json["rigid"] = rigid_limit(run);
  if (run.collapse()) json["collapse"] = collapse(run);
  if (!run.message().empty()) json["message"] = run.message();
  json["warnings"] = run.warnings();
  json["expectations"] = expectations(run);
  if (!run.stopped_by().empty()) json["stopped_by"] = run.stopped_by();
  if (!run.scene().measures.empty()) json["measures"] = measures(run);
  if (const Population* population = simulation.population()) {
    json["bodies_come"] = population->come();
    json["bodies_left"] = population->left();
  }
  // JSON knows no infinity: where nothing limits the step, the limit is null.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

void write_summary(const Run& run) {
  write_file(run.settings().folder + "/run.json", summary_text(run), Lasting::yes);
}

}  // namespace apothem
