#include "apps/command_line/manual.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>

#include "apps/command_line/option_text.hpp"
#include "version.hpp"

namespace apothem {
namespace {

// Text as roff takes it literally.
std::string roff(const std::string& text) {
  std::string result;
  bool starts_line = true;
  for (const char c : text) {
    if (starts_line && (c == '.' || c == '\'')) result += "\\&";
    starts_line = c == '\n';
    if (c == '\\') {
      result += "\\e";
    } else if (c == '-') {
      result += "\\-";
    } else {
      result += c;
    }
  }
  return result;
}

std::string bold(const std::string& text) { return "\\fB" + roff(text) + "\\fR"; }
std::string italic(const std::string& text) { return "\\fI" + roff(text) + "\\fR"; }

std::string value_of(const OptionText& option) {
  if (option.choices.empty()) return italic(option.value);
  std::vector<std::string> choices;
  for (const std::string& choice : option.choices) choices.push_back(bold(choice));
  return fmt::format("{}", fmt::join(choices, "|"));
}

std::string synopsis(const CLI::App& command) {
  std::string text = fmt::format(".B apothem {}\n", roff(command.get_name()));
  std::string arguments = "[" + italic("OPTION") + " ...]";
  for (const OptionText& option : options_of(command)) {
    if (!option.names.empty()) continue;
    const std::string name = italic(option.value) + (option.repeats ? " ..." : "");
    arguments += option.required ? " " + name : " [" + name + "]";
  }
  return text + arguments + "\n";
}

std::string paragraph(const OptionText& option) {
  std::vector<std::string> names;
  for (const std::string& name : option.names) names.push_back(bold(name));
  std::string head = fmt::format("{}", fmt::join(names, ", "));
  if (!option.value.empty()) head += (head.empty() ? "" : " ") + value_of(option);
  const std::string preset =
      option.default_value.empty() ? "" : "; default " + roff(option.default_value);
  return fmt::format(".TP\n{}\n{}{}\n", head, roff(option.description), preset);
}

}  // namespace

std::string manual_page(const CLI::App& app) {
  std::string text = fmt::format(".TH APOTHEM 1 \"\" \"apothem {}\" \"User Commands\"\n", kVersion);
  const std::string about = app.get_description();
  const size_t colon = about.find(": ");
  text += fmt::format(".SH NAME\napothem \\- {}\n.SH SYNOPSIS\n",
                      roff(colon == std::string::npos ? about : about.substr(colon + 2)));
  bool first = true;
  for (const CLI::App* command : commands_of(app)) {
    if (!first) text += ".br\n";
    first = false;
    text += synopsis(*command);
  }
  text += ".SH OPTIONS\n";
  for (const OptionText& option : options_of(app)) text += paragraph(option);
  text += ".SH COMMANDS\n";
  for (const CLI::App* command : commands_of(app)) {
    text +=
        fmt::format(".SS {}\n{}.\n", roff(command->get_name()), roff(command->get_description()));
    for (const OptionText& option : options_of(*command)) text += paragraph(option);
  }
  return text + ".SH EXIT STATUS\n" + roff(app.get_footer()) + "\n";
}

}  // namespace apothem
