// Private header: scripts that complete the command line in a shell.
#pragma once

#include <string>

namespace CLI {
class App;
}

namespace apothem {

std::string bash_completion(const CLI::App& app);
std::string zsh_completion(const CLI::App& app);

}  // namespace apothem
