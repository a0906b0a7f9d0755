#include "lib/output/picture.hpp"

#include <fmt/format.h>

#include "geometry/polygon/predicates.hpp"
#include "lib/output/axes.hpp"

namespace apothem {
namespace {

using Ring = std::vector<Vec2>;

// Lengths in points.
constexpr double kLongest = 470, kHighest = 430, kShortest = 190;  // limits of the frame
constexpr double kLeft = 78, kRight = 92, kTop = 60, kBottom = 70;
// Margin at the edge, and least width, of the canvas.
constexpr double kEdge = 20, kNarrowest = 480;
constexpr double kTitle = 13, kNote = 10;  // font sizes of the title and of notes
constexpr double kThin = 1. / 16;          // height over length below which the scales are unequal
constexpr double kMargin = .05;            // around the polygon, over its size

const Colour kBlack{0, 0, 0};
const Colour kWhite{1, 1, 1};
const Colour kRed{.9, .1, .15};
const Pen kContour{{0, 0, 0, .45}, .6};
const Pen kOutline{kBlack, 1.4};
const Pen kSingular{kRed, 2};
const Pen kCircle{kBlack, 1, {5, 3}};
const Pen kHalo{{1, 1, 1, .5}, 2};  // makes the circle's dashes visible on dark bands

// Maps the polygon's local coordinates to those of the drawing.
struct View {
  Vec2 start = Vec2::Zero();
  Vec2 along = Vec2::UnitX();
  bool turned = false;
  bool stretched = false;

  [[nodiscard]] Vec2 operator()(const Vec2& p) const {
    return {along.dot(p - start), cross(along, p - start)};
  }
  [[nodiscard]] Ring operator()(Ring ring) const {
    for (Vec2& p : ring) p = (*this)(p);
    return ring;
  }
};

double slenderness(const Box& box) {
  return std::min(box.x1 - box.x0, box.y1 - box.y0) / box.extent();
}

// An ordinary polygon is drawn upright and to scale. A thin one is stretched: along a coordinate
// axis if it is thin in that direction, otherwise along its longest chord.
View choose_view(const Ring& ring) {
  View chord;
  double longest = 0;
  for (const Vec2& p : ring) {
    for (const Vec2& q : ring) {
      const double length = (q - p).norm();
      if (!precedes(p, q) || !(length > longest)) continue;
      longest = length;
      chord = {p, (q - p) / length, true, true};
    }
  }
  constexpr double kNearlyLeast = 4;
  View upright;
  const double thickness = slenderness(box_of(ring));
  const double least = slenderness(box_of(chord(ring)));
  upright.stretched = thickness < kThin && thickness <= kNearlyLeast * least;
  return least > 0 && least < kThin && !upright.stretched ? chord : upright;
}

struct PictureLayout {
  Box window, frame;
};

PictureLayout lay_out(const Box& box, bool stretched) {
  const double w = box.x1 - box.x0;
  const double h = box.y1 - box.y0;
  if (stretched) {
    const double wide = w > h ? kLongest : kHighest / 2, high = w > h ? kHighest / 2 : kHighest;
    return {
        {box.x0 - kMargin * w, box.y0 - kMargin * h, box.x1 + kMargin * w, box.y1 + kMargin * h},
        {kLeft, kTop, kLeft + wide, kTop + high}};
  }
  const double scale = std::min(kLongest / w, kHighest / h) / (1 + 2 * kMargin);
  const double wide = std::max(kShortest, scale * w * (1 + 2 * kMargin));
  const double high = std::max(kShortest, scale * h * (1 + 2 * kMargin));
  const Vec2 middle((box.x0 + box.x1) / 2, (box.y0 + box.y1) / 2);
  const Vec2 half = Vec2(wide, high) / scale / 2;
  return {
      {middle.x() - half.x(), middle.y() - half.y(), middle.x() + half.x(), middle.y() + half.y()},
      {kLeft, kTop, kLeft + wide, kTop + high}};
}

// Bands of equal colour between values of phi.
struct Bands {
  std::vector<double> bounds;  // values of phi
  std::vector<Colour> colours;
};

// Every second bound is a contour line.
constexpr size_t kBandsPerLine = 2;
Bands make_bands(double top) {
  const double step = round_step(top, 10) / kBandsPerLine;
  Bands bands;
  for (int i = 0; i * step < top * (1 - 1e-6); ++i) bands.bounds.push_back(i * step);
  bands.bounds.push_back(top);
  const size_t count = bands.bounds.size() - 1;
  for (size_t i = 0; i < count; ++i) {
    bands.colours.push_back(viridis(static_cast<double>(i) / static_cast<double>(count)));
  }
  return bands;
}

class Drawing {
 public:
  Drawing(Canvas& canvas, const PotentialPicture& picture, const View& view, const Axes& axes)
      : canvas_(canvas), picture_(picture), view_(view), axes_(axes) {}

