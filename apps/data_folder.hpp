// Private header: where the data that come with the program are.
#pragma once

#include <string>

namespace apothem {

/// The data folder that is installed with the program or, if there is none, the one in the source
/// folder from which the program was built.
std::string data_folder();

}  // namespace apothem
