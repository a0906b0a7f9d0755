// Words, numbers and tables of text.
#include <catch2/catch.hpp>

#include <cmath>
#include <limits>

#include "lib/output/history.hpp"
#include "lib/text/csv.hpp"
#include "lib/text/decimal.hpp"
#include "lib/text/file.hpp"
#include "lib/text/words.hpp"
#include "tests/folder.hpp"

using namespace apothem;

TEST_CASE("words in lower and upper case, and without blanks", "[text]") {
  CHECK(lower_case("Ab-1Z") == "ab-1z");
  CHECK(upper_case("Ab-1z") == "AB-1Z");
  CHECK(trimmed(" \ta b\r") == "a b");
  CHECK(trimmed(" \t").empty());
  CHECK(trimmed("  x\r", " ") == "x\r");
}

TEST_CASE("numbers are found where they would be read", "[text]") {
  CHECK(find_decimal("+1.5e1") == 15);
  CHECK(find_count("007") == 7);
  for (const char* word : {"", "inf", "nan", "0x1", "1e999", "1 "}) CHECK_FALSE(find_decimal(word));
  for (const char* word : {"", "-1", "1.0", "+1"}) CHECK_FALSE(find_count(word));
}

TEST_CASE("cells of CSV come back as they were", "[text]") {
  const std::vector<std::string> cells{"a", "", " blanks ", "comma, and \"quotes\"", "1e-3"};
  const std::string row = csv_row(cells);
  CHECK(csv_cells(row.substr(0, row.size() - 1), "file", 1) == cells);
  CHECK(csv_cell("plain text") == "plain text");
}

TEST_CASE("histories hold what a run writes, and what one writes that became unstable", "[text]") {
  const test::Folder folder;
  const auto file = [&](const std::string& rows) {
    return folder.write("history.csv", "time [s],a.x [m]\n" + rows);
  };
  const HistoryTable table = read_history(file("0,1\n1e-3,2\n2,3"));  // the last row is unfinished
  CHECK(table.names == std::vector<std::string>{"time", "a.x"});
  CHECK(table.units == std::vector<std::string>{"s", "m"});
  CHECK(table.columns == std::vector<std::vector<double>>{{0, 1e-3}, {1, 2}});
  const HistoryTable unstable = read_history(file("0,inf\n1,nan\n"));
  CHECK(unstable.columns[1].front() == std::numeric_limits<double>::infinity());
  CHECK(std::isnan(unstable.columns[1].back()));
  for (const char* row : {"0\n", "0,1,2\n", "0,1e999\n", "0,0x1\n", "0,+1\n", "\n", "0,\n"}) {
    CHECK_THROWS_WITH(read_history(file(row)),
                      Catch::EndsWith("history.csv:2: is not a row of 2 numbers"));
  }
}

TEST_CASE("a text that cannot be read is an empty one for those who need none", "[text]") {
  const test::Folder folder;
  CHECK(find_text(folder.write("there", "words")) == "words");
  CHECK(find_text(folder / "not there").empty());
  CHECK(find_text(folder / "").empty());
}
