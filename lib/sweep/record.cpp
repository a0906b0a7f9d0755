#include "lib/sweep/record.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "lib/output/files.hpp"
#include "lib/text/file.hpp"

namespace apothem {
namespace {

using Json = nlohmann::ordered_json;

MeasuredValue measure_of(const Json& value) {
  if (value.is_boolean()) return value.get<bool>();
  if (value.is_number()) return value.get<double>();
  return {};
}

bool is_taken(const RunRecord& record, const std::string& name) {
  return std::ranges::any_of(record.measures,
                             [&](const auto& measure) { return measure.first == name; });
}

std::string free_name(const RunRecord& record, const Json& expectation) {
  std::string quantity = expectation.at("quantity");
  if (!is_taken(record, quantity)) return quantity;
  std::string take = quantity + " " + expectation.at("take").get<std::string>();
  if (!is_taken(record, take)) return take;
  int number = 2;
  while (is_taken(record, fmt::format("{} {}", take, number))) ++number;
  return fmt::format("{} {}", take, number);
}

std::string text_at(const Json& json, const char* key) {
  const auto at = json.find(key);
  return at != json.end() && at->is_string() ? at->get<std::string>() : "";
}

}  // namespace

void parse_record(const std::string& text, RunRecord& record) {
  try {
    const Json json = Json::parse(text);
    record.stopped_by = text_at(json, "stopped_by");
    record.time = json.at("time").get<double>();
    record.wall_time = json.at("wall_time").at("total").get<double>();
    // A folder may be of an earlier program, which did not write it.
    if (const auto at = json.find("processor_time"); at != json.end()) {
      record.processor_time = at->get<double>();
    }
    record.scene_hash = json.at("scene_hash");
    record.final_state_hash = json.at("final_state_hash");
    if (record.message.empty()) record.message = text_at(json, "message");
    if (json.contains("measures")) {
      for (const auto& [name, value] : json["measures"].items()) {
        record.measures.emplace_back(name, measure_of(value));
      }
    }
    for (const Json& expectation : json.at("expectations")) {
      record.measures.emplace_back(free_name(record, expectation),
                                   measure_of(expectation.at("value")));
    }
  } catch (const Json::exception& error) {
    throw std::runtime_error(error.what());
  }
}

RunRecord read_record(const Study& study, const PlannedRun& run) {
  RunRecord record;
  record.state = study.state_of(run);
  if (record.state == RunState::missing || record.state == RunState::changed) return record;
  record.message = study.message_of(run);
  // A run that was refused or has crashed has written nothing.
  const std::string file = study.folder_of(run) + "/run.json";
  if (record.state != RunState::done && !file_exists(file)) return record;
  try {
    parse_record(read_text(file), record);
  } catch (const std::runtime_error& unreadable) {
    if (record.state == RunState::done) record.state = RunState::failed;
    record.message = fmt::format("run.json cannot be read: {}", unreadable.what());
  }
  return record;
}

}  // namespace apothem
