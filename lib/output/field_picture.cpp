#include "apothem/output/field_picture.hpp"

#include <fmt/format.h>

#include <cmath>

#include "apothem/mesh/edges.hpp"
#include "apothem/mesh/locate.hpp"
#include "apothem/output/axes.hpp"
#include "apothem/output/files.hpp"

namespace apothem {
namespace {

// Lengths in points.
constexpr double kWide = 620, kHigh = 460;  // limits of all frames of a panel together
constexpr double kHighAlone = 340;          // limit of the height of frames in one row
constexpr double kLeft = 62, kRight = 96, kTop = 36, kBottom = 8;
// Height of headings: panel, frame, frame in two lines.
constexpr double kPanelTitle = 34, kLabel = 22, kTwoLabels = 36;
constexpr double kBelow = 40, kColumnGap = 22, kRowGap = 8;  // kBelow: numbers and name of x
constexpr double kBarGap = 26, kBarWidth = 14, kBarHigh = 230;
constexpr double kShortest = 60;  // least side of a frame
constexpr double kFigureFont = 14, kTitleFont = 12, kLabelFont = 10.5;
constexpr double kMargin = .03;  // around the bodies, over their shorter extent

const Colour kGrey{.78, .78, .78};
const Colour kEmpty{0, 0, 0, 0};
const Pen kOutline{{.15, .15, .15}, .7};

// The pixels of a picture, and which of them an element covers.
class Raster {
 public:
  Raster(const Box& window, int width, int height)
      : window_(window), width_(width), height_(height) {}

  /// The position in the data of a pixel's centre.
  [[nodiscard]] Vec2 place(int column, int row) const {
    return {window_.x0 + (column + .5) / width_ * (window_.x1 - window_.x0),
            window_.y1 - (row + .5) / height_ * (window_.y1 - window_.y0)};
  }

  /// Calls f(column, row) for each pixel whose centre is inside the ring. If rings share an edge, a
  /// centre belongs to exactly one of them, because the crossings of a row with the edge have the
  /// same bits in both. `crossings` is working memory.
  template <class F>
  void each_pixel(const std::vector<Vec2>& ring, std::vector<double>& crossings, const F& f) const {
    Box box;
    for (const Vec2& p : ring) box.include(p.x(), p.y());
    const double per_row = (window_.y1 - window_.y0) / height_;
    const auto row_of = [&](double y) {
      return static_cast<int>(std::clamp((window_.y1 - y) / per_row, -1., height_ + 1.));
    };
    const double per_column = (window_.x1 - window_.x0) / width_;
    const auto first_right_of = [&](double x) {
      return static_cast<int>(
          std::ceil(std::clamp((x - window_.x0) / per_column - .5, 0., width_ + 0.)));
    };
    const int last = std::min(row_of(box.y0) + 1, height_ - 1);
    for (int row = std::max(row_of(box.y1) - 1, 0); row <= last; ++row) {
      const double y = place(0, row).y();
      crossings.clear();
      for (size_t i = 0; i < ring.size(); ++i) {
        Vec2 a = ring[i], b = after(ring, i);
        if ((a.y() <= y) == (b.y() <= y)) continue;
        if (a.y() > b.y()) std::swap(a, b);
        crossings.push_back(a.x() + (y - a.y()) / (b.y() - a.y()) * (b.x() - a.x()));
      }
      std::sort(crossings.begin(), crossings.end());
      for (size_t i = 0; i + 1 < crossings.size(); i += 2) {
        const int end = first_right_of(crossings[i + 1]);
        for (int column = first_right_of(crossings[i]); column < end; ++column) f(column, row);
      }
    }
  }

