#include "apothem/output/report.hpp"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <iterator>

#include "apothem/output/files.hpp"

namespace apothem {
namespace {

constexpr const char* kHead = R"(<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{0}</title>
<style>
body {{ font: 16px/1.5 sans-serif; max-width: 1040px; margin: 2em auto; padding: 0 1em; color: #222; }}
img {{ max-width: 100%; }}
table {{ border-collapse: collapse; font-size: 14px; }}
th, td {{ padding: .2em .8em; text-align: left; border-bottom: 1px solid #ddd; }}
td.number {{ text-align: right; font-variant-numeric: tabular-nums; }}
tr.missed, p.fault {{ background: #fde2dd; font-weight: bold; }}
</style>
</head>
<body>
<h1>{0}</h1>
<p>{1}: {2} figures, {3} numbers, {4} missed.</p>
)";

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += c;
    }
  }
  return result;
}

std::string base64(const std::string& bytes) {
  constexpr const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (size_t i = 0; i < bytes.size(); i += 3) {
    unsigned block = 0;
    for (size_t k = i; k < i + 3; ++k) {
      block = block << 8U | (k < bytes.size() ? static_cast<unsigned char>(bytes[k]) : 0U);
    }
    for (size_t k = 0; k < 4; ++k) {
      text += i + k > bytes.size() ? '=' : digits[block >> (18 - 6 * k) & 63U];
    }
  }
  return text;
}

std::string picture(const std::string& file, const std::string& title) {
  std::ifstream stream(file, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
  return fmt::format("<p><img src=\"data:image/png;base64,{}\" alt=\"{}\"></p>\n", base64(bytes),
                     escaped(title));
}

std::string row(const ReportNumber& n) {
  const double error = n.value - n.reference;
  std::string cells = fmt::format("<td>{}</td><td>{}</td>", escaped(n.scene), escaped(n.what));
  for (const std::string& number :
       {fmt::format("{:.10g}", n.reference), fmt::format("{:.10g}", n.value),
        fmt::format("{:.1e}", error),
        n.reference != 0 ? fmt::format("{:.1e}", error / std::abs(n.reference)) : "",
        fmt::format("{:.1e}", n.tolerance)}) {
    cells += fmt::format("<td class=\"number\">{}</td>", number);
  }
  return fmt::format("<tr{}>{}<td>{}</td></tr>\n", n.met ? "" : " class=\"missed\"", cells,
                     n.met ? "ok" : "MISSED");
}

std::string section(const ReportFigure& figure) {
  std::string text =
      fmt::format("<h2 id=\"{}\">{}</h2>\n", escaped(figure.name), escaped(figure.title));
  if (!figure.about.empty()) text += fmt::format("<p>{}</p>\n", escaped(figure.about));
  for (const std::string& fault : figure.faults) {
    text += fmt::format("<p class=\"fault\">{}</p>\n", escaped(fault));
  }
  for (const std::string& file : figure.pictures) text += picture(file, figure.title);
  if (!figure.numbers.empty()) {
    text +=
        "<table>\n<tr><th>scene</th><th>quantity</th><th>reference</th><th>result</th>"
        "<th>error</th><th>relative</th><th>tolerance</th><th></th></tr>\n";
    for (const ReportNumber& n : figure.numbers) text += row(n);
    text += "</table>\n";
  }
  text += "<p>Files:";
  for (const std::string& link : figure.links) {
    text += fmt::format(" <a href=\"{0}\">{0}</a>", escaped(link));
  }
  return text + "</p>\n";
}

}  // namespace

void write_report(const std::string& file, const std::string& title, const std::string& made_by,
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
  write_file(file,
             fmt::format(kHead, escaped(title), escaped(made_by), figures.size(), numbers, missed) +
                 "<ul>\n" + contents + "</ul>\n" + sections + "</body>\n</html>\n");
}

}  // namespace apothem
