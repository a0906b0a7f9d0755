#include "lib/scene/output_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lib/mesh/locate.hpp"
#include "lib/model/state.hpp"
#include "lib/text/words.hpp"

namespace apothem {
namespace {

constexpr size_t kMostByDefault = 20;  // bodies in the history of a scene that does not choose

// Index of the body of that name in the model's list of rigid or of deformable bodies, or -1.
template <class Body>
int index_in(const std::vector<Body>& bodies, const std::string& name) {
  const auto found = std::ranges::find_if(bodies, [&](const Body& b) { return b.name == name; });
  return found == bodies.end() ? -1 : static_cast<int>(found - bodies.begin());
}

}  // namespace

int default_rows(const Model& model, const OutputSettings& output) {
  const bool tracks = !output.track.empty() || !output.track_deformables.empty() ||
                      !output.points.empty() || !model.regions.empty();
  const bool few = model.bodies.size() + model.deformables.size() <= kMostByDefault;
  return tracks || few ? 1000 : 100;
}

int default_frames(const Model& model) {
  constexpr size_t kMany = 1000;
  size_t parts = model.bodies.size();
  for (const DeformableBody& body : model.deformables) {
    parts += static_cast<size_t>(body.mesh.element_count());
  }
  return parts > kMany ? 20 : 100;
}

void OutputReader::track_by_default() {
  std::vector<int>& track = output_.track;
  for (size_t i = 0; i < model_.bodies.size(); ++i) {
    if (model_.bodies[i].can_move()) track.push_back(static_cast<int>(i));
  }
  std::vector<int>& deformables = output_.track_deformables;
  for (size_t i = 0; i < model_.deformables.size(); ++i) {
    deformables.push_back(static_cast<int>(i));
  }
  if (track.size() + deformables.size() > kMostByDefault) {
    track.clear();
    deformables.clear();
  }
}

void OutputReader::tracked(const JsonValue& item) {
  JsonObject object(in_, item);
  const JsonValue& name = object.required("body", "the name of a body");
  const JsonValue* point = object.optional("point");
  const JsonValue* surface = object.optional("surface");
  const JsonValue* label = object.optional("name");
  object.finish();
  const auto found = std::ranges::find(bodies_, in_.string(name));
  if (found == bodies_.end()) in_.fail(name, "unknown body " + suggest(name.string(), bodies_));
  const int place = static_cast<int>(found - bodies_.begin());
  const int rigid = index_in(model_.bodies, name.string());
  const int deformable = index_in(model_.deformables, name.string());
  if (label && !point) in_.fail(*label, "goes with a \"point\"; leave it out");
  if (surface) {
    in_.choice(*surface, {"contact"});
    if (point) in_.fail(*surface, "and a \"point\" are tracked apart; make two entries");
    features_.add(Feature::tracked_surface, surface, place);
    if (deformable >= 0) track_once(output_.track_surfaces, deformable, *surface);
  } else if (point) {
    features_.add(Feature::tracked_point, point, place);
    if (deformable >= 0) tracked_point(deformable, *point, label);
  } else {
    std::vector<int>& list = rigid >= 0 ? output_.track : output_.track_deformables;
    track_once(list, std::max(rigid, deformable), item);
  }
}

void OutputReader::track_once(std::vector<int>& list, int body, const JsonValue& value) const {
  if (std::ranges::find(list, body) != list.end()) {
    in_.fail(value, "is tracked already; leave it out");
  }
  list.push_back(body);
}

void OutputReader::tracked_point(int deformable, const JsonValue& point, const JsonValue* label) {
  const DeformableBody& body = model_.deformables[deformable];
  const std::optional<MeshPoint> found =
      find_point(body.mesh, in_.vec2(point, "m") - model_.origin);
  if (!found) in_.fail(point, fmt::format("lies outside \"{}\"", body.name));
  TrackedPoint tracked;
  tracked.body = deformable;
  tracked.element = found->element;
  for (const int node : body.mesh.element(found->element)) {
    tracked.nodes.push_back(body.first_node + node);
  }
  tracked.weights = found->weights;
  const auto taken = [&](const std::string& candidate) {
    for (const TrackedPoint& p : output_.points) {
      if (p.name == candidate) return true;
    }
    return candidate != body.name && std::ranges::find(bodies_, candidate) != bodies_.end();
  };
  tracked.name = label ? in_.string(*label) : body.name;
  if (label) {
    refuse_as_column(in_, *label);
    if (taken(tracked.name)) in_.fail(*label, "is the name of another body or point");
  }
  for (int i = 2; taken(tracked.name); ++i) tracked.name = fmt::format("{}-{}", body.name, i);
  output_.points.push_back(std::move(tracked));
}

void OutputReader::read(const JsonValue& value) {
  JsonObject object(in_, value);
  if (const JsonValue* v = object.optional("frames")) {
    features_.add(Feature::frames, v);
    output_.frames = in_.count(*v);
  }
  if (const JsonValue* v = object.optional("format")) {
    format_ = in_.choice<FrameFormat>(*v, kFrameFormats);
  }
  if (const JsonValue* v = object.optional("history")) history(*v);
  if (const JsonValue* v = object.optional("checkpoint")) checkpoint(*v);
  object.finish();
}

void OutputReader::checkpoint(const JsonValue& value) {
  if (value.type() == JsonValue::Type::boolean) {
    if (value.boolean()) in_.fail(value, "must be {\"wall_clock\": ...} or false; leave it out");
    output_.checkpoint_interval.reset();
    return;
  }
  JsonObject object(in_, value);
  output_.checkpoint_interval =
      in_.positive(object.required("wall_clock", "s of real time between checkpoints"), "s");
  object.finish();
}

void OutputReader::history(const JsonValue& value) {
  JsonObject object(in_, value);
  if (const JsonValue* v = object.optional("interval")) {
    features_.add(Feature::history_interval, v);
    output_.history_interval = in_.positive(*v, "s");
  }
  if (const JsonValue* list = object.optional("track")) {
    output_.track.clear();
    output_.track_deformables.clear();
    for (const JsonValue& item : in_.array(*list)) tracked(item);
  }
  object.finish();
}

// Of all histories.
std::vector<HistoryColumn> OutputReader::columns() const {
  std::vector<HistoryColumn> columns = history_columns(model_, output_);
  for (const Column& column : kEnergyColumns) columns.push_back({column.name, column.unit});
  for (const Column& column : kMomentumColumns) columns.push_back({column.name, column.unit});
  columns.push_back({"time", "s"});
  columns.insert(columns.end(), besides_.begin(), besides_.end());
  return columns;
}

std::vector<Expectation> OutputReader::expectations(const JsonValue& value, double end) const {
  const std::vector<HistoryColumn> known = columns();
  std::vector<Expectation> expectations;
  for (const JsonValue& item : in_.array(value)) {
    expectations.push_back(expectation(item, known, end));
  }
  return expectations;
}

std::vector<Measure> OutputReader::measures(const JsonValue& value, double end,
                                            const std::vector<std::string>& stops) const {
  const std::vector<HistoryColumn> known = columns();
  std::vector<Measure> measures;
  for (const JsonValue& item : in_.array(value)) {
    JsonObject object(in_, item);
    Measure measure;
    const JsonValue& name = object.required("name", "what it is called in tables");
    refuse_as_column(in_, name);
    measure.name = name.string();
    for (const Measure& other : measures) {
      if (other.name == measure.name) in_.fail(name, "is the name of another measure");
    }
    const JsonValue* quantity = object.optional("quantity");
    if (const JsonValue* v = object.optional("stopped_by")) {
      if (quantity) in_.fail(*v, "and \"quantity\" are two measures; make two entries");
      measure.stopped_by = in_.string(*v);
      if (std::ranges::find(stops, measure.stopped_by) == stops.end()) {
        in_.fail(*v, "no \"stop\" has the name " + suggest(measure.stopped_by, stops));
      }
    } else {
      const JsonValue& column = object.required("quantity",
                                                "a column of a history; or "
                                                "\"stopped_by\"");
      reduction(object, column, known, end, measure.of);
    }
    object.finish();
    measures.push_back(std::move(measure));
  }
  return measures;
}

void OutputReader::reduction(JsonObject& object, const JsonValue& quantity,
                             const std::vector<HistoryColumn>& columns, double end,
                             Reduction& result) const {
  result.quantity = in_.string(quantity);
  const auto found = std::ranges::find_if(
      columns, [&](const HistoryColumn& c) { return c.name == result.quantity; });
  if (found == columns.end()) {
    in_.fail(quantity, "no history has a column " + suggest(result.quantity, names_of(columns)));
  }
  result.unit = found->unit;
  result.jumps = found->jumps;
  object.choose("take", result.take, kTakes);
  if (result.take == Reduction::Take::slope) result.unit += " per s";
  if (const JsonValue* v = object.optional("between")) {
    const std::vector<double> t = in_.numbers(*v, 2, "[from, until] in s");
    if (!(t[0] <= t[1])) in_.fail(*v, "must not end before it starts");
    if (t[0] > end || t[1] < 0) in_.fail(*v, "lies outside the run");
    result.from = t[0];
    result.until = t[1];
  }
}

Expectation OutputReader::expectation(const JsonValue& item,
                                      const std::vector<HistoryColumn>& columns, double end) const {
  JsonObject object(in_, item);
  Expectation e;
  reduction(object, object.required("quantity", "a column of a history"), columns, end, e);
  e.value = in_.number(object.required("value", "the number to expect"), "");
  const JsonValue* absolute = object.optional("tolerance");
  const JsonValue* relative = object.optional("relative");
  if (absolute) e.tolerance = in_.positive(*absolute, "the quantity's unit");
  if (relative) e.tolerance = in_.positive(*relative, "parts of the value") * std::abs(e.value);
  if (!absolute == !relative) {
    in_.fail(item, "must give either \"tolerance\" (absolute) or \"relative\"");
  }
  if (!(e.tolerance > 0)) in_.fail(*relative, "a relative tolerance needs a value other than 0");
  object.read("label", e.label, &JsonReader::string);
  if (const JsonValue* v = object.optional("basis")) {
    e.basis = in_.choice<Basis>(*v, kBases);
  }
  object.read("source", e.source, &JsonReader::string);
  object.finish();
  return e;
}

bool has_control_character(const std::string& name) {
  return std::ranges::any_of(name, [](unsigned char c) { return c < 32 || c == 127; });
}

void refuse_as_column(const JsonReader& in, const JsonValue& name) {
  const std::string& text = in.string(name);
  if (text.empty() || has_control_character(text) ||
      text.find_first_of(",\"\n\r[]") != std::string::npos) {
    in.fail(name, "must not be empty nor hold , \" [ ] or line breaks: it heads CSV columns");
  }
}

}  // namespace apothem
