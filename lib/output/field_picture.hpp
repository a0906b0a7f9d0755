// Fields as pictures: bodies where they are, every element in the colour of its value (of nodal
// values, interpolated), with axes and one scale of colours per panel.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "output/canvas.hpp"
#include "output/field.hpp"

namespace apothem {

struct ShownField {
  std::string label;
  Field field;
};

/// Fields of one quantity, all with the same window and colours.
struct FieldPanel {
  std::string title;  ///< may be empty
  const FieldQuantity* quantity = nullptr;
  double scale = 1;           ///< shown is the value times this
  std::string unit;           ///< of what is shown
  std::optional<Box> window;  ///< m; empty: all bodies
  std::optional<Vec2> range;  ///< of what is shown; empty: all values
  std::vector<ShownField> fields;
};

struct FieldFigure {
  std::string title;
  std::vector<FieldPanel> panels;  ///< one below the other
};

/// The bytes of a picture file. The colours are pixels in an SVG as well, whose size therefore does
/// not grow with the mesh; all else in it is drawn.
std::string draw_fields(const FieldFigure& figure, PictureFormat format);

/// Writes fields.png and fields.svg into the folder, which it creates. Throws SystemFailure.
void write_fields(const std::string& folder, const FieldFigure& figure);

}  // namespace apothem
