// Writes a report as one HTML file with its pictures inside: figures, and numbers beside their
// references. It can be read without a network, on a telephone, and on paper.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lib/model/settings.hpp"

namespace apothem {

/// A number beside its reference.
struct ReportNumber {
  std::string scene;  ///< name of the scene
  std::string what;   ///< description of the number
  std::string unit;   ///< "1" if it has none
  double reference = 0, value = 0;
  double tolerance = 0;             ///< allowed absolute difference
  bool met = false;                 ///< whether the value is within the tolerance
  std::optional<Basis> basis = {};  ///< what the reference rests on, if it is stated
  std::string source = {};          ///< where the reference comes from; may be empty
};

/// Whether a figure of the paper comes out. `alike`: what is shown is of the same kind, but there
/// is no number to compare. `own`: the paper has no such figure.
enum class Verdict { reproduced, explained, alike, not_confirmed, own };
/// The verdicts by name, in the order of Verdict.
inline constexpr std::array<std::string_view, 5> kVerdicts{"reproduced", "explained", "alike",
                                                           "not_confirmed", "own"};

/// Something that the paper does not say, and what was done.
struct OpenQuestion {
  std::string question, choice;
};

/// What a figure says in words; all of it may be empty.
struct FigureText {
  std::string about;  ///< what is shown here
  std::string paper;  ///< what the paper shows
  std::vector<OpenQuestion> open;
  std::optional<Verdict> verdict = {};  ///< holds as long as no number is missed
  std::string because = {};             ///< why
};

/// A run that can be played in a browser.
struct ReportPlayer {
  std::string scene;
  std::string file;  ///< path of the page, relative to the report
};

/// A figure with its numbers.
struct ReportFigure {
  std::string name;  ///< also the anchor of its heading
  std::string title;
  FigureText text;
  std::vector<std::string> pictures;  ///< paths of PNG files
  std::vector<ReportPlayer> players;
  std::vector<std::string> commands;  ///< that have made its studies
  std::vector<std::string> links;     ///< paths of further files, relative to the report
  std::vector<std::string> faults;    ///< one sentence for each failure
  std::vector<ReportNumber> numbers;
};

/// What stands above the figures of a report.
struct ReportHead {
  std::string title;
  std::string about;     ///< HTML that stands below the title
  std::string made_by;   ///< names the program
  std::string left_out;  ///< HTML about figures that are not there, with the anchor left-out
};

/// Writes the report to `file`: a table with a line for each figure, then the figures, each with
/// its numbers in three groups: against the paper, against theory or an independent code, internal
/// checks. Throws SystemFailure.
void write_report(const std::string& file, const ReportHead& head,
                  const std::vector<ReportFigure>& figures);

}  // namespace apothem
