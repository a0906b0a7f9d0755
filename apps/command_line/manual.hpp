// Private header: the manual page, apothem(1).
#pragma once

#include <string>

namespace CLI {
class App;
}

namespace apothem {

/// In the man macros of roff.
std::string manual_page(const CLI::App& app);

}  // namespace apothem
