#include "lib/output/potential_figure.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/polygon/cyclic.hpp"
#include "geometry/polygon/half_plane.hpp"
#include "lib/output/axes.hpp"
#include "lib/output/files.hpp"

namespace apothem {
namespace {

using Ring = std::vector<Vec2>;

// Lengths in points.
constexpr double kWide = 250, kHigh = 220;  // of a frame
constexpr double kLeft = 56, kBelow = 42, kAbove = 24, kGap = 14;
constexpr double kTitle = 36, kPanelTitle = 26, kBar = 90;
constexpr double kMargin = .06;  // around a polygon, over its size
constexpr int kBands = 20;       // of equal width; every second bound is a contour line

const Colour kRed{.9, .1, .15};
const Pen kContour{{0, 0, 0, .4}, .5};
const Pen kBorder{{1, 1, 1, .9}, 1.1};
const Pen kOutline{{0, 0, 0}, 1.3};
const Pen kSingular{kRed, 2};
const Pen kCircle{{0, 0, 0}, 1, {5, 3}};

Colour band_colour(int band) { return viridis((band + .5) / kBands); }

// What lies above a level in a part, and the level line in it. In a part that is not convex the
// edges of the polygon along the level line may cover each other; the area between them is zero.
Ring above(const PotentialPiece& piece, double level, Ring& line) {
  line.clear();
  Ring part = part_above(
      piece.ring, [&](const Vec2& p) { return piece.phi(p) - level; }, &line);
  const Vec2 along(-piece.gradient.y(), piece.gradient.x());
  std::ranges::sort(line,
                    [&](const Vec2& p, const Vec2& q) { return along.dot(p) < along.dot(q); });
  return part;
}

Box window_of(const PotentialMap& map) {
  const Box box = box_of(map.outline);
  const double scale =
      (1 + 2 * kMargin) * std::max((box.x1 - box.x0) / kWide, (box.y1 - box.y0) / kHigh);
  const Vec2 middle((box.x0 + box.x1) / 2, (box.y0 + box.y1) / 2);
  const Vec2 half = Vec2(kWide, kHigh) * scale / 2;
  return {middle.x() - half.x(), middle.y() - half.y(), middle.x() + half.x(),
          middle.y() + half.y()};
}

void draw_bands(Canvas& canvas, const Axes& axes, const PotentialMap& map) {
  if (map.holes.empty()) {
    canvas.fill(axes(map.outline), band_colour(0));
  } else {
    Rings rings{axes(map.outline)};
    for (const Ring& hole : map.holes) rings.push_back(axes(hole));
    canvas.fill_even_odd(rings, band_colour(0));
  }
  Ring line;
  std::vector<Ring> contours;
  for (int band = 1; band <= kBands; ++band) {
    for (const PotentialPiece& piece : map.pieces) {
      const Ring part = above(piece, static_cast<double>(band) / kBands, line);
      if (part.size() > 2) canvas.fill(axes(part), band_colour(std::min(band, kBands - 1)));
      for (size_t i = 0; band % 2 == 0 && i + 1 < line.size(); i += 2) {
        contours.push_back({line[i], line[i + 1]});
      }
    }
  }
  for (const Ring& contour : contours) canvas.stroke(axes(contour), false, kContour);
  for (const PotentialPiece& piece : map.pieces) canvas.stroke(axes(piece.ring), true, kBorder);
}

void draw_circles(Canvas& canvas, const Axes& axes, const InscribedCircle& circle) {
  for (const Vec2& centre : circle.centres) {
    canvas.stroke(axes(circle_ring(centre, circle.radius)), true, kCircle);
  }
}

void draw_singular(Canvas& canvas, const Axes& axes, const SingularArea& singular) {
  for (const Ring& ring : rings_of(singular.polygons)) canvas.stroke(axes(ring), true, kSingular);
  for (const auto& [a, b] : singular.segments)
    canvas.stroke({axes(a), axes(b)}, false, {kRed, 3.5});
  for (const Vec2& p : singular.points) canvas.circle(axes(p), 4, kRed, {{1, 1, 1}, .8});
}

void draw_map(Canvas& canvas, const ShownMap& shown, const Box& frame) {
  const Axes axes(frame, window_of(shown.map), {"x", "m"}, {"y", "m"});
  draw_bands(canvas, axes, shown.map);
  if (shown.map.circle) draw_circles(canvas, axes, *shown.map.circle);
  if (shown.map.singular) draw_singular(canvas, axes, *shown.map.singular);
  canvas.stroke(axes(shown.map.outline), true, kOutline);
  for (const Ring& hole : shown.map.holes) canvas.stroke(axes(hole), true, kOutline);
  for (const MarkedPoint& point : shown.points) {
    const Vec2 at = axes(point.at);
    canvas.circle(at, 3.2, {1, 1, 1}, {{0, 0, 0}, 1});
    const double width = canvas.text_width(point.name, 10.5) + 5;
    canvas.fill(
        {at + Vec2(5, -8), at + Vec2(5 + width, -8), at + Vec2(5 + width, 7), at + Vec2(5, 7)},
        {1, 1, 1, .8});
    canvas.text(at + Vec2(7.5, 0), point.name, {10.5});
  }
  axes.draw(canvas);
  canvas.text({frame.x0, frame.y0 - 11}, shown.label, {10.5});
}

// No more than two, so that labels can be read on a narrow screen.
size_t columns_of(const PotentialPanel& panel) { return std::min<size_t>(2, panel.maps.size()); }

size_t columns_of(const PotentialFigure& figure) {
  size_t columns = 1;
  for (const PotentialPanel& panel : figure.panels) columns = std::max(columns, columns_of(panel));
  return columns;
}

double column_width() { return kLeft + kWide + kGap; }
double row_height() { return kAbove + kHigh + kBelow; }

double height_of(const PotentialPanel& panel) {
  const size_t rows = (panel.maps.size() + columns_of(panel) - 1) / columns_of(panel);
  return (panel.title.empty() ? 0 : kPanelTitle) + static_cast<double>(rows) * row_height();
}

void draw_scale(Canvas& canvas, double left, double top) {
  std::vector<double> bounds;
  std::vector<Colour> colours;
  for (int i = 0; i <= kBands; ++i) bounds.push_back(static_cast<double>(i) / kBands);
  for (int i = 0; i < kBands; ++i) colours.push_back(band_colour(i));
  draw_colour_bar(canvas, {left, top, left + 16, top + kHigh}, bounds, colours, 2, "φ [1]");
}

}  // namespace

std::string draw_potentials(const PotentialFigure& figure, PictureFormat format) {
  const Canvas ruler(format, 1, 1);
  const double frames = static_cast<double>(columns_of(figure)) * column_width();
  double width = std::max(frames + kBar, ruler.text_width(figure.title, 13) + 2 * kGap);
  double height = kTitle;
  for (const PotentialPanel& panel : figure.panels) {
    width = std::max(width, ruler.text_width(panel.title, 12) + kLeft);
    height += height_of(panel);
  }
  Canvas canvas(format, std::ceil(width), std::ceil(height));
  canvas.text({width / 2, kTitle / 2}, figure.title, {13, Align::centre});
  double top = kTitle;
  for (const PotentialPanel& panel : figure.panels) {
    double first = top;
    if (!panel.title.empty()) {
      canvas.text({kLeft, top + kPanelTitle / 2}, panel.title, {12});
      first += kPanelTitle;
    }
    for (size_t i = 0; i < panel.maps.size(); ++i) {
      const double x = static_cast<double>(i % columns_of(panel)) * column_width() + kLeft;
      const double y = first + static_cast<double>(i / columns_of(panel)) * row_height() + kAbove;
      draw_map(canvas, panel.maps[i], {x, y, x + kWide, y + kHigh});
    }
    draw_scale(canvas, frames + kGap, first + kAbove);
    top += height_of(panel);
  }
  return canvas.finish();
}

void write_potentials(const std::string& folder, const PotentialFigure& figure) {
  create_folder(folder);
  write_file(folder + "/potentials.png", draw_potentials(figure, PictureFormat::png));
  write_file(folder + "/potentials.svg", draw_potentials(figure, PictureFormat::svg));
}

}  // namespace apothem
