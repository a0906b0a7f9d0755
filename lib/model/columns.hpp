// The columns of history.csv.
#pragma once

#include <string>
#include <vector>

#include "apothem/model/model.hpp"
#include "apothem/model/settings.hpp"

namespace apothem {

struct HistoryColumn {
  std::string name;  ///< as in "beam.ux"
  const char* unit;
};

/// After the time: rigid bodies, deformable ones, surfaces, points.
std::vector<HistoryColumn> history_columns(const Model& model, const OutputSettings& settings);

}  // namespace apothem
