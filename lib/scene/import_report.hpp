// What an import has read of its drawing, and what it has not.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

namespace apothem {

struct ImportReport {
  std::string file;  ///< as the scene names it
  int bodies = 0;
  double scale = 1;                 ///< m per unit of the drawing
  std::string unit_source;          ///< what says so, in words
  std::map<std::string, int> read;  ///< how many of each kind of entity
  /// The same of what is left out, by the kind of entity and the reason.
  std::map<std::pair<std::string, std::string>, int> left_out;
  std::vector<std::string> faults;   ///< what was repaired or left out, each with its place
  std::vector<std::string> renamed;  ///< names that were replaced, and by what

  /// "2 LWPOLYLINE, 1 polygon"; empty if nothing is read.
  [[nodiscard]] std::string read_in_words() const;
  /// "3 TEXT (no outline)"; empty if nothing is left out.
  [[nodiscard]] std::string left_out_in_words() const;
};

}  // namespace apothem