  void draw(const Bands& bands) {
    const double r = picture_.reference;
    Rings outline = rings_of(picture_.polygon);
    for (Ring& ring : outline) {
      for (Vec2& p : ring) p -= picture_.polygon.origin();
    }
    canvas_.fill_even_odd(place(outline), bands.colours[0]);
    std::vector<Rings> levels;
    for (size_t i = 1; i < bands.colours.size(); ++i) {
      levels.push_back(rings_of(singular_area(picture_.skeleton, bands.bounds[i] * r).polygons));
      canvas_.fill_even_odd(place(levels.back()), bands.colours[i]);
    }
    canvas_.fill_even_odd(place(rings_of(picture_.singular.polygons)), viridis(1));
    for (size_t i = kBandsPerLine; i < bands.colours.size(); i += kBandsPerLine) {
      for (const Ring& ring : levels[i - 1]) canvas_.stroke(place(ring), true, kContour);
    }
    draw_faces();
    draw_circles();
    draw_singular_area();
    for (const Ring& ring : outline) canvas_.stroke(place(ring), true, kOutline);
  }

  [[nodiscard]] Pen face_pen() const {
    return {{1, 1, 1, .85}, std::clamp(30. / picture_.polygon.size(), .2, 1.)};
  }

 private:
  [[nodiscard]] Ring place(const Ring& ring) const { return axes_(view_(ring)); }
  [[nodiscard]] Rings place(Rings rings) const {
    for (Ring& ring : rings) ring = place(ring);
    return rings;
  }
  [[nodiscard]] Vec2 place(const Vec2& point) const { return axes_(view_(point)); }

  void draw_faces() {
    const Skeleton& skeleton = picture_.skeleton;
    for (const Skeleton::Arc& arc : skeleton.arcs) {
      if (arc.right < 0) continue;
      canvas_.stroke({place(skeleton.nodes[arc.start].point), place(skeleton.nodes[arc.end].point)},
                     false, face_pen());
    }
  }

  void draw_circles() {
    for (const Vec2& centre : picture_.circle.centres) {
      const Ring ring = circle_ring(centre, picture_.circle.radius);
      canvas_.stroke(place(ring), true, kHalo);
      canvas_.stroke(place(ring), true, kCircle);
    }
  }

  void draw_singular_area() {
    for (const Ring& ring : rings_of(picture_.singular.polygons))
      canvas_.stroke(place(ring), true, kSingular);
    for (const auto& [a, b] : picture_.singular.segments) {
      canvas_.stroke({place(a), place(b)}, false, {kRed, 3.5});
    }
    for (const Vec2& p : picture_.singular.points)
      canvas_.circle(place(p), 4.5, kRed, {kWhite, .8});
    for (const Vec2& p : picture_.circle.centres) canvas_.circle(place(p), 2, kWhite, {kBlack, .8});
  }

