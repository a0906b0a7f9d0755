#include "lib/output/report.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "lib/output/files.hpp"
#include "lib/output/html.hpp"
#include "lib/output/report_numbers.hpp"
#include "lib/output/report_style.hpp"
#include "lib/text/file.hpp"

namespace apothem {
namespace {

constexpr const char* kHead = R"(<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{0}</title>
<style>{1}</style>
<script>
// Paper has no parts that unfold.
addEventListener("beforeprint", () => {{ for (const part of document.querySelectorAll("details")) part.open = true; }});
</script>
</head>
<body>
<h1 id="top">{0}</h1>
{2}
<p>{3}: {4} figures, {5} numbers, {6} missed.</p>
)";

struct VerdictText {
  const char* words;
  const char* style;
};
constexpr std::array kVerdictTexts{
    VerdictText{"reproduced", "reproduced"},
    VerdictText{"reproduced with an explained difference", "explained"},
    VerdictText{"of the same kind, without a number to compare", "alike"},
    VerdictText{"not confirmed", "not_confirmed"}, VerdictText{"not in the paper", "own"}};

size_t missed(const ReportFigure& figure) {
  return static_cast<size_t>(
      std::ranges::count_if(figure.numbers, [](const ReportNumber& n) { return !n.met; }));
}

// The verdict of this run: what a figure says of itself does not hold where numbers are missed.
std::string badge(const ReportFigure& figure) {
  if (const size_t count = missed(figure); count > 0) {
    return fmt::format(
        "<span class=\"badge missing\">not reproduced by this run: {} of {} numbers "
        "missed</span>",
        count, figure.numbers.size());
  }
  if (!figure.faults.empty()) {
    return "<span class=\"badge missing\">not reproduced by this run: incomplete</span>";
  }
  if (!figure.text.verdict) return "";
  const VerdictText& text = kVerdictTexts[static_cast<size_t>(*figure.text.verdict)];
  return fmt::format("<span class=\"badge {}\">{}</span>", text.style, text.words);
}

std::string summary(const std::vector<ReportFigure>& figures, bool left_out) {
  std::string rows;
  std::string heads = "<th>figure</th><th>verdict</th>";
  for (const GroupCount& group : count_groups({})) {
    heads += "<th class=\"number\">" + group.name + "</th>";
  }
  for (const ReportFigure& figure : figures) {
    std::string cells = fmt::format(
        "<td class=\"text\" data-head=\"figure\"><a href=\"#{}\">{}</a></td>"
        "<td class=\"text\" data-head=\"verdict\">{}</td>",
        escaped(figure.name), escaped(figure.title), badge(figure));
    for (const GroupCount& group : count_groups(figure.numbers)) {
      cells +=
          table_cell(group.name.c_str(),
                     group.numbers == 0 ? "-" : fmt::format("{} of {}", group.met, group.numbers));
    }
    rows += fmt::format("<tr{}>{}</tr>\n", missed(figure) > 0 ? " class=\"missed\"" : "", cells);
  }
  return fmt::format(
      "<h2 id=\"figures\">Figures</h2>\n<p>Numbers within their tolerance, of all that are stated: "
      "against the paper, against theory or an independent code, and internal checks (balances, "
      "symmetry, energy, and results of this program that are kept to notice changes).</p>\n"
      "<table>\n<thead><tr>{}</tr></thead>\n{}</table>\n{}",
      heads, rows,
      left_out ? "<p><a href=\"#left-out\">Figures of the paper that are not here</a></p>\n" : "");
}

std::string picture(const std::string& file, const std::string& title) {
  return fmt::format(
      "<div class=\"picture\"><img src=\"data:image/png;base64,{}\" alt=\"{}\"></div>\n",
      base64(read_bytes(file)), escaped(title));
}

std::string paragraph(const char* heading, const std::string& text) {
  return text.empty() ? "" : fmt::format("<h3>{}</h3>\n<p>{}</p>\n", heading, escaped(text));
}

std::string words(const ReportFigure& figure) {
  const FigureText& text = figure.text;
  std::string html = paragraph("What the paper shows", text.paper);
  if (!text.open.empty()) {
    html += "<details><summary><h3>What it leaves open, and the choice made</h3></summary>\n<dl>\n";
    for (const OpenQuestion& open : text.open) {
      html += fmt::format("<div><dt>{}</dt><dd>{}</dd></div>\n", escaped(open.question),
                          escaped(open.choice));
    }
    html += "</dl>\n</details>\n";
  }
  return html + paragraph("What is shown here", text.about);
}

std::string players(const ReportFigure& figure) {
  if (figure.players.empty()) return "";
  std::string list;
  for (const ReportPlayer& player : figure.players) {
    list += fmt::format("{}<a href=\"{}\">{}</a>", list.empty() ? "" : ", ", escaped(player.file),
                        escaped(player.scene));
  }
  return fmt::format("<p class=\"players\">Play the run in the browser: {}</p>\n", list);
}

std::string commands(const ReportFigure& figure) {
  if (figure.commands.empty()) return "";
  std::string lines;
  for (const std::string& command : figure.commands) lines += escaped(command) + "\n";
  return "<details><summary><h3>Commands that made the studies</h3></summary>\n<p>In the folder of "
         "this page, to which the folder of the program's data has been copied:</p>\n<pre>" +
         lines + "</pre>\n</details>\n";
}

std::string section(const ReportFigure& figure) {
  std::string text =
      fmt::format("<h2 id=\"{}\">{}</h2>\n<p>{} {}</p>\n", escaped(figure.name),
                  escaped(figure.title), badge(figure), escaped(figure.text.because));
  for (const std::string& fault : figure.faults) {
    text += fmt::format("<p class=\"fault\">{}</p>\n", escaped(fault));
  }
  text += words(figure);
  for (const std::string& file : figure.pictures) text += picture(file, figure.title);
  text += players(figure) + commands(figure) + number_tables(figure.numbers) + "<p>Files:";
  for (const std::string& link : figure.links) {
    text += fmt::format(" <a href=\"{0}\">{0}</a>", escaped(link));
  }
  return text + "</p>\n<p class=\"top\"><a href=\"#top\">To the summary</a></p>\n";
}

}  // namespace

void write_report(const std::string& file, const ReportHead& head,
                  const std::vector<ReportFigure>& figures) {
  size_t numbers = 0, missing = 0;
  std::string sections;
  for (const ReportFigure& figure : figures) {
    missing += missed(figure);
    numbers += figure.numbers.size();
    sections += section(figure);
  }
  write_file(file, fmt::format(kHead, escaped(head.title), kReportStyle, head.about,
                               escaped(head.made_by), figures.size(), numbers, missing) +
                       summary(figures, !head.left_out.empty()) + sections + head.left_out +
                       "</body>\n</html>\n");
}

}  // namespace apothem
