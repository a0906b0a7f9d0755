#include "apothem/scene/output_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apothem/mesh/locate.hpp"
#include "apothem/model/columns.hpp"
#include "apothem/model/state.hpp"

namespace apothem {

OutputReader::OutputReader(const JsonReader& in, const Model& model, double end,
                           OutputSettings& output)
    : in_(in), model_(model), end_(end), output_(output) {
  const int bodies = static_cast<int>(model.bodies.size() + model.deformables.size());
  for (int i = 0; i < bodies; ++i) names_.push_back(model.name_of(i));
}

void OutputReader::track_by_default() {
  constexpr size_t kMany = 20;
  std::vector<int>& track = output_.track;
  for (size_t i = 0; i < model_.bodies.size(); ++i) {
    if (model_.bodies[i].can_move()) track.push_back(static_cast<int>(i));
  }
  std::vector<int>& deformables = output_.track_deformables;
  for (size_t i = 0; i < model_.deformables.size(); ++i) {
    deformables.push_back(static_cast<int>(i));
  }
  if (track.size() + deformables.size() > kMany) {
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
  const auto place = std::find(names_.begin(), names_.end(), in_.string(name));
  if (place == names_.end()) in_.fail(name, "unknown body " + suggest(name.string, names_));
  const auto index_in = [&](const auto& bodies) {
    const auto body = std::find_if(bodies.begin(), bodies.end(),
                                   [&](const auto& b) { return b.name == name.string; });
    return body == bodies.end() ? -1 : static_cast<int>(body - bodies.begin());
  };
  const int rigid = index_in(model_.bodies);
  const int deformable = index_in(model_.deformables);
  if (label && !point) in_.fail(*label, "goes with a \"point\"; leave it out");
  if (surface) return tracked_surface(deformable, *surface, point);
  if (!point) {
    std::vector<int>& list = rigid >= 0 ? output_.track : output_.track_deformables;
    const int body = std::max(rigid, deformable);
    if (std::find(list.begin(), list.end(), body) != list.end()) {
      in_.fail(item, "is tracked already; leave it out");
    }
    list.push_back(body);
    return;
  }
  if (rigid >= 0) {
    in_.fail(*point,
             "points are tracked in bodies with a mesh; of a rigid body leave it out: "
             "place and angle say it all");
  }
  tracked_point(deformable, *point, label);
}

void OutputReader::tracked_surface(int deformable, const JsonValue& value, const JsonValue* point) {
  std::vector<int>& list = output_.track_surfaces;
  in_.choice(value, {"contact"});
  if (point) in_.fail(value, "and a \"point\" are tracked apart; make two entries");
  if (deformable < 0) in_.fail(value, "is recorded of bodies with a mesh");
  if (model_.contact.surface != ContactSurface::body) {
    in_.fail(value, "is not recorded with \"surface\": \"element\"");
  }
  if (std::find(list.begin(), list.end(), deformable) != list.end()) {
    in_.fail(value, "is tracked already; leave it out");
  }
  list.push_back(deformable);
}

void OutputReader::tracked_point(int index, const JsonValue& point, const JsonValue* label) {
  const DeformableBody& body = model_.deformables[index];
  const std::optional<MeshPoint> found =
      find_point(body.mesh, in_.vec2(point, "m") - model_.origin);
  if (!found) in_.fail(point, fmt::format("lies outside \"{}\"", body.name));
  TrackedPoint tracked;
  tracked.body = index;
  tracked.element = found->element;
  for (const int node : body.mesh.element(found->element)) {
    tracked.nodes.push_back(body.first_node + node);
  }
  tracked.weights = found->weights;
  const auto taken = [&](const std::string& candidate) {
    for (const TrackedPoint& p : output_.points) {
      if (p.name == candidate) return true;
    }
    return candidate != body.name &&
           std::find(names_.begin(), names_.end(), candidate) != names_.end();
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
  if (const JsonValue* v = object.optional("frames")) output_.frames = in_.count(*v);
  if (const JsonValue* v = object.optional("history")) {
    JsonObject history(in_, *v);
    if (const JsonValue* i = history.optional("interval")) {
      output_.history_interval = in_.positive(*i, "s");
    }
    if (const JsonValue* list = history.optional("track")) {
      output_.track.clear();
      output_.track_deformables.clear();
      for (const JsonValue& item : in_.array(*list)) tracked(item);
    }
    history.finish();
  }
  if (const JsonValue* v = object.optional("checkpoint")) {
    JsonObject checkpoint(in_, *v);
    output_.checkpoint_interval =
        in_.positive(checkpoint.required("wall_clock", "s of real time between checkpoints"), "s");
    checkpoint.finish();
  }
  object.finish();
}

std::vector<Expectation> OutputReader::expectations(const JsonValue& value) const {
  std::vector<Expectation> expectations;
  std::vector<std::string> columns;
  for (HistoryColumn& c : history_columns(model_, output_)) {
    columns.push_back(std::move(c.name));
  }
  columns.insert(columns.end(), kEnergyColumns.begin(), kEnergyColumns.end());
  columns.insert(columns.end(), kMomentumColumns.begin(), kMomentumColumns.end());
  for (const JsonValue& item : in_.array(value)) {
    JsonObject object(in_, item);
    Expectation e;
    const JsonValue& quantity = object.required("quantity", "a column of a history");
    e.quantity = in_.string(quantity);
    if (std::find(columns.begin(), columns.end(), e.quantity) == columns.end()) {
      in_.fail(quantity, "no history has a column " + suggest(e.quantity, columns));
    }
    if (const JsonValue* v = object.optional("take")) {
      e.take = static_cast<Expectation::Take>(in_.choice(*v, {kTakes.begin(), kTakes.end()}));
    }
    if (const JsonValue* v = object.optional("between")) {
      const std::vector<double> t = in_.numbers(*v, 2, "[from, until] in s");
      if (!(t[0] <= t[1])) in_.fail(*v, "must not end before it starts");
      if (t[0] > end_ || t[1] < 0) in_.fail(*v, "lies outside the run");
      e.from = t[0];
      e.until = t[1];
    }
    e.value = in_.number(object.required("value", "the number to expect"), "");
    const JsonValue* absolute = object.optional("tolerance");
    const JsonValue* relative = object.optional("relative");
    if (absolute) e.tolerance = in_.positive(*absolute, "the quantity's unit");
    if (relative) e.tolerance = in_.positive(*relative, "parts of the value") * std::abs(e.value);
    if (!absolute == !relative) {
      in_.fail(item, "must give either \"tolerance\" (absolute) or \"relative\"");
    }
    if (!(e.tolerance > 0)) in_.fail(*relative, "a relative tolerance needs a value other than 0");
    if (const JsonValue* v = object.optional("label")) e.label = in_.string(*v);
    if (const JsonValue* v = object.optional("source")) in_.string(*v);
    object.finish();
    expectations.push_back(std::move(e));
  }
  return expectations;
}

bool has_control_character(const std::string& name) {
  return std::any_of(name.begin(), name.end(), [](unsigned char c) { return c < 32 || c == 127; });
}

void refuse_as_column(const JsonReader& in, const JsonValue& name) {
  const std::string& text = in.string(name);
  if (text.empty() || has_control_character(text) ||
      text.find_first_of(",\"\n\r[]") != std::string::npos) {
    in.fail(name, "must not be empty nor hold , \" [ ] or line breaks: it heads CSV columns");
  }
}

}  // namespace apothem
