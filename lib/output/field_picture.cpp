#include "lib/output/field_picture.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numeric>

#include "lib/output/axes.hpp"
#include "lib/output/field_layout.hpp"
#include "lib/output/field_overlay.hpp"
#include "lib/output/field_raster.hpp"
#include "lib/output/files.hpp"

namespace apothem {
namespace {

// Lengths in points.
constexpr double kTop = 36, kBottom = 8;
constexpr double kFigureFont = 14;

void draw_frame(Canvas& canvas, const FieldPanel& panel, const PanelLayout& layout,
                const ShownField& shown, const Box& frame, bool below, bool left) {
  const int pixels = canvas.pixels_per_point();
  const int wide = static_cast<int>(layout.wide) * pixels;
  const int high = static_cast<int>(layout.high) * pixels;
  const auto colour_of = [&](double value) {
    if (!shown.field.names.empty()) return okabe_ito(static_cast<size_t>(value));
    return viridis((panel.scale * value - layout.low) / (layout.high_value - layout.low));
  };
  canvas.image(frame, wide, high, paint(shown.field, layout.window, colour_of, wide, high));
  const Axes axes(frame, layout.window, {"x", "m"}, {"y", "m"});
  canvas.clip(frame);
  draw_outlines(canvas, axes, shown.field, layout.wide * layout.high);
  draw_chains(canvas, axes, shown.chains, layout.largest_force, layout.widest_chain);
  draw_roses(canvas, axes, shown.roses);
  canvas.unclip();
  axes.draw(canvas, below, left);
}

void draw_legend(Canvas& canvas, const FieldPanel& panel, const PanelLayout& layout, double x,
                 double top) {
  const double all = kCategory * static_cast<double>(layout.legend_lines());
  double y = std::round(top + std::max(0., layout.frames_height() - all) / 2);
  size_t line = 0;
  for (const size_t category : layout.categories) {
    if (++line == kMostCategories && layout.categories.size() > kMostCategories) {
      canvas.text({x, y + kBarWidth / 2},
                  fmt::format("and {} more", layout.categories.size() - kMostCategories + 1),
                  {kLabelFont});
      return;
    }
    const std::vector<Vec2> box = box_ring({x, y, x + kBarWidth, y + kBarWidth});
    canvas.fill(box, okabe_ito(category));
    canvas.stroke(box, true, {{.15, .15, .15}, .7});
    canvas.text({x + kBarWidth + 7, y + kBarWidth / 2}, panel.fields[0].field.names[category],
                {kLabelFont});
    y += kCategory;
  }
}

void draw_scale(Canvas& canvas, const FieldPanel& panel, const PanelLayout& layout, double x,
                double top) {
  const double bar = std::round(std::min(layout.frames_height(), kBarHigh));
  const double y = std::round(top + (layout.frames_height() - bar) / 2);
  draw_colour_scale(canvas, {x, y, x + kBarWidth, y + bar}, {panel.quantity->symbol, panel.unit},
                    layout.low, layout.high_value, layout.values_below, layout.values_above);
}

// `fields`: the numbers of those that are drawn.
void draw_panel(Canvas& canvas, const FieldPanel& panel, const std::vector<size_t>& fields,
                const PanelLayout& layout, const Vec2& corner) {
  const double left = corner.x() + kFrameLeft;
  canvas.text({left, corner.y() + kPanelTitle - 10}, heading(panel), {kTitleFont});
  const double first = corner.y() + kPanelTitle + layout.label;
  for (size_t i = 0; i < fields.size(); ++i) {
    const ShownField& shown = panel.fields[fields[i]];
    const int column = static_cast<int>(i) % layout.columns;
    const int row = static_cast<int>(i) / layout.columns;
    const double x = left + column * (layout.wide + kColumnGap);
    const double y = first + row * (layout.high + layout.label + kRowGap);
    const Box frame{x, y, x + layout.wide, y + layout.high};
    const bool lowest = i + static_cast<size_t>(layout.columns) >= fields.size();
    draw_frame(canvas, panel, layout, shown, frame, lowest, column == 0);
    canvas.text({x, y - layout.label + kLabel / 2}, shown.label, {kLabelFont});
    canvas.text({frame.x1, y - kLabel / 2}, layout.ranges[fields[i]], {kLabelFont, Align::right});
  }
  const double x = left + layout.frames_width() + kBarGap;
  if (layout.categories.empty()) {
    draw_scale(canvas, panel, layout, x, first);
  } else {
    draw_legend(canvas, panel, layout, x, first);
  }
  double y = first + layout.middle_height() + kBelow + kNoteLine / 2;
  for (size_t i = 0; i < layout.notes.size(); ++i, y += kNoteLine) {
    if (i == 0 && layout.largest_force > 0) {
      draw_chain_sample(canvas, {left, y}, layout.widest_chain);
    } else {
      draw_rose_sample(canvas, {left, y});
    }
    canvas.text({left + kNoteText, y}, layout.notes[i], {kNoteFont});
  }
}

}  // namespace

std::string draw_fields(const FieldFigure& figure, PictureFormat format) {
  const Canvas ruler(format, 1, 1);
  std::vector<PanelLayout> layouts;
  double width = 2 * kFrameLeft + ruler.text_width(figure.title, kFigureFont);
  double height = kTop + kBottom;
  for (const FieldPanel& panel : figure.panels) {
    layouts.push_back(lay_out(panel, panel.fields.size(), ruler));
    width = std::max(width, layouts.back().width());
    height += layouts.back().height();
  }
  width = 2 * std::ceil(width / 2);
  Canvas canvas(format, width, height);
  canvas.text({width / 2, kTop / 2}, figure.title, {kFigureFont, Align::centre});
  double top = kTop;
  for (size_t p = 0; p < layouts.size(); ++p) {
    // Images need corners at whole points (see Canvas::image).
    std::vector<size_t> all(figure.panels[p].fields.size());
    std::iota(all.begin(), all.end(), 0);
    draw_panel(canvas, figure.panels[p], all, layouts[p],
               {std::floor((width - layouts[p].width()) / 2), top});
    top += layouts[p].height();
  }
  return canvas.finish();
}

void draw_each(const FieldFigure& figure, const std::function<void(std::string)>& take) {
  const Canvas ruler(PictureFormat::png, 1, 1);
  const FieldPanel& panel = figure.panels.at(0);
  const PanelLayout layout = lay_out(panel, 1, ruler);
  const double title = 2 * kFrameLeft + ruler.text_width(figure.title, kFigureFont);
  const double width = 2 * std::ceil(std::max(title, layout.width()) / 2);
  const double height = kTop + kBottom + layout.height();
  for (size_t i = 0; i < panel.fields.size(); ++i) {
    Canvas canvas(PictureFormat::png, width, height);
    canvas.text({width / 2, kTop / 2}, figure.title, {kFigureFont, Align::centre});
    draw_panel(canvas, panel, {i}, layout, {std::floor((width - layout.width()) / 2), kTop});
    take(canvas.finish());
  }
}

void write_fields(const std::string& folder, const FieldFigure& figure) {
  create_folder(folder);
  write_file(folder + "/fields.png", draw_fields(figure, PictureFormat::png));
  write_file(folder + "/fields.svg", draw_fields(figure, PictureFormat::svg));
}

}  // namespace apothem
