// Private header: the tables of numbers in a report.
#pragma once

#include <string>
#include <vector>

#include "lib/output/report.hpp"

namespace apothem {

/// How many numbers of a group there are, and how many of them are within their tolerance.
struct GroupCount {
  std::string name;  ///< as it heads the group's column of the summary
  size_t numbers = 0, met = 0;
};
/// The counts of the three groups, in the order of the tables.
std::vector<GroupCount> count_groups(const std::vector<ReportNumber>& numbers);

/// A cell of a table. On a narrow screen its `head` stands before it.
std::string table_cell(const char* head, const std::string& text, const char* kind = "number");

/// The tables as HTML, without those that would be empty.
std::string number_tables(const std::vector<ReportNumber>& numbers);

}  // namespace apothem
