// Private header: what a figure says in words.
#pragma once

#include "lib/output/report.hpp"
#include "lib/scene/json.hpp"

namespace apothem {

/// Reads the keys "about", "paper", "open" and "verdict" of a figure. Throws SceneError.
FigureText read_figure_text(const JsonReader& in, JsonObject& figure);

/// A number that a figure expects, and what the number rests on.
struct ExpectedNumber {
  double value = 0, tolerance = 0;
  Basis basis = Basis::code;
  std::string source;

  /// Beside what has come out.
  [[nodiscard]] ReportNumber beside(const std::string& scene, const std::string& what,
                                    const std::string& unit, double found) const;
};
/// Reads the keys "value", "tolerance", "basis" and "source". Throws SceneError.
ExpectedNumber read_expected(const JsonReader& in, JsonObject& object);

}  // namespace apothem
