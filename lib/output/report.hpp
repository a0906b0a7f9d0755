// Writes a report as one HTML file with its pictures inside: figures, and numbers beside their
// references. It can be read without a network.
#pragma once

#include <string>
#include <vector>

namespace apothem {

/// A number beside its reference.
struct ReportNumber {
  std::string scene;  ///< name of the scene
  std::string what;   ///< description of the number
  double reference = 0, value = 0;
  double tolerance = 0;  ///< allowed absolute difference
  bool met = false;      ///< whether the value is within the tolerance
};

/// A figure with its numbers.
struct ReportFigure {
  std::string name;  ///< also the anchor of its heading
  std::string title;
  std::string about;                  ///< description; may be empty
  std::vector<std::string> pictures;  ///< paths of PNG files
  std::vector<std::string> links;     ///< paths of further files, relative to the report
  std::vector<std::string> faults;    ///< one sentence for each failure
  std::vector<ReportNumber> numbers;
};

/// Writes the report to `file`; `made_by` names the program. Throws SystemFailure.
void write_report(const std::string& file, const std::string& title, const std::string& made_by,
                  const std::vector<ReportFigure>& figures);

}  // namespace apothem
