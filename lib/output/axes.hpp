// Axes and colour scales around the pictures of fields over the plane.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "geometry/polygon/point.hpp"
#include "lib/output/canvas.hpp"

namespace apothem {

/// The smallest step of 1, 2 or 5 times a power of ten that divides `range` into at most `most`
/// parts.
double round_step(double range, int most);

/// A time in s as it stands in pictures: in ms where it is short.
std::string time_in_words(double time);

/// A unit with the metric prefix that suits values of up to `largest`, and the factor from values
/// in `unit` to it, as ("MPa", 1e-6).
std::pair<std::string, double> prefixed(const std::string& unit, double largest);

/// The name and unit of an axis.
struct Axis {
  std::string name;
  std::string unit;
  double zero = 0;  ///< coordinate at which the data have 0, however far away
};

/// A frame with two axes, which maps the plane of the data to the canvas.
class Axes {
 public:
  /// Maps the rectangle `window` of the data to the rectangle `frame` of the canvas (points). The
  /// scales of x and y may differ.
  Axes(const Box& frame, const Box& window, Axis x, Axis y);

  /// The position on the canvas, in points, of a position in the data.
  [[nodiscard]] Vec2 operator()(const Vec2& data) const;
  [[nodiscard]] std::vector<Vec2> operator()(std::vector<Vec2> data) const;

  /// Draws the frame and ticks; if `below`, the numbers and name of x, and if `left`, those of y.
  /// Far from zero the numbers count from a round value, which the name of the axis states; powers
  /// of a thousand are moved to the unit.
  void draw(Canvas& canvas, bool below = true, bool left = true) const;

 private:
  Box frame_, window_;
  Axis x_, y_;
};

/// How wide the name above a colour scale of this height is, in points.
double colour_scale_width(const Canvas& ruler, const Axis& axis, double low, double high,
                          double height);

/// Draws a vertical continuous colour scale for [low, high] with numbers at round values and the
/// axis' name above. A triangle at an end shows that there are values beyond it.
void draw_colour_scale(Canvas& canvas, const Box& frame, const Axis& axis, double low, double high,
                       bool values_below, bool values_above);

/// Draws a vertical colour bar with one band per colour between ascending `bounds`, and a number at
/// every `stride`-th bound.
void draw_colour_bar(Canvas& canvas, const Box& frame, const std::vector<double>& bounds,
                     const std::vector<Colour>& colours, size_t stride, const std::string& name);

}  // namespace apothem
