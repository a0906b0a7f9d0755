// Private header: curves from tables of text (CSV): those of studies, of benchmarks, and shipped
// ones. Rows are chosen by the content of their cells; repeated values become shares or means with
// their intervals.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "apps/reproduce/text.hpp"
#include "lib/text/csv.hpp"

namespace apothem {

/// Rows of a table, and what is shown of them.
struct TableSource {
  /// value: y of each row; share: of rows whose y is true; counts: y events in `of` trials; mean:
  /// of the values of y. Rows with the same x belong together, except for `value`.
  enum class Kind { value, share, counts, mean };
  struct Axis {
    std::string column;
    double offset = 0, scale = 1;
    bool absolute = false;
    [[nodiscard]] double shown(double value) const;
  };
  std::string file;       ///< relative to the folder of studies, or of data
  bool of_study = false;  ///< which of the two
  /// Columns, each with the contents of which a row must have one; * at the end of a content stands
  /// for anything.
  std::vector<std::pair<std::string, std::vector<std::string>>> where;
  Kind kind = Kind::value;
  Axis x, y;
  std::string of;  ///< column with the number of trials, of counts
};

/// A point of a curve. The ends of its interval are those of 95 %: Wilson's of shares and counts,
/// Student's of means; without one they are the value itself.
struct TablePoint {
  double x = 0, y = 0, low = 0, high = 0;
  double trials = 0, events = 0;  ///< of shares and counts
};

/// Whether a curve's description is that of a table of text.
bool is_table_source(const JsonValue& curve);
/// Reads the keys of a table from an object. A table in `data` is checked to have the columns.
/// Throws SceneError.
TableSource read_table_source(const JsonReader& in, JsonObject& object, const std::string& data);

/// The points, by ascending x; those of `value` in the order of the rows if x repeats. Throws
/// SceneError if the file cannot be read, has not the columns, or no row is chosen.
std::vector<TablePoint> points_of(const TableSource& source, const std::string& data,
                                  const std::string& studies);

/// A comparison of two tables at the x that both have.
struct TableComparison {
  /// difference: of shares, the probability of it if they are the same; ratio: of the values;
  /// order: the part of the x at which the first is at least as large as the second.
  enum class Kind { difference, ratio, order };
  Kind kind = Kind::ratio;
  TableSource first, second;
  std::string label, name_of_x;
  ExpectedNumber expected;
};
/// Reads an element of "compare". Throws SceneError.
TableComparison read_comparison(const JsonReader& in, const JsonValue& value,
                                const std::string& data);
/// Its numbers. Throws as points_of().
std::vector<ReportNumber> numbers_of(const TableComparison& comparison, const std::string& data,
                                     const std::string& studies);

}  // namespace apothem