 private:
  Box window_;
  int width_, height_;
};

std::vector<Vec2> ring_of(const Mesh& mesh, int element) {
  std::vector<Vec2> ring;
  for (const int node : mesh.element(element)) ring.push_back(mesh.nodes[node]);
  return ring;
}

std::vector<Colour> paint(const Field& field, const Box& window, double low, double high, int width,
                          int height) {
  std::vector<Colour> pixels(static_cast<size_t>(width) * static_cast<size_t>(height), kEmpty);
  const Raster raster(window, width, height);
  const auto colour = [&](double value) {
    return std::isfinite(value) ? viridis((value - low) / (high - low)) : kGrey;
  };
  std::vector<double> crossings, weights;
  std::vector<Vec2> relative;
  for (int e = 0; e < field.mesh.element_count(); ++e) {
    const std::vector<Vec2> ring = ring_of(field.mesh, e);
    const std::span<const int> nodes = field.mesh.element(e);
    const bool varies = field.nodal && !field.blank[e];
    const Colour even = varies ? kEmpty : field.blank[e] ? kGrey : colour(field.values[e]);
    weights.resize(ring.size());
    raster.each_pixel(ring, crossings, [&](int column, int row) {
      Colour& pixel = pixels[static_cast<size_t>(row) * width + column];
      if (!varies) {
        pixel = even;
        return;
      }
      relative = ring;
      for (Vec2& p : relative) p -= raster.place(column, row);
      interpolation_weights(relative, weights);
      double value = 0;
      for (size_t i = 0; i < weights.size(); ++i) value += weights[i] * field.values[nodes[i]];
      pixel = colour(value);
    });
  }
  return pixels;
}

// The boundary edges, joined into closed lines.
std::vector<std::vector<Vec2>> outlines(const Mesh& mesh) {
  const std::vector<MeshEdge> edges = boundary_edges(mesh);
  std::vector<std::vector<int>> leaving(mesh.nodes.size());
  for (const MeshEdge& edge : edges) leaving[edge.nodes[0]].push_back(edge.nodes[1]);
  std::vector<std::vector<Vec2>> lines;
  for (const MeshEdge& edge : edges) {
    int node = edge.nodes[0];
    if (leaving[node].empty()) continue;
    std::vector<Vec2>& line = lines.emplace_back();
    while (!leaving[node].empty()) {
      line.push_back(mesh.nodes[node]);
      const int next = leaving[node].back();
      leaving[node].pop_back();
      node = next;
    }
  }
  return lines;
}

// The range of some values.
struct Spread {
  double low = HUGE_VAL, high = -HUGE_VAL;
  void include(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
};

// The range of the values of a field that are visible inside a window.
Spread spread(const Field& field, const Box& window) {
  Spread result;
  for (int e = 0; e < field.mesh.element_count(); ++e) {
    if (field.blank[e]) continue;
    Box box;
    for (const int node : field.mesh.element(e)) {
      box.include(field.mesh.nodes[node].x(), field.mesh.nodes[node].y());
    }
    if (apart(box, window)) continue;
    if (!field.nodal) result.include(field.values[e]);
    for (const int node : field.mesh.element(e)) {
      if (field.nodal) result.include(field.values[node]);
    }
  }
  return result;
}

// Positions and scales of a panel. Lengths in points unless stated.
struct PanelLayout {
  Box window;              // visible region, m
  double low, high_value;  // ends of the colour scale
  bool values_below, values_above;
  int columns, rows;
  double wide, high;                // size of a frame
  double label;                     // height of the caption above a frame
  std::vector<std::string> ranges;  // of the values of each field, for its caption
  [[nodiscard]] double frames_width() const { return columns * wide + (columns - 1) * kColumnGap; }
  [[nodiscard]] double width() const { return kLeft + frames_width() + kRight; }
  [[nodiscard]] double frames_height() const {
    return rows * high + (rows - 1) * (label + kRowGap);
  }
  [[nodiscard]] double height() const { return kPanelTitle + label + frames_height() + kBelow; }
};

Box box_around(const std::vector<ShownField>& fields) {
  Box box;
  for (const ShownField& shown : fields) {
    for (const Vec2& p : shown.field.mesh.nodes) box.include(p.x(), p.y());
  }
  return box.grown(kMargin * std::min(box.x1 - box.x0, box.y1 - box.y0));
}

std::string number(double value) {
  const std::string digits = fmt::format("{:.3g}", std::abs(value));
  return (value < 0 && digits != "0" ? "−" : "") + digits;
}

// Chooses the number of columns that makes the frames largest.
PanelLayout lay_out(const FieldPanel& panel, const Canvas& ruler) {
  PanelLayout layout{};
  layout.window = panel.window ? *panel.window : box_around(panel.fields);
  const double w = layout.window.x1 - layout.window.x0;
  const double h = layout.window.y1 - layout.window.y0;
  const int count = static_cast<int>(panel.fields.size());
  double best = 0;
  for (int columns = 1; columns <= count; ++columns) {
    const int rows = (count + columns - 1) / columns;
    const double scale =
        std::min((kWide - (columns - 1) * kColumnGap) / columns / w,
                 ((rows == 1 ? kHighAlone : kHigh) - (rows - 1) * (kRowGap + kLabel)) / rows / h);
    if (!(scale > best * (1 + 1e-9))) continue;
    best = scale;
    layout.columns = columns;
    layout.rows = rows;
  }
  layout.wide = std::max(kShortest, std::round(best * w));
  layout.high = std::max(kShortest, std::round(best * h));
  // A frame that had to be wider or higher shows more of the surroundings.
  const double more_x = std::max(0., layout.wide / best - w) / 2;
  const double more_y = std::max(0., layout.high / best - h) / 2;
  layout.window = {layout.window.x0 - more_x, layout.window.y0 - more_y, layout.window.x1 + more_x,
                   layout.window.y1 + more_y};
  layout.label = kLabel;
  Spread all;
  for (const auto& [label, field] : panel.fields) {
    const Spread one = spread(field, layout.window);
    layout.ranges.emplace_back();
    if (!(one.low <= one.high)) continue;
    all.include(panel.scale * one.low);
    all.include(panel.scale * one.high);
    layout.ranges.back() = fmt::format("{} … {} {}", number(panel.scale * one.low),
                                       number(panel.scale * one.high), panel.unit);
    const double text = ruler.text_width(label + "   " + layout.ranges.back(), kLabelFont);
    if (text > layout.wide) layout.label = kTwoLabels;
  }
  layout.low = panel.range ? panel.range->x() : all.low;
  layout.high_value = panel.range ? panel.range->y() : all.high;
  layout.values_below = all.low < layout.low;
  layout.values_above = all.high > layout.high_value;
  if (!(layout.low < layout.high_value)) {  // all values are equal, or there are none
    const double middle = std::isfinite(all.low) ? all.low : 0;
    const double half = middle == 0 ? 1 : std::abs(middle) / 2;
    layout.low = middle - half;
    layout.high_value = middle + half;
  }
  return layout;
}

void draw_panel(Canvas& canvas, const FieldPanel& panel, const PanelLayout& layout,
                const Vec2& corner) {
  const double left = corner.x() + kLeft;
  std::string title = panel.quantity->meaning;
  title[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(title[0])));
  if (!panel.title.empty()) title += ": " + panel.title;
  canvas.text({left, corner.y() + kPanelTitle - 10}, title, {kTitleFont});
  const double first = corner.y() + kPanelTitle + layout.label;
  const int pixels = canvas.pixels_per_point();
  const int wide = static_cast<int>(layout.wide) * pixels;
  const int high = static_cast<int>(layout.high) * pixels;
  for (size_t i = 0; i < panel.fields.size(); ++i) {
    const auto& [label, field] = panel.fields[i];
    const int column = static_cast<int>(i) % layout.columns;
    const int row = static_cast<int>(i) / layout.columns;
    const double x = left + column * (layout.wide + kColumnGap);
    const double y = first + row * (layout.high + layout.label + kRowGap);
    const Box frame{x, y, x + layout.wide, y + layout.high};
    canvas.image(frame, wide, high,
                 paint(field, layout.window, layout.low / panel.scale,
                       layout.high_value / panel.scale, wide, high));
    const Axes axes(frame, layout.window, {"x", "m"}, {"y", "m"});
    canvas.clip(frame);
    for (const std::vector<Vec2>& line : outlines(field.mesh)) {
      canvas.stroke(axes(line), true, kOutline);
    }
    canvas.unclip();
    const bool lowest = i + static_cast<size_t>(layout.columns) >= panel.fields.size();
    axes.draw(canvas, lowest, column == 0);
    canvas.text({x, y - layout.label + kLabel / 2}, label, {kLabelFont});
    canvas.text({frame.x1, y - kLabel / 2}, layout.ranges[i], {kLabelFont, Align::right});
  }
  const double bar = std::round(std::min(layout.frames_height(), kBarHigh));
  const double x = left + layout.frames_width() + kBarGap;
  const double y = std::round(first + (layout.frames_height() - bar) / 2);
  draw_colour_scale(canvas, {x, y, x + kBarWidth, y + bar}, {panel.quantity->symbol, panel.unit},
                    layout.low, layout.high_value, layout.values_below, layout.values_above);
}

}  // namespace

std::string draw_fields(const FieldFigure& figure, PictureFormat format) {
  const Canvas ruler(format, 1, 1);
  std::vector<PanelLayout> layouts;
  double width = 2 * kLeft + ruler.text_width(figure.title, kFigureFont);
  double height = kTop + kBottom;
  for (const FieldPanel& panel : figure.panels) {
    layouts.push_back(lay_out(panel, ruler));
    width = std::max(width, layouts.back().width());
    height += layouts.back().height();
  }
  width = 2 * std::ceil(width / 2);
  Canvas canvas(format, width, height);
  canvas.text({width / 2, kTop / 2}, figure.title, {kFigureFont, Align::centre});
  double top = kTop;
  for (size_t p = 0; p < layouts.size(); ++p) {
    // Images need corners at whole points (see Canvas::image).
    draw_panel(canvas, figure.panels[p], layouts[p],
               {std::floor((width - layouts[p].width()) / 2), top});
    top += layouts[p].height();
  }
  return canvas.finish();
}

void write_fields(const std::string& folder, const FieldFigure& figure) {
  create_folder(folder);
  write_file(folder + "/fields.png", draw_fields(figure, PictureFormat::png));
  write_file(folder + "/fields.svg", draw_fields(figure, PictureFormat::svg));
}

}  // namespace apothem
