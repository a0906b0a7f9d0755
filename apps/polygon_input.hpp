// What `contact` and `polygon` read alike from the command line and from files.
#pragma once

#include <functional>
#include <string>

#include "apothem/geometry/potential/potential.hpp"

namespace apothem {

/// --reference: roof, inscribed_circle or a length in m. Throws SceneError.
void set_reference(PotentialChoice& choice, const std::string& text);

/// Calls evaluate(name, line) for every line of a file that is not empty; the name is its first
/// word. Throws SceneError if the file cannot be read.
void for_each_line(const std::string& file,
                   const std::function<void(const std::string&, const std::string&)>& evaluate);

}  // namespace apothem
