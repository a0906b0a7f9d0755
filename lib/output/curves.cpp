#include "lib/output/curves.hpp"

#include <fmt/compile.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "lib/output/files.hpp"
#include "lib/text/csv.hpp"

namespace apothem {
namespace {

// Colours that colour-blind readers can tell apart (Paul Tol's "bright" scheme).
constexpr std::array kColours{"#4477aa", "#ee6677", "#228833", "#ccbb44", "#66ccee", "#aa3377"};

constexpr int kWidth = 1000;         // pixels
constexpr size_t kMostInColumn = 6;  // panels; more stand in several columns
constexpr int kColumns = 3, kColumnWidth = 560;
constexpr int kPanelHeight = 330;   // of one of several panels, pixels
constexpr int kSingleHeight = 560;  // of a single panel, pixels

// The text as a gnuplot string. In single quotes, gnuplot takes everything literally except the
// quote and the end of a line. A doubled quote stands for one, but not at the start of the title of
// a curve (gnuplot 5.4), so that an apostrophe gets its typographic form.
std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) {
    if (c == '\'') {
      result += "\u2019";
    } else {
      result += static_cast<unsigned char>(c) < ' ' ? ' ' : c;
    }
  }
  return result + "'";
}

std::string table_with_bars(const CurvePanel& panel, const Curve& curve) {
  std::string text = csv_row({panel.x_label, panel.y_label, "low", "high"});
  for (size_t i = 0; i < curve.x.size(); ++i) {
    text += fmt::format("{},{},{},{}\n", curve.x[i], curve.y[i], curve.low[i], curve.high[i]);
  }
  return text;
}

std::string table(const CurvePanel& panel, const Curve& curve) {
  if (curve.style == CurveStyle::error_bars) return table_with_bars(panel, curve);
  std::string text = csv_row({panel.x_label, panel.y_label});
  for (size_t i = 0; i < curve.x.size(); ++i) {
    fmt::format_to(std::back_inserter(text), FMT_COMPILE("{},{}\n"), curve.x[i], curve.y[i]);
  }
  return text;
}

std::vector<std::string> labels(const CurvePanel& panel) {
  std::vector<std::string> list;
  for (const Curve& curve : panel.curves) list.push_back(curve.label);
  return list;
}

// The title of a panel and, below it, its key. Without a key the title stands where it would stand
// with one; gnuplot's own title would come between a key and its panel.
std::string title_and_key(const CurvePanel& panel, bool with_key) {
  if (with_key) {
    return fmt::format(
        "unset title\nunset label\n"
        "set key above left horizontal Left reverse samplen 2.5 width 2 title {} left\n",
        quoted(panel.title));
  }
  return fmt::format("unset key\nset title ' '\nset label 1 {} at graph 0, graph 1 offset 1, 1\n",
                     quoted(panel.title));
}

std::string range(const std::optional<Vec2>& limits) {
  return limits ? fmt::format("[{}:{}]", limits->x(), limits->y()) : "[*:*]";
}

std::string style(const Curve& curve) {
  const auto index = static_cast<size_t>(curve.colour) % kColours.size();
  const std::string colour = fmt::format("lc rgb '{}'", kColours[index]);
  switch (curve.style) {
    case CurveStyle::line:
      return "with lines lw 1.8 " + colour;
    case CurveStyle::dashed:
      return "with lines lw 1.8 dt (9,6) " + colour;
    case CurveStyle::error_bars: {
      // Where the colours are used up, the points differ.
      constexpr std::array kPoints{7, 5, 9, 13, 11};
      const size_t point = static_cast<size_t>(curve.colour) / kColours.size() % kPoints.size();
      return fmt::format("with yerrorlines pt {} ps 0.9 lw 1.5 {}", kPoints[point], colour);
    }
    case CurveStyle::marks:
      break;
  }
  return "with points pt 6 ps 1.2 lw 1.5 " + colour;
}

bool has_bars(const CurvePanel& panel) {
  return std::ranges::any_of(
      panel.curves, [](const Curve& curve) { return curve.style == CurveStyle::error_bars; });
}

// Names at the places 1, 2, ... of the x axis, or its numbers. Names that do not fit beside each
// other are turned.
std::string x_tics(const CurvePanel& panel) {
  constexpr size_t kFit = 110;  // characters
  std::string names;
  size_t characters = 0;
  for (size_t i = 0; i < panel.x_names.size(); ++i) {
    names += fmt::format("{}{} {}", i == 0 ? "" : ", ", quoted(panel.x_names[i]), i + 1);
    characters += panel.x_names[i].size() + 2;
  }
  if (names.empty()) return "set xtics autofreq\n";
  return fmt::format("set xtics {}({})\n", characters > kFit ? "rotate by 50 right " : "", names);
}

