#include "apps/reproduce/comparison.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace apothem {
namespace {

// The curve at x by linear interpolation, NaN outside of it. Its points go on in x.
double value_at(const Curve& curve, double x) {
  const auto after = std::ranges::lower_bound(curve.x, x);
  if (after == curve.x.end() || (after == curve.x.begin() && *after > x)) return std::nan("");
  const auto i = static_cast<size_t>(after - curve.x.begin());
  if (i == 0) return curve.y[0];
  const double part = (x - curve.x[i - 1]) / (curve.x[i] - curve.x[i - 1]);
  return curve.y[i - 1] + part * (curve.y[i] - curve.y[i - 1]);
}

// Differences at the points of the reference that lie within the curve and within the panel, over
// the largest size of the reference there.
struct CurveDifference {
  double rms = 0, largest = 0;
};

CurveDifference difference(const Curve& curve, const Curve& reference,
                           const std::optional<Vec2>& range) {
  double squares = 0, largest = 0, size = 0;
  size_t count = 0;
  for (size_t i = 0; i < reference.x.size(); ++i) {
    if (range && !(reference.x[i] >= range->x() && reference.x[i] <= range->y())) continue;
    const double off = value_at(curve, reference.x[i]) - reference.y[i];
    if (std::isnan(off)) continue;
    ++count;
    squares += off * off;
    largest = std::max(largest, std::abs(off));
    size = std::max(size, std::abs(reference.y[i]));
  }
  if (count == 0 || !(size > 0)) {
    throw std::runtime_error(fmt::format("\"{}\" and its reference \"{}\" have no points in common",
                                         curve.label, reference.label));
  }
  return {std::sqrt(squares / static_cast<double>(count)) / size, largest / size};
}

std::string label_of(const CurvePanel& panel, const Curve& reference) {
  if (!reference.label.empty()) return reference.label;
  const auto labelled = std::ranges::find_if(
      panel.curves, [&](const Curve& c) { return c.style == reference.style && !c.label.empty(); });
  return labelled == panel.curves.end() ? "reference" : labelled->label;
}

}  // namespace

const Curve* reference_of(const CurvePanel& panel, const std::vector<CurveSource>& sources,
                          size_t c) {
  const Curve* first = nullptr;
  for (size_t i = 0; i < sources.size(); ++i) {
    if (sources[i].reference.empty()) continue;
    if (panel.curves[i].colour == panel.curves[c].colour) return &panel.curves[i];
    if (!first) first = &panel.curves[i];
  }
  return first;
}

std::vector<ReportNumber> curve_numbers(const Figure& figure, const CurveFigure& drawn) {
  std::vector<ReportNumber> numbers;
  for (size_t p = 0; p < figure.sources.size(); ++p) {
    const CurvePanel& panel = drawn.panels[p];
    for (size_t c = 0; c < figure.sources[p].size(); ++c) {
      const CurveSource& source = figure.sources[p][c];
      if (!source.compared) continue;
      const Curve& reference = *reference_of(panel, figure.sources[p], c);
      const CurveDifference off = difference(panel.curves[c], reference, panel.x_range);
      const std::string table =
          figure.sources[p][static_cast<size_t>(&reference - panel.curves.data())].reference;
      const auto state = [&](const char* kind, double value, double tolerance) {
        numbers.push_back(
            {source.scene,
             fmt::format("{}, {}: {} difference from \"{}\", of its largest value", panel.y_label,
                         panel.curves[c].label, kind, label_of(panel, reference)),
             "1", 0, value, tolerance, value <= tolerance, source.compared->basis,
             "data/reference/" + table});
      };
      state("rms", off.rms, source.compared->rms);
      state("largest", off.largest, source.compared->largest);
    }
  }
  return numbers;
}

}  // namespace apothem
