// Private header of `apothem accuracy`: the pairs of polygons that it measures, in cases.
#pragma once

#include <optional>

#include "apps/accuracy/methods.hpp"
#include "lib/scene/pair_file.hpp"

namespace apothem {

/// A set of pairs that share a row of the table.
struct AccuracyCase {
  std::string name;
  bool random = false;  ///< random polygons in general position
  std::vector<PreparedPair> pairs;
  /// One expected contact per pair, empty where the file gives none.
  std::vector<std::optional<ExpectedContact>> expected;
  int refused = 0;  ///< number of pairs whose polygons are invalid
};

/// The pairs of the files, in cases by their kind; without files random pairs and the hard ones.
/// Pairs with invalid polygons are named on stderr and counted. Throws SceneError if a file cannot
/// be read.
std::vector<AccuracyCase> accuracy_cases(const std::vector<std::string>& files);

}  // namespace apothem
