#include "apps/reproduce/figure.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "apps/reproduce/sources.hpp"
#include "lib/output/axes.hpp"
#include "lib/output/history.hpp"

namespace apothem {
namespace {

// The contact on a body's pressed edges, from left to right: midpoint of each edge, and the
// pressure or traction on it. An edge beside the contact that only dips in with one end is left
// out.
std::vector<Vec2> profile(const CurveSource& source, const std::string& runs) {
  constexpr double kPressed = 1e-4;  // least pressure over the largest one
  const std::vector<SurfaceRecord> surfaces =
      read_surfaces(runs + "/" + source.scene, source.frame.from, source.frame.latest);
  double largest = 0;
  for (const SurfaceRecord& s : surfaces) {
    if (s.body == source.surface) largest = std::max(largest, s.pressure);
  }
  std::vector<Vec2> points;
  for (const SurfaceRecord& s : surfaces) {
    if (s.body != source.surface || !(s.pressure > kPressed * largest)) continue;
    const Vec2 middle = (s.from + s.to) / 2;
    points.emplace_back(source.x.shown(source.x.column == "x" ? middle.x() : middle.y()),
                        source.y.shown(source.y.column == "pressure" ? s.pressure : s.traction));
  }
  std::ranges::sort(points, [](const Vec2& a, const Vec2& b) { return a.x() < b.x(); });
  return points;
}

// The frame nearest to a time, s; the last one if the run has ended before.
Frame nearest_frame(const std::string& folder, double time) {
  const RunFolder run(folder);
  return run.frame(run.nearest(std::clamp(time, run.times().front(), run.times().back())));
}

void add_rows(const std::vector<TablePoint>& points, Curve& curve) {
  for (const TablePoint& p : points) {
    curve.x.push_back(p.x);
    curve.y.push_back(p.y);
    if (curve.style != CurveStyle::error_bars) continue;
    curve.low.push_back(p.low);
    curve.high.push_back(p.high);
  }
}

}  // namespace

const FieldSource* first_reference(const std::vector<FieldSource>& sources) {
  const auto found =
      std::ranges::find_if(sources, [](const FieldSource& s) { return !s.reference.empty(); });
  return found == sources.end() ? nullptr : &*found;
}

CellTable cells_of(const std::string& data, const FieldSource& source) {
  const HistoryTable table = read_history(data + "/reference/" + source.reference);
  return cell_table(table, source.column, source.cell);
}

CurveFigure Figure::drawn(const FigureFolders& folders) const {
  const std::string &data = folders.data, &runs = folders.runs;
  CurveFigure result = shown;
  for (size_t p = 0; p < sources.size(); ++p) {
    for (size_t c = 0; c < sources[p].size(); ++c) {
      const CurveSource& source = sources[p][c];
      Curve& curve = result.panels[p].curves[c];
      if (source.rows) {
        add_rows(points_of(*source.rows, data, folders.studies), curve);
        continue;
      }
      const bool profiled = source.surface >= 0;
      for (const Vec2& point : profiled ? profile(source, runs) : source.points) {
        curve.x.push_back(point.x());
        curve.y.push_back(point.y());
      }
      if (profiled || !source.points.empty()) continue;
      const HistoryTable table = source.scene.empty()
                                     ? read_history(data + "/reference/" + source.reference)
                                     : read_history_of(runs + "/" + source.scene, source.y.column);
      for (const double x : *table.column(source.x.column)) curve.x.push_back(source.x.shown(x));
      for (const double y : *table.column(source.y.column)) curve.y.push_back(source.y.shown(y));
    }
  }
  return result;
}

DrawnFields Figure::drawn_fields(const FigureFolders& folders) const {
  const std::string &data = folders.data, &runs = folders.runs;
  DrawnFields result{shown_fields, {}};
  for (size_t p = 0; p < field_sources.size(); ++p) {
    FieldPanel& panel = result.figure.panels[p];
    const FieldSource* reference = first_reference(field_sources[p]);
    for (size_t i = 0; i < panel.fields.size(); ++i) {
      const FieldSource& source = field_sources[p][i];
      ShownField& one = panel.fields[i];
      if (!source.reference.empty()) {
        one.field = field_of(cells_of(data, source));
        continue;
      }
      const Frame frame =
          source.study.empty()
              ? read_frame(runs + "/" + source.scene, source.frame.from, source.frame.latest)
              : nearest_frame(folders.studies + "/" + source.study, source.frame.from);
      one.field = field_of(frame, *panel.quantity);
      if (!source.statics) {
        if (!one.label.empty()) one.label += ", ";
        one.label += "t = " + time_in_words(frame.time);
      }
      if (!source.compared) continue;
      const FieldError error = field_error(frame, *panel.quantity, cells_of(data, *reference));
      const auto state = [&](const char* kind, double value, double tolerance) {
        result.numbers.push_back(
            {source.scene,
             fmt::format("{} at {}: {} error in cells, of the reference's "
                         "largest value",
                         panel.quantity->meaning, time_in_words(frame.time), kind),
             "1", 0, value, tolerance, value <= tolerance, Basis::code,
             "data/reference/" + reference->reference});
      };
      state("rms", error.rms, source.compared->rms);
      state("largest", error.largest, source.compared->largest);
    }
  }
  return result;
}

}  // namespace apothem
