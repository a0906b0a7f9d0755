// A drawing surface for figures: one set of calls for pixels (PNG) and for vectors (SVG). Lengths
// are points (1/72 inch), x to the right and y downwards; no display is needed.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "geometry/point.hpp"

namespace apothem {

enum class PictureFormat { png, svg };

/// By the extension of a file's name.
std::optional<PictureFormat> picture_format(const std::string& file);

struct Colour {
  double red, green, blue;
  double alpha = 1;
};

/// Viridis (Smith, van der Walt & Firing; CC0): equal steps look equal, also in grey and to the
/// colour-blind. `share` from 0 to 1.
Colour viridis(double share);

struct Pen {
  Colour colour = {0, 0, 0};
  double width = 1;
  std::vector<double> dashes = {};  ///< on, off, ...
};

enum class Align { left, centre, right };
struct Font {
  double size = 11;
  Align align = Align::left;
  bool upwards = false;  ///< turned by 90 degrees
};

class Canvas {
 public:
  /// White.
  Canvas(PictureFormat format, double width, double height);
  ~Canvas();
  Canvas(const Canvas&) = delete;
  Canvas& operator=(const Canvas&) = delete;

  void fill(const std::vector<Vec2>& ring, const Colour& colour);
  void stroke(const std::vector<Vec2>& line, bool closed, const Pen& pen);
  /// Colours by rows from the top; those with alpha 0 leave what is below. At pixels_per_point() of
  /// the frame's size, with its corners at whole points, each is one pixel of a PNG.
  void image(const Box& frame, int width, int height, const std::vector<Colour>& colours);
  /// Nothing is drawn outside the frame until unclip().
  void clip(const Box& frame);
  void unclip();
  void circle(const Vec2& centre, double radius, const Colour& inside, const Pen& rim);
  /// At the middle of the capitals' height.
  void text(const Vec2& at, const std::string& text, const Font& font = {});
  /// What an image should have: more in an SVG, which may be enlarged.
  [[nodiscard]] int pixels_per_point() const;
  [[nodiscard]] double text_width(const std::string& text, double size) const;

  /// The picture as the bytes of a file; ends the drawing. Throws std::runtime_error if the picture
  /// could not be made.
  std::string finish();

 private:
  struct Surface;
  std::unique_ptr<Surface> surface_;
};

}  // namespace apothem
