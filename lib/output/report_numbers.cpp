#include "lib/output/report_numbers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "lib/output/html.hpp"
#include "lib/text/words.hpp"

namespace apothem {
namespace {

// What a reference rests on, in which group it belongs, and how it is called there.
struct BasisText {
  std::optional<Basis> basis;
  size_t group;
  const char* words;
};
constexpr std::array kBasisTexts{
    BasisText{Basis::paper, 0, "the paper"},
    BasisText{Basis::theory, 1, "closed form"},
    BasisText{Basis::code, 1, "independent code"},
    BasisText{Basis::law, 2, "law that every run obeys"},
    BasisText{Basis::this_program, 2, "this program, to notice changes"},
    BasisText{std::nullopt, 2, "not stated"}};

struct GroupText {
  const char* heading;
  const char* column;  // of the summary
};
constexpr std::array kGroups{GroupText{"Against the paper", "paper"},
                             GroupText{"Against theory or an independent code", "theory or code"},
                             GroupText{"Internal checks", "internal checks"}};

const BasisText& text_of(const ReportNumber& number) {
  return *std::ranges::find_if(kBasisTexts,
                               [&](const BasisText& t) { return t.basis == number.basis; });
}

std::string two_digits(double x) { return x == 0 ? "0" : fmt::format("{:.1e}", x); }

// m^2 as it is printed.
std::string unit_in_print(const std::string& unit) {
  return replaced(replaced(unit, "^2", "²"), "^3", "³");
}

std::string row(const ReportNumber& n, bool with_scene) {
  const double error = n.value - n.reference;
  const std::string cells =
      (with_scene ? table_cell("scene", n.scene, "text") : "") +
      table_cell("quantity", n.what, "text") + table_cell("unit", unit_in_print(n.unit), "text") +
      table_cell("reference", fmt::format("{:.10g}", n.reference)) +
      table_cell("result", fmt::format("{:.10g}", n.value == 0 ? 0.0 : n.value)) +
      table_cell("error", two_digits(error)) +
      table_cell("relative", n.reference != 0 ? two_digits(error / std::abs(n.reference)) : "-") +
      table_cell("tolerance", two_digits(n.tolerance)) +
      table_cell("verdict", n.met ? "ok" : "MISSED", "verdict") +
      table_cell("rests on", text_of(n).words, "text") + table_cell("source", n.source, "text");
  return fmt::format("<tr{}>{}</tr>\n", n.met ? "" : " class=\"missed\"", cells);
}

}  // namespace

std::vector<GroupCount> count_groups(const std::vector<ReportNumber>& numbers) {
  std::vector<GroupCount> counts;
  counts.reserve(kGroups.size());
  for (const GroupText& group : kGroups) counts.push_back({group.column});
  for (const ReportNumber& n : numbers) {
    GroupCount& count = counts[text_of(n).group];
    ++count.numbers;
    count.met += n.met;
  }
  return counts;
}

std::string table_cell(const char* head, const std::string& text, const char* kind) {
  // Lines may also break within paths, which are long words.
  constexpr size_t kLong = 20;
  const std::string plain = escaped(text);
  std::string shown;
  for (size_t begin = 0, end = 0; begin < plain.size(); begin = end + 1) {
    end = std::min(plain.find(' ', begin), plain.size());
    for (size_t i = begin; i < end; ++i) {
      shown += plain[i];
      if (end - begin > kLong && (plain[i] == '/' || plain[i] == '_')) shown += "<wbr>";
    }
    if (end < plain.size()) shown += ' ';
  }
  return fmt::format("<td class=\"{}{}\" data-head=\"{}\">{}</td>", kind,
                     text.empty() || text == "-" ? " none" : "", head, shown);
}

std::string number_tables(const std::vector<ReportNumber>& numbers) {
  std::string text;
  for (size_t group = 0; group < kGroups.size(); ++group) {
    const auto is_here = [&](const ReportNumber& n) { return text_of(n).group == group; };
    const bool with_scenes = std::ranges::any_of(
        numbers, [&](const ReportNumber& n) { return is_here(n) && !n.scene.empty(); });
    std::string rows;
    const GroupCount count = count_groups(numbers)[group];
    for (const ReportNumber& n : numbers) {
      if (is_here(n)) rows += row(n, with_scenes);
    }
    if (rows.empty()) continue;
    const bool missed = count.met < count.numbers;
    text += fmt::format(
        "<details{}><summary><h3>{}</h3> {} of {} within their tolerances</summary>\n<div "
        "class=\"numbers\"><table>\n<thead><tr>{}<th>quantity</th><th>unit</th>"
        "<th class=\"number\">reference</th><th class=\"number\">result</th>"
        "<th class=\"number\">error</th><th class=\"number\">relative</th>"
        "<th class=\"number\">tolerance</th>"
        "<th>verdict</th><th>rests "
        "on</th><th>source</th></tr></thead>\n{}</table></div>\n</details>\n",
        missed ? " open" : "", kGroups[group].heading, count.met, count.numbers,
        with_scenes ? "<th>scene</th>" : "", rows);
  }
  return text;
}

}  // namespace apothem
