#include "apps/command_line/usage.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <vector>

#include "apps/command_line/option_text.hpp"
#include "lib/scene/json.hpp"
#include "lib/text/words.hpp"

namespace apothem {
namespace {

std::string unknown_option(const CLI::App& app, const std::string& argument) {
  std::vector<std::string> names;
  for (const OptionText& option : options_of(app)) {
    names.insert(names.end(), option.names.begin(), option.names.end());
  }
  return "unknown option " + suggest(argument.substr(0, argument.find('=')), names);
}

std::string unknown_command(const CLI::App& app, const std::string& word) {
  std::vector<std::string> commands;
  for (const CLI::App* command : commands_of(app)) commands.push_back(command->get_name());
  const std::string known = fmt::format(" (known: {})", fmt::join(commands, ", "));
  if (word.ends_with(".json")) {
    return fmt::format("\"{0}\" is no command; did you mean \"apothem run {0}\"?{1}", word, known);
  }
  return "unknown command " + suggest(word, commands) + known;
}

}  // namespace

std::string usage_message(const CLI::App& app, const CLI::ParseError& error) {
  const std::vector<CLI::App*> used = app.get_subcommands();
  const CLI::App& at = used.empty() ? app : *used.front();
  const std::string help =
      used.empty() ? "apothem --help" : fmt::format("apothem {} --help", at.get_name());
  // What could not be understood is more telling than what is missing because of it.
  const std::vector<std::string> rest = at.remaining();
  const auto option = std::ranges::find_if(
      rest, [](const std::string& word) { return word.size() > 1 && word[0] == '-'; });
  std::string what = error.what();
  if (option != rest.end()) {
    what = unknown_option(at, *option);
  } else if (!rest.empty()) {
    what = used.empty() ? unknown_command(app, rest.front())
                        : fmt::format("\"{}\" is one argument too many", rest.front());
  }
  return fmt::format("{}; see {}", what, help);
}

}  // namespace apothem
