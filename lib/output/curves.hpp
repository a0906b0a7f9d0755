// Writes curves: each as a CSV file, and all of them as a picture made with gnuplot.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "geometry/polygon/point.hpp"
#include "lib/output/gnuplot.hpp"

namespace apothem {

/// How a curve is drawn.
enum class CurveStyle { line, dashed, marks, error_bars };

/// A curve of a panel.
struct Curve {
  std::string label;  ///< entry in the key; empty: none
  CurveStyle style = CurveStyle::line;
  int colour = 0;            ///< any number; curves with equal numbers have the same colour
  std::vector<double> x, y;  ///< points, in the units of the panel's axes
  std::vector<double> low = {}, high = {};  ///< ends of the bars in y; only with error_bars
};

/// A diagram with its curves.
struct CurvePanel {
  std::string title;
  std::string x_label, y_label;  ///< with units, as in "time [s]"
  /// Lowest and highest value of the axis; empty: chosen by gnuplot.
  std::optional<Vec2> x_range, y_range;
  std::vector<std::string> x_names = {};  ///< in place of the numbers 1, 2, ... on the x axis
  bool x_logarithmic = false, y_logarithmic = false;
  std::vector<Curve> curves;
};

/// Several diagrams in one picture.
struct CurveFigure {
  std::string title;
  std::vector<CurvePanel> panels;  ///< from top to bottom
};

/// Writes curve-PANEL-CURVE.csv (numbered from 1; columns named by the panel's axis labels, and
/// low, high), picture.gnuplot and, if gnuplot is installed, picture.png and picture.svg into the
/// folder, which is created if necessary. Returns whether gnuplot made the pictures, and the names
/// of the CSV files in `files`. Throws SystemFailure.
Plotted write_curves(const std::string& folder, const CurveFigure& figure,
                     std::vector<std::string>& files);

}  // namespace apothem
