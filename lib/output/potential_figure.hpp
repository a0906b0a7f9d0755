// Draws potentials of several polygons side by side (Figs. 2 to 5 of the paper): bands and contour
// lines of phi, the parts in which it is linear, the singular area, the inscribed circle and marked
// points. The bands are exact level sets; nothing is sampled.
#pragma once

#include <string>
#include <vector>

#include "lib/output/canvas.hpp"
#include "lib/output/potential_map.hpp"

namespace apothem {

/// A marked point with its name.
struct MarkedPoint {
  std::string name;
  Vec2 at;  ///< m
};

/// A map with its caption.
struct ShownMap {
  std::string label;
  PotentialMap map;
  std::vector<MarkedPoint> points;
};

/// Maps with one colour scale, from 0 to 1.
struct PotentialPanel {
  std::string title;
  std::vector<ShownMap> maps;
};

/// Several panels in one picture, from top to bottom.
struct PotentialFigure {
  std::string title;
  std::vector<PotentialPanel> panels;
};

/// The picture as the bytes of a file. Throws as Canvas::finish does.
std::string draw_potentials(const PotentialFigure& figure, PictureFormat format);

/// Writes potentials.png and potentials.svg into the folder, which is created if necessary. Throws
/// SystemFailure.
void write_potentials(const std::string& folder, const PotentialFigure& figure);

}  // namespace apothem
