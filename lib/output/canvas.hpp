// A drawing surface for pictures, with one interface for PNG (pixels) and SVG (vectors). Lengths
// are points (1/72 inch); x goes to the right and y downwards. No display is needed.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "geometry/polygon/point.hpp"

namespace apothem {

/// File formats of pictures.
enum class PictureFormat { png, svg };

/// The format that the extension of a file's name stands for, if it is known.
std::optional<PictureFormat> picture_format(const std::string& file);

/// Red, green, blue and opacity, from 0 to 1.
struct Colour {
  double red, green, blue;
  double alpha = 1;
};

/// The colour map Viridis (Smith, van der Walt & Firing; CC0) at `share` from 0 to 1. Equal steps
/// look equal, also in shades of grey and to colour-blind readers.
Colour viridis(double share);

/// Colours for names rather than sizes: number `index` of those of M. Okabe and K. Ito (Color
/// Universal Design, 2008), which colour-blind readers can tell apart. From the eighth on they
/// repeat, lighter.
Colour okabe_ito(size_t index);

/// The corners of a box.
std::vector<Vec2> box_ring(const Box& box);

/// A circle of the data as a ring of corners, which is drawn as an ellipse if axes are stretched.
std::vector<Vec2> circle_ring(const Vec2& centre, double radius);

/// How a line is drawn.
struct Pen {
  Colour colour = {0, 0, 0};
  double width = 1;  ///< points
  /// Alternating lengths of dashes and gaps, points; empty: a solid line.
  std::vector<double> dashes = {};
};

/// Which part of a text stands at its position.
enum class Align { left, centre, right };
/// How a text is drawn.
struct Font {
  double size = 11;  ///< points
  Align align = Align::left;
  bool upwards = false;  ///< turned by 90 degrees, to be read from below to above
};

/// A picture that is being drawn.
class Canvas {
 public:
  /// A white canvas; `width` and `height` in points.
  Canvas(PictureFormat format, double width, double height);
  ~Canvas();
  Canvas(const Canvas&) = delete;
  Canvas& operator=(const Canvas&) = delete;

  /// Fills a polygon.
  void fill(const std::vector<Vec2>& ring, const Colour& colour);
  /// Fills what an odd number of the rings surround, like a polygon with holes.
  void fill_even_odd(const std::vector<std::vector<Vec2>>& rings, const Colour& colour);
  /// Draws a line through the points and, if `closed`, back to the first one.
  void stroke(const std::vector<Vec2>& line, bool closed, const Pen& pen);
  /// Draws an image of width x height pixels into the frame; `colours` go row by row from the top,
  /// and those with alpha 0 leave what is below visible. If the image has pixels_per_point() pixels
  /// per point and the frame's corners lie at whole points, each colour is one pixel of a PNG.
  void image(const Box& frame, int width, int height, const std::vector<Colour>& colours);
  /// Restricts all drawing to the frame until unclip() is called.
  void clip(const Box& frame);
  void unclip();
  void circle(const Vec2& centre, double radius, const Colour& inside, const Pen& rim);
  /// Draws a text. `at` is at half the height of its capital letters.
  void text(const Vec2& at, const std::string& text, const Font& font = {});
  /// The number of pixels per point that an image should have: more in an SVG, which readers
  /// enlarge.
  [[nodiscard]] int pixels_per_point() const;
  /// Width of a text in points at a font size in points.
  [[nodiscard]] double text_width(const std::string& text, double size) const;

  /// Ends the drawing and returns the picture as the bytes of a file. Throws std::runtime_error if
  /// the picture cannot be made.
  std::string finish();

 private:
  struct Surface;
  std::unique_ptr<Surface> surface_;
};

}  // namespace apothem
