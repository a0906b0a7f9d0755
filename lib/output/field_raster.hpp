// Private header of the pictures of fields: the pixels that elements cover.
#pragma once

#include <functional>
#include <vector>

#include "lib/output/canvas.hpp"
#include "lib/output/field.hpp"

namespace apothem {

/// The colours of width x height pixels of a window (m), row by row from the top: of elements that
/// of their value, interpolated if it belongs to nodes; grey where there is no value; transparent
/// outside of elements.
std::vector<Colour> paint(const Field& field, const Box& window,
                          const std::function<Colour(double)>& colour_of, int width, int height);

}  // namespace apothem
