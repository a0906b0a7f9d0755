#include "lib/output/run_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lib/model/rotation.hpp"
#include "lib/output/axes.hpp"

namespace apothem {
namespace {

// Multiplies what has happened since the start of the run. Rigid bodies keep their shape.
void deform(Frame& frame, double factor) {
  for (size_t i = 0; i < frame.position.size(); ++i) {
    frame.position[i] = frame.mesh.nodes[i] + factor * frame.displacement[i];
  }
  for (int e = 0; e < frame.mesh.element_count(); ++e) {
    if (frame.body_of(e).meshed) continue;
    const std::span<const int> corners = frame.mesh.element(e);
    const double share = 1 / static_cast<double>(corners.size());
    Vec2 middle = Vec2::Zero(), shift = Vec2::Zero();
    for (const int i : corners) {
      middle += share * frame.mesh.nodes[i];
      shift += share * frame.displacement[i];
    }
    const double angle = factor * frame.body_of(e).rotation();
    const auto move = [&](const int i) {
      frame.position[i] =
          middle + factor * shift + turned(Vec2(frame.mesh.nodes[i] - middle), angle);
    };
    std::ranges::for_each(corners, move);
    if (const auto found = frame.holes.find(e); found != frame.holes.end()) {
      for (const std::vector<int>& hole : found->second) std::ranges::for_each(hole, move);
    }
  }
}

const FieldQuantity& default_quantity(const Frame& frame, bool chains) {
  const char* name = !all_rigid(frame) ? "von_mises" : chains ? "material" : "speed";
  return *field_quantity(name);
}

// The largest size of a value that has a colour.
double largest_value(const std::vector<ShownField>& fields) {
  double largest = 0;
  const auto include = [&](double value) {
    if (std::isfinite(value)) largest = std::max(largest, std::abs(value));
  };
  for (const ShownField& shown : fields) {
    const Field& field = shown.field;
    for (int e = 0; e < field.mesh.element_count(); ++e) {
      if (field.blank[e]) continue;
      if (!field.nodal) include(field.values[e]);
      for (const int node : field.mesh.element(e)) {
        if (field.nodal) include(field.values[node]);
      }
    }
  }
  return largest;
}

// Not every run holds every quantity.
void require_quantity(const RunFolder& run, const Frame& frame, const FieldQuantity& quantity) {
  if (quantity.kind == FieldKind::stress_of_elements && all_rigid(frame)) {
    throw ResultsError(
        fmt::format("{}: no body is of finite elements, so none has a {}; rigid bodies have "
                    "pressure, s1, s2, sxx, syy and sxy, from their contact forces",
                    run.path(), quantity.meaning));
  }
}

}  // namespace

std::vector<size_t> strip(const RunFolder& run, int count) {
  const std::vector<double>& times = run.times();
  if (count <= 1) return {times.size() - 1};
  std::vector<size_t> frames;
  for (int i = 0; i < count; ++i) {
    const double share = static_cast<double>(i) / (count - 1);
    const double time = (1 - share) * times.front() + share * times.back();
    frames.push_back(run.nearest(std::clamp(time, times.front(), times.back())));
  }
  frames.erase(std::unique(frames.begin(), frames.end()), frames.end());
  return frames;
}

FieldFigure picture_of(const RunFolder& run, const RunPicture& choice,
                       const std::function<void(size_t)>& on_frame) {
  if (choice.roses && !run.has_roses()) {
    throw ResultsError(run.path() +
                       ": has no roses.pvd: rose diagrams show the contacts in the regions of a "
                       "scene; give it \"regions\"");
  }
  FieldPanel panel;
  panel.quantity = choice.quantity;
  panel.window = choice.window;
  bool any = false;
  for (const size_t number : choice.frames) {
    if (on_frame) on_frame(panel.fields.size());
    Frame frame = run.frame(number);
    any = any || frame.mesh.element_count() > 0;
    if (!panel.quantity) panel.quantity = &default_quantity(frame, choice.chains);
    require_quantity(run, frame, *panel.quantity);
    if (choice.deformation != 1) deform(frame, choice.deformation);
    ShownField& shown = panel.fields.emplace_back();
    shown.label = "t = " + time_in_words(frame.time);
    shown.field = field_of(frame, *panel.quantity);
    if (choice.chains) shown.chains = run.chains(number);
    if (choice.roses) shown.roses = run.roses(number);
  }
  if (!any) throw ResultsError(run.path() + ": there is no body in these frames");
  if (choice.range && panel.quantity->kind == FieldKind::category) {
    throw ResultsError(run.path() + ": materials have names, not a range of values");
  }
  std::tie(panel.unit, panel.scale) = prefixed(panel.quantity->unit, largest_value(panel.fields));
  if (choice.range) panel.range = panel.scale * *choice.range;
  if (choice.deformation != 1) {
    panel.title = fmt::format("displacements times {:g}", choice.deformation);
  }
  return {folder_title(run.path()), {std::move(panel)}};
}

}  // namespace apothem
