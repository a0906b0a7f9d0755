// Which features of a scene go together: every row of the table is tried, and the documentation
// shows the same table.
#include "lib/scene/compatibility.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <sstream>

#include "lib/scene/scene.hpp"
#include "tests/folder.hpp"
#include "tests/support.hpp"

using namespace apothem;
using test::Folder;
using Json = nlohmann::json;

namespace {

const char* const kRigid = R"({
  "materials": { "rock": { "density": 2000 } },
  "contact": { "normal_stiffness": 1e9 },
  "bodies": [
    { "name": "floor", "material": "rock", "motion": "fixed",
      "polygon": [[0, -2], [2, 0], [-2, 0]] },
    { "name": "stone", "material": "rock", "polygon": [[0, 1], [1, 2], [-1, 2]] } ],
  "time": { "end": 1 } })";

const char* const kMeshed = R"({
  "materials": { "rock": { "density": 2000, "young": 1e9, "poisson": 0.2 } },
  "contact": { "normal_stiffness": 1e9 },
  "bodies": [
    { "name": "floor", "material": "rock", "motion": "fixed",
      "polygon": [[0, -2], [2, 0], [-2, 0]] },
    { "name": "block", "material": "rock",
      "mesh": { "rectangle": { "size": [1, 1], "cells": [1, 1], "origin": [0, 1] } } } ],
  "time": { "end": 1 } })";

const char* const kStatic = R"({
  "materials": { "rock": { "density": 2000, "young": 1e9, "poisson": 0.2 } },
  "contact": { "normal_stiffness": 1e9 },
  "bodies": [
    { "name": "floor", "material": "rock", "motion": "fixed",
      "polygon": [[0, -2], [2, 0], [-2, 0]] },
    { "name": "block", "material": "rock",
      "mesh": { "rectangle": { "size": [1, 1], "cells": [1, 1], "origin": [0, 1] } } } ],
  "time": { "end": 1, "mode": "static" } })";

struct Change {
  const char* pointer;
  const char* value;
};

// A scene that uses both features of a row. Without the last change it is accepted.
struct FeatureTrial {
  Feature asked, with;
  const char* scene;
  std::vector<Change> changes;
  const char* place;  // JSON pointer of the error
};

using F = Feature;
const char* const kMotion = R"({ "velocity": [[0, 1, 0]] })";
const char* const kMassDamping = R"({ "model": "mass", "rate": 1 })";
const char* const kRepeatedFill =
    R"([ { "name": "pebble", "material": "rock", "region": [[5, 5], [9, 5], [9, 9]], "count": 2,
           "shapes": [ { "cross": {} } ], "diameter": 0.1, "repeat": { "times": 2 } } ])";
