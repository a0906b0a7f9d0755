// Private header: what is said about a command line that cannot be read.
#pragma once

#include <string>

namespace CLI {
class App;
class ParseError;
}  // namespace CLI

namespace apothem {

/// One line: what is wrong, what was probably meant, and where help is. `app` has tried to parse.
std::string usage_message(const CLI::App& app, const CLI::ParseError& error);

}  // namespace apothem
