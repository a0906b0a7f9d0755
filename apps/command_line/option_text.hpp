// Private header: the options of a command line as text, for help that is not on the terminal.
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace apothem {

/// An option, or an argument without a name of its own.
struct OptionText {
  std::vector<std::string> names;    ///< with their dashes; empty: a positional argument
  std::string value;                 ///< what it takes, like INT or DIR; empty: nothing
  std::vector<std::string> choices;  ///< if only these are allowed
  bool takes_file = false;           ///< the name of a file or folder would make sense
  bool repeats = false;              ///< may be given again and again
  bool required = false;
  std::string description;
  std::string default_value;  ///< empty: none
};

/// Of one command; those without a name last.
std::vector<OptionText> options_of(const CLI::App& command);

/// In the order in which they were added.
std::vector<const CLI::App*> commands_of(const CLI::App& app);

}  // namespace apothem