const std::vector<FeatureTrial> kTrials{
    {F::servo,
     F::static_run,
     kStatic,
     {{"/bodies/0/motion", R"({ "servo": { "direction": [0, 1], "force": 1, "speed": 1 } })"}},
     "/bodies/0/motion/servo"},
    {F::inflow, F::static_run, kStatic, {{"/fill", kRepeatedFill}}, "/fill"},
    {F::inflow,
     F::settled_start,
     kRigid,
     {{"/time/start", "\"settled\""}, {"/fill", kRepeatedFill}},
     "/fill"},
    {F::outside,
     F::static_run,
     kStatic,
     {{"/world", R"({ "box": [[-9, -9], [9, 9]], "outside": "remove" })"}},
     "/world/outside"},
    {F::stop_rule,
     F::static_run,
     kStatic,
     {{"/stop", R"([ { "name": "few", "count_below": 1 } ])"}},
     "/stop"},
    {F::field,
     F::area_potential,
     kRigid,
     {{"/contact/potential", "\"area\""}, {"/contact/field", "\"roof\""}},
     "/contact/field"},
    {F::reference,
     F::area_potential,
     kRigid,
     {{"/contact/potential", "\"area\""}, {"/contact/reference", "0.5"}},
     "/contact/reference"},
    {F::polygon_beyond_triangle,
     F::area_potential,
     kRigid,
     {{"/contact/potential", "\"area\""},
      {"/bodies/1/polygon", "[[0, 1], [1, 1], [1, 2], [0, 2]]"}},
     "/bodies/1/polygon/3"},
    {F::resultant_distribution,
     F::body_surface,
     kMeshed,
     {{"/contact/distribution", "\"resultant\""}},
     "/contact/distribution"},
    {F::integrated_distribution,
     F::body_surface,
     kMeshed,
     {{"/contact/surface", "\"body\""}, {"/contact/distribution", "\"integrated\""}},
     "/contact/distribution"},
    {F::variational_distribution,
     F::element_surface,
     kMeshed,
     {{"/contact/surface", "\"element\""}, {"/contact/distribution", "\"variational\""}},
     "/contact/distribution"},
    {F::self_contact,
     F::element_surface,
     kMeshed,
     {{"/contact/surface", "\"element\""}, {"/contact/self_contact", "\"compute\""}},
     "/contact/self_contact"},
    {F::fixed_motion,
     F::body_with_mesh,
     kMeshed,
     {{"/bodies/1/motion", "\"fixed\""}},
     "/bodies/1/motion"},
    {F::prescribed_motion,
     F::body_with_mesh,
     kMeshed,
     {{"/bodies/1/motion", kMotion}},
     "/bodies/1/motion"},
    {F::element_materials,
     F::rigid_body,
     kRigid,
     {{"/bodies/1/materials", R"({ "core": "rock" })"}},
     "/bodies/1/materials"},
    {F::initial_velocity,
     F::fixed_motion,
     kRigid,
     {{"/bodies/1/spin", "1"}, {"/bodies/0/velocity", "[0, 0]"}},
     "/bodies/0/velocity"},
    {F::initial_velocity,
     F::prescribed_motion,
     kRigid,
     {{"/bodies/1/motion", kMotion}, {"/bodies/1/spin", "1"}},
     "/bodies/1/spin"},
    {F::held_coordinates,
     F::fixed_motion,
     kRigid,
     {{"/bodies/1/fix", "[\"x\"]"}, {"/bodies/0/fix", "[\"x\"]"}},
     "/bodies/0/fix"},
    {F::held_coordinates,
     F::prescribed_motion,
     kRigid,
     {{"/bodies/1/motion", kMotion}, {"/bodies/1/fix", "[\"angle\"]"}},
     "/bodies/1/fix"},
    {F::time_step, F::static_run, kStatic, {{"/time/step", "\"auto\""}}, "/time/step"},
    {F::safety, F::static_run, kStatic, {{"/time/safety", "0.1"}}, "/time/safety"},
    {F::accuracy, F::static_run, kStatic, {{"/time/accuracy", "1e-3"}}, "/time/accuracy"},
    {F::accuracy,
     F::fixed_step,
     kRigid,
     {{"/time/step", "1e-4"}, {"/time/accuracy", "1e-3"}},
     "/time/accuracy"},
    {F::accuracy,
     F::safety,
     kRigid,
     {{"/time/safety", "0.1"}, {"/time/accuracy", "1e-3"}},
     "/time/accuracy"},
    {F::onsets, F::static_run, kStatic, {{"/time/onsets", R"("plain")"}}, "/time/onsets"},
    {F::scheme, F::static_run, kStatic, {{"/time/scheme", R"("auto")"}}, "/time/scheme"},
    {F::servo,
     F::implicit_steps,
     kRigid,
     {{"/bodies/0/motion", R"({"servo": {"direction": [0, 1], "force": 10, "speed": 1}})"},
      {"/time/scheme", R"("auto")"}},
     "/bodies/0/motion/servo"},
    {F::element_surface,
     F::implicit_steps,
     kMeshed,
     {{"/contact/surface", R"("element")"}, {"/time/scheme", R"("implicit")"}},
     "/contact/surface"},
    {F::contact_damping,
     F::implicit_scheme,
     kRigid,
     {{"/contact/damping", R"({"model": "viscous", "ratio": 0.1})"},
      {"/time/scheme", R"("implicit")"}},
     "/contact/damping"},
    {F::automatic_scheme,
     F::fixed_step,
     kRigid,
     {{"/time/step", "1e-6"}, {"/time/scheme", R"("auto")"}},
     "/time/scheme"},
    {F::start, F::static_run, kStatic, {{"/time/start", "\"as_given\""}}, "/time/start"},
    {F::load_steps, F::dynamic_run, kMeshed, {{"/time/load_steps", "4"}}, "/time/load_steps"},
    {F::rigid_limit, F::dynamic_run, kRigid, {{"/contact/rigid", "true"}}, "/contact/rigid"},
    {F::rigid_limit,
     F::counted_load_steps,
     kRigid,
     {{"/contact/rigid", "true"}, {"/time/mode", "\"static\""}, {"/time/load_steps", "4"}},
     "/contact/rigid"},
    {F::contact_penetration,
     F::static_run,
     kRigid,
     {{"/gravity", "[0, -9.81]"},
      {"/contact", R"({"penetration": 0.01})"},
      {"/time/mode", "\"static\""}},
     "/contact/penetration"},
    {F::contact_penetration,
     F::element_surface,
     kMeshed,
     {{"/gravity", "[0, -9.81]"}, {"/contact", R"({"penetration": 0.01, "surface": "element"})"}},
     "/contact/penetration"},
    {F::tolerance, F::dynamic_run, kMeshed, {{"/time/tolerance", "1e-6"}}, "/time/tolerance"},
    {F::safety,
     F::fixed_step,
     kRigid,
     {{"/time/step", "1e-4"}, {"/time/safety", "0.1"}},
     "/time/safety"},
    {F::initial_velocity,
     F::settled_mesh,
     kMeshed,
     {{"/time/start", "\"settled\""}, {"/bodies/1/velocity", "[0, 0]"}},
     "/bodies/1/velocity"},
    {F::element_surface,
     F::settled_mesh,
     kMeshed,
     {{"/contact/surface", "\"element\""}, {"/time/start", "\"settled\""}},
     "/contact/surface"},
    {F::initial_velocity,
     F::static_run,
     kStatic,
     {{"/bodies/1/velocity", "[0, 0]"}},
     "/bodies/1/velocity"},
    {F::material_damping,
     F::static_run,
     kStatic,
     {{"/materials/rock/damping", R"({ "model": "rayleigh", "mass": 1 })"}},
     "/materials/rock/damping"},
    {F::contact_damping,
     F::static_run,
     kStatic,
     {{"/contact/damping", kMassDamping}},
     "/contact/damping"},
    {F::element_surface,
     F::static_run,
     kStatic,
     {{"/contact/surface", "\"body\""}, {"/contact/surface", "\"element\""}},
     "/contact/surface"},
    {F::frames, F::static_run, kStatic, {{"/output/frames", "5"}}, "/output/frames"},
    {F::history_interval,
     F::static_run,
     kStatic,
     {{"/output/history/interval", "0.1"}},
     "/output/history/interval"},
    {F::per_edge_friction,
     F::mesh_in_every_contact,
     kMeshed,
     {{"/contact/friction",
       R"({ "coefficient": 1, "tangential_stiffness": 1e9, "law": "resultant" })"},
      {"/contact/friction/law", "\"per_edge\""}},
     "/contact/friction/law"},
    {F::viscous_damping,
     F::per_edge_friction,
     kRigid,
     {{"/contact/friction",
       R"({ "coefficient": 1, "tangential_stiffness": 1e9, "law": "per_edge" })"},
      {"/contact/damping", R"({ "model": "viscous", "ratio": 0.1 })"}},
     "/contact/damping/ratio"},
    {F::area_potential,
     F::outline_in_every_contact,
     kMeshed,
     {{"/contact/potential", "\"area\""}},
     "/contact/potential"},
    {F::tracked_point,
     F::rigid_body,
     kMeshed,
     {{"/output/history/track", R"([ { "body": "block", "point": [0.5, 1.5] } ])"},
      {"/output/history/track/0/body", "\"floor\""}},
     "/output/history/track/0/point"},
    {F::tracked_surface,
     F::rigid_body,
     kMeshed,
     {{"/output/history/track", R"([ { "body": "block", "surface": "contact" } ])"},
      {"/output/history/track/0/body", "\"floor\""}},
     "/output/history/track/0/surface"},
    {F::tracked_surface,
     F::element_surface,
     kMeshed,
     {{"/output/history/track", R"([ { "body": "block", "surface": "contact" } ])"},
      {"/contact/surface", "\"element\""}},
     "/output/history/track/0/surface"},
};

