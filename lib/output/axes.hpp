// Axes and colour bar: what every figure of a field over the plane needs around it.
#pragma once

#include <string>
#include <vector>

#include "geometry/point.hpp"
#include "output/canvas.hpp"

namespace apothem {

/// A step of 1, 2 or 5 times a power of ten that divides `range` into at most `most` parts.
double round_step(double range, int most);

struct Axis {
  std::string name;
  std::string unit;
  double zero = 0;  ///< coordinate that the data's 0 stands for, however far away
};

class Axes {
 public:
  /// The window of the data fills the frame on the canvas; its scales may differ.
  Axes(const Box& frame, const Box& window, Axis x, Axis y);

  /// Place on the canvas.
  [[nodiscard]] Vec2 operator()(const Vec2& data) const;
  [[nodiscard]] std::vector<Vec2> operator()(std::vector<Vec2> data) const;

  /// Frame and ticks; numbers and names of x below, of y on the left. Far from zero the numbers
  /// count from a round one that the name tells; powers of a thousand go to the unit.
  void draw(Canvas& canvas, bool below = true, bool left = true) const;

 private:
  Box frame_, window_;
  Axis x_, y_;
};

/// Vertical: the colours of [low, high] without steps, numbers at round values, its name above.
/// Points at the ends show that there are values beyond.
void draw_colour_scale(Canvas& canvas, const Box& frame, const Axis& axis, double low, double high,
                       bool values_below, bool values_above);

/// Vertical: bands between ascending bounds, each in its colour; numbers at every `stride`-th
/// bound.
void draw_colour_bar(Canvas& canvas, const Box& frame, const std::vector<double>& bounds,
                     const std::vector<Colour>& colours, size_t stride, const std::string& name);

}  // namespace apothem
