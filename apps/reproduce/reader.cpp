#include "apps/reproduce/reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <tuple>

#include "apps/reproduce/text.hpp"
#include "lib/output/history.hpp"
#include "lib/text/file.hpp"
#include "lib/text/words.hpp"

namespace apothem {
namespace {

std::string scene_file(const std::string& data, const std::string& scene) {
  return data + "/scenes/" + scene + ".json";
}

std::vector<std::string> names_in(const std::string& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    if (entry.path().extension() == ".json") names.push_back(entry.path().stem().string());
  }
  return names;
}

}  // namespace

void FigureReader::read(const JsonValue& document) {
  JsonObject top(in_, document);
  figure_.shown.title = in_.string(top.required("title", "string"));
  figure_.shown_fields.title = figure_.shown.title;
  figure_.text = read_figure_text(in_, top);
  top.each("panels", [&](const JsonValue& item) {
    if (item.find("shapes")) {
      figure_.potentials.push_back(read_potential_panel(in_, item));
    } else if (item.find("field")) {
      field_panel(item);
    } else {
      panel(item);
    }
  });
  top.each("numbers", [&](const JsonValue& item) {
    scene_of(item);
    figure_.numbers[in_.string(item)].clear();
  });
  top.each("studies",
           [&](const JsonValue& item) { figure_.studies.push_back(read_study(in_, item)); });
  top.each("compare", [&](const JsonValue& item) {
    figure_.comparisons.push_back(read_comparison(in_, item, data_));
  });
  top.each("players", [&](const JsonValue& item) { player(item); });
  top.finish();
  if (figure_.scenes.empty() && figure_.shown.panels.empty() && figure_.field_sources.empty() &&
      figure_.potentials.empty()) {
    in_.fail(document, "has neither panels nor numbers");
  }
}

void FigureReader::player(const JsonValue& item) {
  if (item.type() == JsonValue::Type::object) {
    JsonObject object(in_, item);
    StudyPlayer& player = figure_.study_players.emplace_back();
    player.run = in_.string(object.required("study", "folder of a run"));
    player.label = in_.string(object.required("label", "what the report calls it"));
    object.finish();
  } else {
    figure_.players.push_back(figure_.scenes[in_.choice(item, figure_.scenes)]);
  }
}

Vec2 FigureReader::range(const JsonValue& value) {
  Vec2 limits = in_.vec2(value, "the axis's unit");
  if (!(limits.x() < limits.y())) in_.fail(value, "must be [from, to] with from below to");
  return limits;
}

size_t FigureReader::index_of(const std::vector<std::string>& list, const std::string& name) {
  return static_cast<size_t>(std::ranges::find(list, name) - list.begin());
}

const std::vector<std::string>& FigureReader::holding(
    const std::vector<std::vector<std::string>>& tables, const JsonValue& column) {
  std::vector<std::string> all;
  for (const std::vector<std::string>& columns : tables) {
    if (index_of(columns, in_.string(column)) < columns.size()) return columns;
    all.insert(all.end(), columns.begin(), columns.end());
  }
  in_.fail(column, "there is no column " + suggest(column.string(), all));
}

FrameTime FigureReader::frame_time(const JsonValue& value, const Scene& scene) {
  const double time = in_.number(value, "s");
  const int frames = scene.time.statics ? scene.time.load_steps : scene.output.frames;
  const double interval = scene.time.end / std::max(frames, 1);
  const double count = std::round(time / interval);
  if (count < 0 || count > std::max(frames, 1) ||
      std::abs(time - count * interval) > 1e-6 * interval) {
    in_.fail(value, fmt::format("is not the time of a frame: those of {} are {} s apart, to {} s",
                                scene.model.name, interval, scene.time.end));
  }
  return {time, time + interval / 2};
}

Scene FigureReader::scene_of(const JsonValue& scene) {
  const std::string& name = in_.string(scene);
  const std::vector<std::string> known = names_in(data_ + "/scenes");
  if (index_of(known, name) == known.size()) {
    in_.fail(scene, "there is no scene " + suggest(name, known));
  }
  if (index_of(figure_.scenes, name) == figure_.scenes.size()) figure_.scenes.push_back(name);
  return read_scene(scene_file(data_, name));
}

std::vector<std::vector<std::string>> FigureReader::columns_of_table(const JsonValue& reference) {
  try {
    return {read_history(data_ + "/reference/" + in_.string(reference)).names};
  } catch (const std::runtime_error& error) {
    in_.fail(reference, error.what());
  }
}

std::vector<std::string> figure_names(const std::string& data) {
  std::vector<std::string> names = names_in(data + "/figures");
  if (names.empty()) {
    throw SceneError(data, "holds no figures; name the folder that does with --data");
  }
  const auto key = [](const std::string& name) {
    constexpr const char* kDigits = "0123456789";
    const size_t from = std::min(name.find_first_of(kDigits), name.size());
    const size_t to = std::min(name.find_first_not_of(kDigits, from), name.size());
    const bool of_paper = name.starts_with("fig-");
    return std::tuple(!of_paper, name.substr(0, from), to - from, name.substr(from));
  };
  std::ranges::sort(names,
                    [&](const std::string& a, const std::string& b) { return key(a) < key(b); });
  return names;
}

Figure read_figure(const std::string& data, const std::string& name) {
  Figure figure;
  figure.name = name;
  const std::string file = data + "/figures/" + name + ".json";
  FigureReader(data, figure, file).read(parse_json(read_text(file), file));
  return figure;
}

}  // namespace apothem
