// Tables of text as CSV (RFC 4180): cells that hold commas, quotes or line breaks stand in quotes.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace apothem {

/// One line of a CSV file, or several where a quoted cell goes on.
struct CsvRow {
  int line = 0;  ///< at which it begins, counted from 1
  std::vector<std::string> cells;
};

/// The rows of a file; lines without text are left out, and so are blanks around cells without
/// quotes. Throws SceneError.
std::vector<CsvRow> read_csv(const std::string& file);

/// The cells of the line `number` of a file, likewise.
std::vector<std::string> csv_cells(std::string_view line, const std::string& file, int number);

/// A cell as it stands in a file.
std::string csv_cell(const std::string& text);

/// A row with its line break.
std::string csv_row(const std::vector<std::string>& cells);

}  // namespace apothem