std::string error_of(const Json& scene) {
  const Folder folder;
  const std::string file = folder.write("scene.json", scene.dump());
  try {
    read_scene(file);
  } catch (const SceneError& error) {
    return std::string(error.what()).substr(file.size());
  }
  return "";
}

void apply(Json& scene, const Change& change) {
  scene[Json::json_pointer(change.pointer)] = Json::parse(change.value);
}

// The table as docs/scene-format.md shows it.
std::string markdown() {
  std::string text =
      "| feature | verdict | combination | reason | what to do instead |\n"
      "| --- | --- | --- | --- | --- |\n";
  for (const Incompatibility& pair : kIncompatible) {
    for (const std::string_view cell : {text_of(pair.asked).what, text_of(pair.refusal),
                                        text_of(pair.with).where, pair.why, pair.instead}) {
      text += "| " + std::string(cell) + " ";
    }
    text += "|\n";
  }
  return text;
}

}  // namespace

TEST_CASE("every pair of features that do not go together is refused", "[scene]") {
  for (const Incompatibility& pair : kIncompatible) {
    INFO(text_of(pair.asked).what << " " << text_of(pair.with).where);
    const auto trial = std::find_if(kTrials.begin(), kTrials.end(), [&](const FeatureTrial& t) {
      return t.asked == pair.asked && t.with == pair.with;
    });
    REQUIRE(trial != kTrials.end());
    Json scene = Json::parse(trial->scene);
    for (size_t i = 0; i + 1 < trial->changes.size(); ++i) apply(scene, trial->changes[i]);
    CHECK(error_of(scene) == "");
    apply(scene, trial->changes.back());
    CHECK(error_of(scene) == ":1: " + std::string(trial->place) + ": " + message_of(pair));
  }
  CHECK(kTrials.size() == kIncompatible.size());
}

