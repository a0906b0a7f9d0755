#include "apothem/output/report.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <fstream>
#include <iterator>

#include "apothem/output/files.hpp"
#include "apothem/output/html.hpp"

namespace apothem {
namespace {

constexpr const char* kHead = R"(<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{0}</title>
<style>
body {{ font: 16px/1.5 sans-serif; max-width: 1200px; margin: 2em auto; padding: 0 1em; color: #222; }}
img {{ max-width: 100%; }}
h3 {{ font-size: 1em; margin-bottom: .3em; }}
table {{ border-collapse: collapse; font-size: 14px; }}
th, td {{ padding: .2em .6em; text-align: left; vertical-align: top; border-bottom: 1px solid #ddd; }}
td {{ overflow-wrap: anywhere; }}
td.number {{ text-align: right; font-variant-numeric: tabular-nums; }}
td.number, td.verdict {{ white-space: nowrap; }}
tr.missed, p.fault {{ background: #fde2dd; font-weight: bold; }}
/* On a narrow screen every row is a list of its cells, each behind the head of its column. */
@media (max-width: 800px) {{
  table, tbody, tr, td {{ display: block; }}
  tr:first-child {{ display: none; }}
  tr {{ border: 1px solid #ccc; margin-bottom: .8em; padding: .3em; }}
  td, td.number {{ text-align: left; border: 0; padding: .1em 0 .1em 7em; position: relative; }}
  td::before {{ content: attr(data-head); position: absolute; left: 0; color: #666; font-weight: normal; }}
}}
</style>
</head>
<body>
<h1>{0}</h1>
{1}
<p>{2}: {3} figures, {4} numbers, {5} missed.</p>
)";

// What a table of numbers of one basis is called. The order is that of the tables.
struct BasisText {
  std::optional<Basis> basis;
  const char* heading;
  const char* counted;
};
constexpr std::array kBasisTexts{
    BasisText{Basis::theory, "Beside theory", "beside a closed form"},
    BasisText{Basis::code, "Beside an independent code", "beside an independent code"},
    BasisText{Basis::law, "Laws that every run obeys",
              "about laws that every run obeys (conservation, balance of forces, symmetry), whose "
              "reference is zero, the load or the value at the start"},
    BasisText{Basis::this_program, "Results of this program, kept to notice changes",
              "results of this program, kept to notice changes"},
    BasisText{std::nullopt, "Without a stated source", "without a stated source"}};

std::string picture(const std::string& file, const std::string& title) {
  std::ifstream stream(file, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
  return fmt::format("<p><img src=\"data:image/png;base64,{}\" alt=\"{}\"></p>\n", base64(bytes),
                     escaped(title));
}

std::string cell(const char* head, const std::string& text, const char* kind = "number") {
  return fmt::format("<td class=\"{}\" data-head=\"{}\">{}</td>", kind, head, escaped(text));
}

std::string row(const ReportNumber& n) {
  const double error = n.value - n.reference;
  const std::string cells =
      cell("scene", n.scene, "text") + cell("quantity", n.what, "text") +
      cell("unit", n.unit, "text") + cell("reference", fmt::format("{:.10g}", n.reference)) +
      cell("result", fmt::format("{:.10g}", n.value)) +
      cell("error", fmt::format("{:.1e}", error)) +
      cell("relative",
           n.reference != 0 ? fmt::format("{:.1e}", error / std::abs(n.reference)) : "-") +
      cell("tolerance", fmt::format("{:.1e}", n.tolerance)) +
      cell("verdict", n.met ? "ok" : "MISSED", "verdict") + cell("source", n.source, "text");
  return fmt::format("<tr{}>{}</tr>\n", n.met ? "" : " class=\"missed\"", cells);
}

std::string tables(const ReportFigure& figure) {
  std::string text;
  for (const BasisText& kind : kBasisTexts) {
    std::string rows;
    for (const ReportNumber& n : figure.numbers) {
      if (n.basis == kind.basis) rows += row(n);
    }
    if (rows.empty()) continue;
    text += fmt::format(
        "<h3>{}</h3>\n<table>\n<tr><th>scene</th><th>quantity</th><th>unit</th>"
        "<th>reference</th><th>result</th><th>error</th><th>relative</th><th>tolerance</th>"
        "<th></th><th>source</th></tr>\n{}</table>\n",
        kind.heading, rows);
  }
  return text;
}

// How many numbers rest on what.
std::string counts(const std::vector<ReportFigure>& figures) {
  std::string list;
  for (const BasisText& kind : kBasisTexts) {
    size_t count = 0;
    for (const ReportFigure& figure : figures) {
      for (const ReportNumber& n : figure.numbers) count += n.basis == kind.basis;
    }
    if (count > 0) list += fmt::format("<li>{} {}</li>\n", count, kind.counted);
  }
  return list.empty() ? "" : "<ul>\n" + list + "</ul>\n";
}

std::string section(const ReportFigure& figure) {
  std::string text =
      fmt::format("<h2 id=\"{}\">{}</h2>\n", escaped(figure.name), escaped(figure.title));
  if (!figure.about.empty()) text += fmt::format("<p>{}</p>\n", escaped(figure.about));
  for (const std::string& fault : figure.faults) {
    text += fmt::format("<p class=\"fault\">{}</p>\n", escaped(fault));
  }
  for (const std::string& file : figure.pictures) text += picture(file, figure.title);
  text += tables(figure) + "<p>Files:";
  for (const std::string& link : figure.links) {
    text += fmt::format(" <a href=\"{0}\">{0}</a>", escaped(link));
  }
  return text + "</p>\n";
}

}  // namespace

void write_report(const std::string& file, const ReportHead& head,
                  const std::vector<ReportFigure>& figures) {
  size_t numbers = 0, missed = 0;
  std::string contents, sections;
  for (const ReportFigure& figure : figures) {
    for (const ReportNumber& n : figure.numbers) missed += !n.met;
    numbers += figure.numbers.size();
    contents += fmt::format("<li><a href=\"#{}\">{}</a></li>\n", escaped(figure.name),
                            escaped(figure.title));
    sections += section(figure);
  }
  write_file(file, fmt::format(kHead, escaped(head.title), head.about, escaped(head.made_by),
                               figures.size(), numbers, missed) +
                       counts(figures) + "<h2>Figures</h2>\n<ul>\n" + contents + "</ul>\n" +
                       sections + head.left_out + "</body>\n</html>\n");
}

}  // namespace apothem
