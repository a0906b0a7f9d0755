// Writes a report as one HTML file with its pictures inside: figures, and numbers beside their
// references. It can be read without a network.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apothem/model/settings.hpp"

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

/// What stands above the figures of a report.
struct ReportHead {
  std::string title;
  std::string about;     ///< HTML that stands below the title
  std::string made_by;   ///< names the program
  std::string left_out;  ///< HTML about figures that are not in the report; may be empty
};

/// Writes the report to `file`. The numbers of a figure stand in one table for each basis. Throws
/// SystemFailure.
void write_report(const std::string& file, const ReportHead& head,
                  const std::vector<ReportFigure>& figures);

}  // namespace apothem
