#include "apps/command_line/option_text.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <sstream>

namespace apothem {
namespace {

// CLI11 names the type of an option and its checks like "TEXT:{distance,area}".
void read_type(const std::string& type, OptionText& text) {
  text.value = type.substr(0, type.find(':'));
  const size_t open = type.find('{'), close = type.find('}');
  if (open < close && close != std::string::npos) {
    std::istringstream list(type.substr(open + 1, close - open - 1));
    for (std::string choice; std::getline(list, choice, ',');) text.choices.push_back(choice);
  }
  text.takes_file = text.value == "FILE" || text.value.starts_with("DIR");
}

OptionText text_of(const CLI::Option& option) {
  OptionText text;
  for (const std::string& name : option.get_snames()) text.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) text.names.push_back("--" + name);
  if (option.get_items_expected_max() > 0) read_type(option.get_type_name(), text);
  if (text.names.empty()) text.value = option.get_name();
  text.repeats = option.get_items_expected_max() > 1;
  text.required = option.get_required();
  text.description = option.get_description();
  text.default_value = option.get_default_str();
  return text;
}

}  // namespace

std::vector<OptionText> options_of(const CLI::App& command) {
  std::vector<OptionText> texts;
  for (const CLI::Option* option : command.get_options()) texts.push_back(text_of(*option));
  std::stable_partition(texts.begin(), texts.end(),
                        [](const OptionText& text) { return !text.names.empty(); });
  return texts;
}

std::vector<const CLI::App*> commands_of(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App*) { return true; });
}

}  // namespace apothem
