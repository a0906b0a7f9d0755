// One HTML file that shows figures and numbers beside their references, pictures and all: it opens
// from disk, with no network.
#pragma once

#include <string>
#include <vector>

namespace apothem {

struct ReportNumber {
  std::string scene;
  std::string what;
  double reference = 0, value = 0;
  double tolerance = 0;  ///< absolute
  bool met = false;
};

struct ReportFigure {
  std::string name;  ///< of its heading's anchor
  std::string title;
  std::string about;                  ///< may be empty
  std::vector<std::string> pictures;  ///< PNG files
  std::vector<std::string> links;     ///< files, relative to the report
  std::vector<std::string> faults;    ///< what went wrong, a sentence each
  std::vector<ReportNumber> numbers;
};

/// Throws SystemFailure.
void write_report(const std::string& file, const std::string& title, const std::string& made_by,
                  const std::vector<ReportFigure>& figures);

}  // namespace apothem
