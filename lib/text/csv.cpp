#include "lib/text/csv.hpp"

#include <algorithm>

#include "lib/text/error.hpp"
#include "lib/text/file.hpp"
#include "lib/text/words.hpp"

namespace apothem {
namespace {

class CsvParser {
 public:
  CsvParser(std::string_view text, const std::string& file, int line)
      : text_(text), file_(file), line_(line) {}

  [[nodiscard]] bool at_end() const { return at_ == text_.size(); }

  CsvRow read_row() {
    CsvRow row{line_, {}};
    while (true) {
      row.cells.push_back(read_cell());
      const bool more = at_ < text_.size() && text_[at_] == ',';
      if (at_ < text_.size()) ++at_;
      if (!more) break;
    }
    ++line_;
    return row;
  }

 private:
  // Stops at a comma, at the end of a line or at the end of the file.
  std::string read_cell() {
    const size_t start = text_.find_first_not_of(" \t", at_);
    if (start != std::string::npos && text_[start] == '"') {
      at_ = start + 1;
      return read_quoted();
    }
    const size_t end = std::min(text_.find_first_of(",\n", at_), text_.size());
    std::string cell(trimmed(text_.substr(at_, end - at_)));
    at_ = end;
    return cell;
  }

  std::string read_quoted() {
    const int start = line_;
    std::string cell;
    for (; at_ < text_.size(); ++at_) {
      if (text_[at_] == '"') {
        if (text_.compare(at_, 2, "\"\"") != 0) break;
        ++at_;
      }
      if (text_[at_] == '\n') ++line_;
      cell += text_[at_];
    }
    if (at_ == text_.size()) fail(start, "the quotes of this cell do not end");
    ++at_;
    const size_t end = std::min(text_.find_first_of(",\n", at_), text_.size());
    if (!trimmed(text_.substr(at_, end - at_)).empty()) {
      fail(line_, "text follows the quotes of a cell; quotes within quotes are doubled: \"\"");
    }
    at_ = end;
    return cell;
  }

  [[noreturn]] void fail(int line, const std::string& what) const {
    throw SceneError(file_, line, "", what);
  }

  std::string_view text_;
  const std::string& file_;
  size_t at_ = 0;
  int line_;
};

}  // namespace

std::vector<CsvRow> read_csv(const std::string& file) {
  const std::string text = read_text(file, kLargestJson);
  CsvParser parser(text, file, 1);
  std::vector<CsvRow> rows;
  while (!parser.at_end()) {
    CsvRow row = parser.read_row();
    if (row.cells.size() > 1 || !row.cells.front().empty()) rows.push_back(std::move(row));
  }
  return rows;
}

std::vector<std::string> csv_cells(std::string_view line, const std::string& file, int number) {
  return CsvParser(line, file, number).read_row().cells;
}

std::string csv_cell(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos && trimmed(text) == text) return text;
  return "\"" + replaced(text, "\"", "\"\"") + "\"";
}

std::string csv_row(const std::vector<std::string>& cells) {
  std::string row;
  for (const std::string& cell : cells)
    row += (&cell == &cells.front() ? "" : ",") + csv_cell(cell);
  return row + "\n";
}

}  // namespace apothem
