#include "lib/output/field_layout.hpp"

#include <fmt/format.h>

#include <cctype>
#include <cmath>

#include "lib/output/axes.hpp"

namespace apothem {
namespace {

constexpr double kFramesWide = 620, kFramesHigh = 460;  // limits of all frames of a panel together
constexpr double kHighAlone = 340;                      // limit of the height of frames in one row
constexpr double kScaleWidth = 96;                      // width of a colour scale with its numbers
constexpr double kTwoLabels = 36;
constexpr double kShortestFrame = 60;    // least side of a frame
constexpr double kMarginOfBodies = .03;  // around the bodies, over their shorter extent
constexpr double kWidestChain = 6, kNarrowestChain = 1.5;  // of the largest force
constexpr double kChainOfLength = .4;                      // its width over the length of a chain
constexpr double kSameValue = 1e-9;                        // of values that are the same

// The range of some values.
struct Spread {
  double low = HUGE_VAL, high = -HUGE_VAL;
  void include(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
};

bool is_visible(const Field& field, int element, const Box& window) {
  return !apart(box_of(field.mesh.places(field.mesh.element(element))), window);
}

// The range of the values of a field that are visible inside a window.
Spread spread(const Field& field, const Box& window) {
  Spread result;
  for (int e = 0; e < field.mesh.element_count(); ++e) {
    if (field.blank[e] || !is_visible(field, e, window)) continue;
    if (!field.nodal) result.include(field.values[e]);
    for (const int node : field.mesh.element(e)) {
      if (field.nodal) result.include(field.values[node]);
    }
  }
  return result;
}

// Of all bodies, and of the roses, which may be longer than what they are about.
Box box_around(const std::vector<ShownField>& fields) {
  Box box;
  for (const ShownField& shown : fields) {
    box.include(box_of(shown.field.mesh.nodes));
    for (const Rose& rose : shown.roses) box.include(box_of(rose.line));
  }
  return box.grown(kMarginOfBodies * std::min(box.x1 - box.x0, box.y1 - box.y0));
}

std::string number(double value) {
  const std::string digits = fmt::format("{:.3g}", std::abs(value));
  return (value < 0 && digits != "0" ? "−" : "") + digits;
}

// Columns, rows and the size of the frames, and the window that they then show.
void choose_columns(size_t fields, PanelLayout& layout) {
  const double w = layout.window.x1 - layout.window.x0;
  const double h = layout.window.y1 - layout.window.y0;
  const int count = static_cast<int>(fields);
  double best = 0;
  for (int columns = 1; columns <= count; ++columns) {
    const int rows = (count + columns - 1) / columns;
    const double scale = std::min(
        (kFramesWide - (columns - 1) * kColumnGap) / columns / w,
        ((rows == 1 ? kHighAlone : kFramesHigh) - (rows - 1) * (kRowGap + kLabel)) / rows / h);
    if (!(scale > best * (1 + 1e-9))) continue;
    best = scale;
    layout.columns = columns;
    layout.rows = rows;
  }
  layout.wide = std::max(kShortestFrame, std::round(best * w));
  layout.high = std::max(kShortestFrame, std::round(best * h));
  // A frame that had to be wider or higher shows more of the surroundings.
  const double more_x = std::max(0., layout.wide / best - w) / 2;
  const double more_y = std::max(0., layout.high / best - h) / 2;
  layout.window = {layout.window.x0 - more_x, layout.window.y0 - more_y, layout.window.x1 + more_x,
                   layout.window.y1 + more_y};
}

void choose_colours(const FieldPanel& panel, const Spread& all, PanelLayout& layout) {
  layout.low = panel.range ? panel.range->x() : all.low;
  layout.high_value = panel.range ? panel.range->y() : all.high;
  layout.values_below = all.low < layout.low;
  layout.values_above = all.high > layout.high_value;
  const double size = std::max(std::abs(layout.low), std::abs(layout.high_value));
  if (panel.range) return;
  if (!(layout.high_value - layout.low > kSameValue * size)) {  // equal, or there are none
    const double middle = std::isfinite(all.low) ? all.low : 0;
    const double half = middle == 0 ? 1 : std::abs(middle) / 2;
    layout.low = middle - half;
    layout.high_value = middle + half;
  }
}

// A legend in place of the colour scale.
void list_categories(const FieldPanel& panel, const Canvas& ruler, PanelLayout& layout) {
  for (const auto& shown : panel.fields) {
    const Field& field = shown.field;
    if (field.names.empty() || field.nodal) continue;  // only elements have categories
    for (int e = 0; e < field.mesh.element_count(); ++e) {
      const auto value = static_cast<size_t>(field.values[e]);
      if (value >= field.names.size() || !is_visible(field, e, layout.window)) continue;
      if (!layout.categories.insert(value).second) continue;
      const double text = ruler.text_width(field.names[value], kLabelFont);
      layout.right = std::max(layout.right, kBarGap + kBarWidth + text + kColumnGap);
    }
  }
}

// Lines and texts over and below the frames.
void choose_lines(const FieldPanel& panel, PanelLayout& layout) {
  std::vector<double> lengths;
  bool roses = false;
  for (const ShownField& shown : panel.fields) {
    for (const ForceChain& chain : shown.chains) {
      layout.largest_force = std::max(layout.largest_force, chain.normal);
      double length = 0;
      for (size_t i = 1; i < chain.line.size(); ++i) {
        length += (chain.line[i] - chain.line[i - 1]).norm();
      }
      lengths.push_back(length);
    }
    roses = roses || !shown.roses.empty();
  }
  if (layout.largest_force > 0) {
    const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
    std::nth_element(lengths.begin(), middle, lengths.end());
    const double per_metre = layout.wide / (layout.window.x1 - layout.window.x0);
    layout.widest_chain =
        std::clamp(kChainOfLength * per_metre * *middle, kNarrowestChain, kWidestChain);
    const auto [unit, scale] = prefixed("N", layout.largest_force);
    layout.notes.push_back(
        fmt::format("normal force of a contact: {:.3g} {}; widths are proportional",
                    scale * layout.largest_force, unit));
  }
  if (roses) {
    layout.notes.emplace_back(
        "number of contacts by direction of their normals; dashed: if all were alike");
  }
}

}  // namespace

std::string heading(const FieldPanel& panel) {
  std::string title = panel.quantity->meaning;
  title[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(title[0])));
  return panel.title.empty() ? title : title + ": " + panel.title;
}

PanelLayout lay_out(const FieldPanel& panel, size_t at_once, const Canvas& ruler) {
  PanelLayout layout{};
  layout.window = panel.window ? *panel.window : box_around(panel.fields);
  choose_columns(at_once, layout);
  layout.label = kLabel;
  layout.right = kScaleWidth;
  Spread all;
  for (const ShownField& shown : panel.fields) {
    const Spread one = spread(shown.field, layout.window);
    layout.ranges.emplace_back();
    if (!(one.low <= one.high) || !shown.field.names.empty()) continue;
    all.include(panel.scale * one.low);
    all.include(panel.scale * one.high);
    const std::string low = number(panel.scale * one.low), high = number(panel.scale * one.high);
    std::string& range = layout.ranges.back();
    range = low == high ? fmt::format("{} {}", low, panel.unit)
                        : fmt::format("{} … {} {}", low, high, panel.unit);
    const double text = ruler.text_width(fmt::format("{}   {}", shown.label, range), kLabelFont);
    if (text > layout.wide) layout.label = kTwoLabels;
  }
  // Ranges that would run into those of the next frames are left out; the colours have a scale.
  const bool fit = std::ranges::all_of(layout.ranges, [&](const std::string& range) {
    return ruler.text_width(range, kLabelFont) <= layout.wide;
  });
  if (!fit) {
    std::ranges::fill(layout.ranges, "");
    layout.label = kLabel;
  }
  choose_colours(panel, all, layout);
  list_categories(panel, ruler, layout);
  choose_lines(panel, layout);
  if (layout.categories.empty()) {
    const double name =
        colour_scale_width(ruler, {panel.quantity->symbol, panel.unit}, layout.low,
                           layout.high_value, std::min(layout.frames_height(), kBarHigh));
    layout.right = std::max(layout.right, kBarGap + name + kColumnGap);
  }
  double texts = ruler.text_width(heading(panel), kTitleFont);
  for (const std::string& note : layout.notes) {
    texts = std::max(texts, kNoteText + ruler.text_width(note, kNoteFont));
  }
  layout.right = std::max(layout.right, texts + kColumnGap - layout.frames_width());
  return layout;
}

}  // namespace apothem