// Numbers along y with as many digits as tell them apart.
std::string y_format(const CurvePanel& panel) {
  constexpr int kUsual = 6, kMost = 15;
  double least = HUGE_VAL, most = -HUGE_VAL;
  for (const Curve& curve : panel.curves) {
    for (const double y : curve.y) {
      if (std::isfinite(y)) least = std::min(least, y), most = std::max(most, y);
    }
  }
  int digits = kUsual;
  if (most > least) {
    const double ratio = std::max(std::abs(least), std::abs(most)) / (most - least);
    digits = std::clamp(static_cast<int>(std::ceil(std::log10(ratio))) + 3, kUsual, kMost);
  }
  if (digits > kUsual) return fmt::format("set format y '%.{}g'\n", digits);
  return has_bars(panel) ? "set format y '%g'\n" : "set format y\n";
}

// Bars at the ends of the axes need room; logarithmic axes go on to the next power of ten.
std::string offsets(const CurvePanel& panel) {
  if (!has_bars(panel)) return "unset offsets\n";
  const double x = panel.x_logarithmic ? 0 : .04, y = panel.y_logarithmic ? 0 : .04;
  return fmt::format("set offsets graph {0}, graph {0}, graph {1}, graph {1}\n", x, y);
}

std::string log_scales(const CurvePanel& panel) {
  if (!panel.x_logarithmic && !panel.y_logarithmic) return "";
  return fmt::format("set logscale {}{}\n", panel.x_logarithmic ? "x" : "",
                     panel.y_logarithmic ? "y" : "");
}

std::string plot_script(const CurveFigure& figure,
                        const std::vector<std::vector<std::string>>& files) {
  const size_t panels = figure.panels.size();
  const int columns = panels > kMostInColumn ? kColumns : 1;
  const int rows = (static_cast<int>(panels) + columns - 1) / columns;
  const int width = columns > 1 ? columns * kColumnWidth : kWidth;
  const int height = panels == 1 ? kSingleHeight : kPanelHeight * rows + 60;
  std::string script = fmt::format(R"gp(# gnuplot -e "output='picture.svg'" picture.gnuplot
if (!exists("output")) output = 'picture.png'
if (strstrt(output, '.svg') > 0) {{
  set terminal svg size {0},{1} font 'DejaVu Sans,14' background 'white' noenhanced
}} else {{
  set terminal pngcairo size {0},{1} font 'DejaVu Sans,11' background 'white' noenhanced
}}
set output output
set datafile separator ','
set grid lc rgb '#cccccc' lt 1 lw .5
set border 3
set tics nomirror
set lmargin 13
set rmargin 4
set multiplot layout {2},{3} title {4}."\n " font ',14'
)gp",
                                   width, height, rows, columns, quoted(figure.title));
  for (size_t p = 0; p < panels; ++p) {
    const CurvePanel& panel = figure.panels[p];
    // The key of a panel is left out if it would repeat the one above.
    const bool repeats = p > 0 && labels(panel) == labels(figure.panels[p - 1]);
    script += title_and_key(panel, !repeats);
    script +=
        fmt::format("set xlabel {}\nset ylabel {}\n", quoted(panel.x_label), quoted(panel.y_label));
    script += x_tics(panel) + log_scales(panel);
    script += panel.x_logarithmic ? "set format x '%g'\n" : "set format x\n";
    script += offsets(panel);
    script += y_format(panel);
    script += fmt::format("plot {} {}", range(panel.x_range), range(panel.y_range));
    for (size_t c = 0; c < panel.curves.size(); ++c) {
      const Curve& curve = panel.curves[c];
      script += fmt::format("{}{} every ::1 using {} {} {}", c == 0 ? " " : ", \\\n  ",
                            quoted(files[p][c]),
                            curve.style == CurveStyle::error_bars ? "1:2:3:4" : "1:2", style(curve),
                            curve.label.empty() ? "notitle" : "title " + quoted(curve.label));
    }
    script += log_scales(panel).empty() ? "\n" : "\nunset logscale\n";
  }
  return script + "unset multiplot\n";
}

}  // namespace

Plotted write_curves(const std::string& folder, const CurveFigure& figure,
                     std::vector<std::string>& files) {
  create_folder(folder);
  files.clear();
  std::vector<std::vector<std::string>> names;  // of the curves of each panel
  for (size_t p = 0; p < figure.panels.size(); ++p) {
    std::vector<std::string>& of_panel = names.emplace_back();
    for (const Curve& curve : figure.panels[p].curves) {
      of_panel.push_back(fmt::format("curve-{}-{}.csv", p + 1, of_panel.size() + 1));
      write_file(folder + "/" + of_panel.back(), table(figure.panels[p], curve));
      files.push_back(of_panel.back());
    }
  }
  write_file(folder + "/picture.gnuplot", plot_script(figure, names));
  Plotted plotted = Plotted::yes;
  for (const char* picture : {"picture.png", "picture.svg"}) {
    if (plotted == Plotted::yes) {
      plotted = plot_with_gnuplot(folder, "picture.gnuplot", picture);
    }
  }
  return plotted;
}

}  // namespace apothem
