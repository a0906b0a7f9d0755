// Private header: how far curves of runs are from the reference curves beside them.
#pragma once

#include <vector>

#include "apps/reproduce/figure.hpp"

namespace apothem {

/// The differences of all curves that are to be compared, as numbers. `drawn`: the figure's curves
/// with their points. Throws std::runtime_error if a curve has no point in common with its
/// reference.
std::vector<ReportNumber> curve_numbers(const Figure& figure, const CurveFigure& drawn);

/// The curve of the panel with which curve `c` is compared: of those from a table, the first of
/// its colour, or else the first; null if there is none.
const Curve* reference_of(const CurvePanel& panel, const std::vector<CurveSource>& sources,
                          size_t c);

}  // namespace apothem
