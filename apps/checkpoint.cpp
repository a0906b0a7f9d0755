#include "checkpoint.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "apothem/output/files.hpp"
#include "apothem/scene/json.hpp"

namespace nlohmann {

template <>
struct adl_serializer<apothem::Vec2> {
  static void to_json(json& j, const apothem::Vec2& v) { j = json::array({v.x(), v.y()}); }
  static void from_json(const json& j, apothem::Vec2& v) {
    v = apothem::Vec2(j.at(0).get<double>(), j.at(1).get<double>());
  }
};

}  // namespace nlohmann

namespace apothem {

// nlohmann's macro lists each member once for both directions; numbers read back to the same
// double.
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(State, time, step, position, remainder, velocity, force,
                                   displacement, node_velocity, node_force)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(DeformableBalance, load_work, mass_damping_loss,
                                   summed_damping_loss, damping_power)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(EquilibriumMemory, outside, loads, body_loads)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(LoadStep, time, iterations, residual, imbalance, worst, load,
                                   off)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(EdgeSlip, edge, partner, spring, stiffness)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(SlipMemory, slips, energy, friction_loss)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Impulse, x, y, angular)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Balance, initial_energy, initial, impulse, external_work)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Peak, value, time, a, b)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Extremes, penetration, force, energy_error)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Counts, searches, candidate_pairs, touching_pairs, touching_now)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(BoxPair, first, second)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(PairMemory, pair, patches, runs, springs)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(PatchMemory, spring, tangent, normal, moment_a, moment_b,
                                   damping, damping_a, damping_b)
// What matching patches needs; the next step makes the rest anew.
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(BoundaryRun, of_a, edge, patch, from, to, length)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(EdgeSpring, of_a, edge, spring)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(TangentialMemory, pairs, patches, runs, springs, energy,
                                   friction_loss, damping_loss)

namespace {

std::string file(const std::string& folder) { return folder + "/checkpoint.json"; }

}  // namespace

void write_checkpoint(const std::string& folder, const Checkpoint& checkpoint) {
  const Snapshot& s = checkpoint.snapshot;
  nlohmann::json json{{"scene_hash", checkpoint.scene_hash},
                      {"history_sizes", checkpoint.history_sizes},
                      {"frame_times", checkpoint.frame_times},
                      {"next_row", checkpoint.next_row},
                      {"next_frame", checkpoint.next_frame},
                      {"limited_by", s.limit.reason},
                      {"step_size", s.step_size},
                      {"base_time", s.base_time},
                      {"base_step", s.base_step},
                      {"energy_in_play", s.energy_in_play},
                      {"tangential", s.tangential},
                      {"mass_damping_loss", s.mass_damping_loss},
                      {"deformables", s.deformables},
                      {"slips", s.slips},
                      {"equilibrium", s.equilibrium},
                      {"load_steps", checkpoint.load_steps},
                      {"state", s.state},
                      {"balance", s.balance},
                      {"extremes", s.extremes},
                      {"counts", s.counts}};
  if (std::isfinite(s.limit.step)) json["limit"] = s.limit.step;  // JSON knows no infinity
  write_file(file(folder), json.dump() + "\n");
}

Checkpoint read_checkpoint(const std::string& folder, const std::string& scene_hash,
                           const Snapshot& like) {
  const std::string name = file(folder);
  std::error_code error_code;
  if (!std::filesystem::exists(name, error_code)) {
    throw SceneError(name, 0, "", "there is no checkpoint to resume from; run without --resume");
  }
  Checkpoint c;
  try {
    const nlohmann::json json = nlohmann::json::parse(read_text(name));
    json.at("scene_hash").get_to(c.scene_hash);
    json.at("history_sizes").get_to(c.history_sizes);
    json.at("frame_times").get_to(c.frame_times);
    json.at("next_row").get_to(c.next_row);
    json.at("next_frame").get_to(c.next_frame);
    Snapshot& s = c.snapshot;
    s.limit = {json.value("limit", HUGE_VAL), json.at("limited_by")};
    json.at("step_size").get_to(s.step_size);
    json.at("base_time").get_to(s.base_time);
    json.at("base_step").get_to(s.base_step);
    json.at("energy_in_play").get_to(s.energy_in_play);
    json.at("tangential").get_to(s.tangential);
    json.at("mass_damping_loss").get_to(s.mass_damping_loss);
    json.at("deformables").get_to(s.deformables);
    json.at("slips").get_to(s.slips);
    json.at("equilibrium").get_to(s.equilibrium);
    json.at("load_steps").get_to(c.load_steps);
    json.at("state").get_to(s.state);
    json.at("balance").get_to(s.balance);
    json.at("extremes").get_to(s.extremes);
    json.at("counts").get_to(s.counts);
  } catch (const nlohmann::json::exception& error) {
    throw SceneError(name, 0, "", std::string("is not a checkpoint: ") + error.what());
  }
  if (c.scene_hash != scene_hash) {
    throw SceneError(name, 0, "",
                     "belongs to another scene, or the scene has been changed; run it anew");
  }
  const State& state = c.snapshot.state;
  const size_t size = like.state.position.size();
  const size_t nodes = like.state.displacement.size();
  const size_t bodies = like.equilibrium.body_loads.size();
  const auto fits = [&](const LoadStep& s) {
    return s.off.size() == bodies && s.worst >= 0 && static_cast<size_t>(s.worst) < bodies;
  };
  if (state.position.size() != size || state.remainder.size() != size ||
      state.velocity.size() != size || state.force.size() != size ||
      state.displacement.size() != nodes || state.node_velocity.size() != nodes ||
      state.node_force.size() != nodes ||
      c.snapshot.equilibrium.outside.size() != like.equilibrium.outside.size() ||
      c.snapshot.equilibrium.body_loads.size() != bodies ||
      !std::all_of(c.load_steps.begin(), c.load_steps.end(), fits) || !(c.snapshot.step_size > 0)) {
    throw SceneError(name, 0, "", "is damaged: its state does not fit the scene; run it anew");
  }
  for (size_t i = 0; i < kHistoryFiles.size(); ++i) {
    const std::string history = folder + "/" + kHistoryFiles[i];
    const auto length = std::filesystem::file_size(history, error_code);
    if (error_code || length < static_cast<std::uintmax_t>(c.history_sizes[i])) {
      throw SceneError(history, 0, "",
                       "is missing or shorter than the checkpoint says; run it anew");
    }
  }
  return c;
}

void remove_checkpoint(const std::string& folder) {
  std::error_code ignored;  // a checkpoint left behind does no harm
  std::filesystem::remove(file(folder), ignored);
}

}  // namespace apothem
