// Private header of the sub-commands `contact` and `polygon`: input that both of them read.
#pragma once

#include <functional>
#include <string>

#include "apothem/geometry/potential/potential.hpp"

namespace apothem {

/// Sets the reference length from the argument of --reference: roof, inscribed_circle or a length
/// in m. Throws SceneError for anything else.
void set_reference(PotentialChoice& choice, const std::string& text);

/// Calls evaluate(name, line) for each line of a file that is not blank; the name is the first word
/// of the line. Throws SceneError if the file cannot be read.
void for_each_line(const std::string& file,
                   const std::function<void(const std::string&, const std::string&)>& evaluate);

}  // namespace apothem
