// Curves as files: a CSV each, and a picture of all of them through gnuplot.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "geometry/point.hpp"
#include "output/gnuplot.hpp"

namespace apothem {

enum class CurveStyle { line, dashed, marks };

struct Curve {
  std::string label;  ///< empty: not in the key
  CurveStyle style = CurveStyle::line;
  int colour = 0;  ///< any number; equal numbers, equal colours
  std::vector<double> x, y;
};

struct CurvePanel {
  std::string title;
  std::string x_label, y_label;  ///< with units: "time [s]"
  std::optional<Vec2> x_range, y_range;
  std::vector<Curve> curves;
};

struct CurveFigure {
  std::string title;
  std::vector<CurvePanel> panels;  ///< one below the other
};

/// Writes curve-PANEL-CURVE.csv (from 1; columns named by the panel's labels), picture.gnuplot and,
/// if gnuplot is there, picture.png and picture.svg into the folder, which it creates. Returns the
/// names of the CSV files in `files`. Throws SystemFailure.
Plotted write_curves(const std::string& folder, const CurveFigure& figure,
                     std::vector<std::string>& files);

}  // namespace apothem
