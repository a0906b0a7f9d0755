// Private header: what both reading and making a figure ask of the origins of its fields.
#pragma once

#include <string>
#include <vector>

#include "apps/reproduce/figure.hpp"
#include "lib/output/field.hpp"

namespace apothem {

/// The first field of a panel that comes from a table; null if there is none.
const FieldSource* first_reference(const std::vector<FieldSource>& sources);

/// The cells of a field that comes from a table in `data`/reference.
CellTable cells_of(const std::string& data, const FieldSource& source);

}  // namespace apothem
