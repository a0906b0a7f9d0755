// Private header of the sub-commands `contact` and `polygon`: input that both of them read.
#pragma once

#include <string>

#include "geometry/potential/potential.hpp"

namespace apothem {

/// Sets the reference length from the argument of --reference: roof, inscribed_circle or a length
/// in m. Throws UsageError for anything else.
void set_reference(PotentialChoice& choice, const std::string& text);

}  // namespace apothem
