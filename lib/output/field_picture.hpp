// Draws fields: the deformed bodies, each element in the colour of its value (nodal values are
// interpolated), with axes and one colour scale per panel.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "lib/output/canvas.hpp"
#include "lib/output/field.hpp"

namespace apothem {

/// A field with its caption, and what is drawn over it.
struct ShownField {
  std::string label;
  Field field;
  std::vector<ForceChain> chains = {};
  std::vector<Rose> roses = {};
};

/// Fields of one quantity, drawn with the same window and colour scale.
struct FieldPanel {
  std::string title;  ///< heading; may be empty
  const FieldQuantity* quantity = nullptr;
  double scale = 1;           ///< factor from the field's values to the numbers in the picture
  std::string unit;           ///< unit of the numbers in the picture
  std::optional<Box> window;  ///< visible region, m; empty: all bodies
  /// Ends of the colour scale, in `unit`; empty: all values that are visible.
  std::optional<Vec2> range;
  std::vector<ShownField> fields;
};

/// Several panels in one picture.
struct FieldFigure {
  std::string title;
  std::vector<FieldPanel> panels;  ///< from top to bottom
};

/// The picture as the bytes of a file. Also in an SVG the colours are pixels, so that its size does
/// not grow with the mesh; everything else in it is vectors. Throws as Canvas::finish does.
std::string draw_fields(const FieldFigure& figure, PictureFormat format);

/// The fields of the first panel as pictures of their own, PNG files of the same size, whose
/// window, colour scale and widths of chains are those of all of them. Each is given to `take`.
/// Throws as Canvas::finish does.
void draw_each(const FieldFigure& figure, const std::function<void(std::string)>& take);

/// Writes fields.png and fields.svg into the folder, which is created if necessary. Throws
/// SystemFailure.
void write_fields(const std::string& folder, const FieldFigure& figure);

}  // namespace apothem