TEST_CASE("an unsupported pair is called so, with a remedy", "[scene]") {
  for (const Incompatibility& pair : kIncompatible) {
    const std::string message = message_of(pair);
    INFO(message);
    CHECK((message.find("not supported yet") != std::string::npos) ==
          (pair.refusal == Refusal::not_supported_yet));
    CHECK(message.ends_with("; " + std::string(pair.instead)));
    // It is a row of a table in Markdown, too.
    CHECK(message.find('|') == std::string::npos);
  }
}

TEST_CASE("what is for rigid bodies only may stand where two of them can meet", "[scene]") {
  for (const Change& change :
       {Change{"/contact/potential", "\"area\""},
        {"/contact/friction",
         R"({ "coefficient": 1, "tangential_stiffness": 1e9, "law": "per_edge" })"}}) {
    INFO(change.pointer);
    Json scene = Json::parse(kMeshed);
    apply(scene, change);
    CHECK(error_of(scene).find("fewer than two are rigid") != std::string::npos);
    scene["bodies"].push_back(Json::parse(kRigid)["bodies"][1]);
    CHECK(error_of(scene) == "");
  }
}

TEST_CASE("a distribution goes with the surface it belongs to, and with no other", "[scene]") {
  for (const NamedDistribution& distribution : kDistributions) {
    for (const NamedSurface& surface : kSurfaces) {
      INFO(distribution.name << " " << surface.name);
      Json scene = Json::parse(kMeshed);
      scene["contact"]["surface"] = surface.name;
      scene["contact"]["distribution"] = distribution.name;
      CHECK(error_of(scene).empty() == (distribution.surface == surface.surface));
    }
  }
}

TEST_CASE("the documentation shows the table of what does not go together", "[scene]") {
  const std::string document = test::content(test::kSource + "/docs/scene-format.md");
  const std::string table = markdown();
  INFO("docs/scene-format.md must contain exactly this table:\n" << table);
  std::istringstream rows(table);
  for (std::string row; std::getline(rows, row);) {
    INFO(row);
    CHECK(document.find("\n" + row + "\n") != std::string::npos);
  }
  CHECK(document.find("\n\n" + table + "\n") != std::string::npos);
}
