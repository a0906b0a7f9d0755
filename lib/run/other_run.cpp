#include "lib/run/other_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lib/output/files.hpp"
#include "lib/run/json_archive.hpp"
#include "lib/run/sealed_file.hpp"

namespace apothem {
namespace {

constexpr double kSameTime = 1e-6;  // of the time

// What contacts remember, as it stands in a file: in one of the terms of the simulation, if there
// is contact.
FrictionMemory memory_in(const nlohmann::json& simulation) {
  FrictionMemory memory;
  for (const auto& [name, term] : simulation.items()) {
    if (name.starts_with("term_") && term.is_object() && term.contains("contacts")) {
      const nlohmann::json& contacts = term["contacts"];
      JsonLoader archive(contacts);
      archive("friction", memory);
      if (!contacts.contains("resting")) continue;
      FrictionMemory of_resting;
      JsonLoader resting(contacts["resting"]);
      resting("friction", of_resting);
      memory.absorb(of_resting);
    }
  }
  return memory;
}

}  // namespace

OtherRun::OtherRun(const std::string& folder, std::optional<double> time) {
  beginning_.folder = folder;
  std::string file = state_file(folder, StateFile::final);
  if (!file_exists(file)) file = state_file(folder, StateFile::checkpoint);
  if (!file_exists(file)) {
    throw SceneError(folder,
                     "holds no state of a run, neither final.json nor checkpoint.json; give the "
                     "folder of a run that is done or was stopped");
  }
  try {
    load(file);
  } catch (const nlohmann::json::exception& bad) {
    throw SceneError(file, std::string("is not the state of a run: ") + bad.what());
  } catch (const ArchiveMismatch& bad) {
    throw SceneError(file, std::string("is damaged: ") + bad.what());
  }
  beginning_.time = state_.time;
  if (time && !(std::abs(*time - state_.time) <= kSameTime * std::abs(state_.time))) {
    throw SceneError(
        file,
        fmt::format("is the state at t = {} s; to begin at t = {} s is not supported yet, because "
                    "frames hold no whole state: run the other scene --until that time",
                    state_.time, *time));
  }
}

void OtherRun::load(const std::string& file) {
  const nlohmann::json json = nlohmann::json::parse(read_sealed(file));
  JsonLoader archive(json);
  archive("model", record_);
  state_ = State(record_.layout());
  const nlohmann::json& simulation = json.at("simulation");
  if (simulation.at("state").contains("absent")) state_.absent.resize(record_.bodies.size());
  JsonLoader of_simulation(simulation);
  of_simulation("state", state_);
  // The time of a static run is that of its load histories: the velocities of what it drives are
  // none that bodies have.
  if (simulation.contains("equilibrium")) std::ranges::fill(state_.v, 0.);
  memory_ = memory_in(simulation);
}

Beginning OtherRun::move_into(Scene& scene) {
  Inheritance found = inheritance(record_, state_, scene.model);
  if (found.starts.empty()) {
    throw SceneError(
        beginning_.folder,
        fmt::format("has no body of the same name and shape as one of {}", scene.file));
  }
  if (scene.time.statics || scene.time.settled) {  // nothing moves there
    for (BodyStart& start : found.starts) std::ranges::fill(start.v, 0.);
  }
  begin_at(scene.model, found.starts);
  heirs_ = std::move(found.heirs);
  beginning_.bodies = std::move(found.starts);
  return beginning_;
}

void OtherRun::hand_contacts_to(Simulation& simulation) const {
  const ContactNumbers numbers = simulation.contact_numbers();
  const bool both = !numbers.bodies.empty() && !record_.contacts.bodies.empty();
  simulation.inherit(both ? map_memory(memory_, record_.contacts, numbers, heirs_)
                          : FrictionMemory());
}

std::vector<std::string> not_moved(const Model& model, const Beginning& beginning) {
  std::vector<std::string> names;
  std::vector<bool> moved(model.bodies.size() + model.deformables.size());
  for (const BodyStart& start : beginning.bodies) moved[static_cast<size_t>(start.body)] = true;
  for (size_t i = 0; i < moved.size(); ++i) {
    if (!moved[i]) names.push_back(model.name_of(static_cast<BodyIndex>(i)));
  }
  return names;
}

}  // namespace apothem