  Canvas& canvas_;
  const PotentialPicture& picture_;
  const View& view_;
  const Axes& axes_;
};

std::string holes_in_words(const Polygon& polygon) {
  const int holes = polygon.rings() - 1;
  return holes == 0 ? "" : fmt::format(", {} hole{}", holes, holes == 1 ? "" : "s");
}

// The lines of the title.
std::vector<std::string> title(const PotentialPicture& picture, const View& view,
                               const PictureLayout& layout) {
  std::vector<std::string> lines{
      fmt::format("Distance potential φ, r = {:.6g} m ({})", picture.reference,
                  picture.reference_name),
      fmt::format("{} vertices{}, inradius {:.6g} m, roof height {:.6g} m", picture.polygon.size(),
                  holes_in_words(picture.polygon), picture.circle.radius,
                  picture.skeleton.roof_height)};
  if (view.stretched) {
    const double x = (layout.frame.x1 - layout.frame.x0) / (layout.window.x1 - layout.window.x0);
    const double y = (layout.frame.y1 - layout.frame.y0) / (layout.window.y1 - layout.window.y0);
    lines[1] += fmt::format("; {} stretched {:.3g} times",
                            view.turned ? "breadth"
                            : y > x     ? "y"
                                        : "x",
                            std::max(x / y, y / x));
  }
  return lines;
}

// Draws samples of all lines with their names, from left to right below the axes.
void draw_legend(Canvas& canvas, const Vec2& start, const Pen& faces,
                 const PotentialPicture& picture) {
  constexpr double kSample = 22, kGap = 18;
  Vec2 at = start;
  const auto sample = [&](const std::string& name, const Pen& pen) {
    canvas.stroke({at, at + Vec2(kSample, 0)}, false, pen);
    at.x() += kSample + 5;
    canvas.text(at, name, {kNote});
    at.x() += canvas.text_width(name, kNote) + kGap;
  };
  const Vec2 half(0, 5);
  canvas.fill({at - half, at - half + Vec2(kSample, 0), at + half + Vec2(kSample, 0), at + half},
              viridis(.3));
  sample("faces", faces);
  sample("inscribed circle", kCircle);
  if (picture.singular.kind() != SingularArea::Kind::none) {
    sample(fmt::format("singular area ({})", kind_name(picture.singular.kind())), kSingular);
  }
}

}  // namespace

std::string draw_potential(const PotentialPicture& picture, PictureFormat format) {
  const Ring ring = picture.polygon.local_vertices();
  const View view = choose_view(ring);
  const PictureLayout layout = lay_out(box_of(view(ring)), view.stretched);
  const Vec2 zero = picture.polygon.origin();
  const Axes axes =
      view.turned
          ? Axes(layout.frame, layout.window, {"along the longest chord", "m"}, {"across", "m"})
          : Axes(layout.frame, layout.window, {"x", "m", zero.x()}, {"y", "m", zero.y()});
  const Bands bands = make_bands(std::min(1.0, picture.skeleton.roof_height / picture.reference));

  const std::vector<std::string> lines = title(picture, view, layout);
  const Canvas ruler(format, 1, 1);
  const double text =
      std::max(ruler.text_width(lines[0], kTitle), ruler.text_width(lines[1], kNote));
  const double width = std::max(layout.frame.x1 + kRight, kLeft + text + kEdge);
  Canvas canvas(format, std::max(width, kNarrowest), layout.frame.y1 + kBottom);
  canvas.text({kLeft, 18}, lines[0], {kTitle});
  canvas.text({kLeft, 36}, lines[1], {kNote});
  Drawing drawing(canvas, picture, view, axes);
  drawing.draw(bands);
  axes.draw(canvas);
  draw_colour_bar(
      canvas, {layout.frame.x1 + 22, layout.frame.y0 + 14, layout.frame.x1 + 38, layout.frame.y1},
      bands.bounds, bands.colours, kBandsPerLine, "φ");
  draw_legend(canvas, {kLeft, layout.frame.y1 + 52}, drawing.face_pen(), picture);
  return canvas.finish();
}

}  // namespace apothem
