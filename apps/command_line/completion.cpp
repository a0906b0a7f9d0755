#include "apps/command_line/completion.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>

#include "apps/command_line/option_text.hpp"

namespace apothem {
namespace {

std::vector<std::string> names_of(const std::vector<OptionText>& options) {
  std::vector<std::string> names;
  for (const OptionText& option : options) {
    names.insert(names.end(), option.names.begin(), option.names.end());
  }
  return names;
}

// The values of one option in bash: a list of words, files, or nothing for numbers.
std::string bash_values(const OptionText& option) {
  if (!option.choices.empty()) return fmt::format("words=\"{}\"", fmt::join(option.choices, " "));
  return option.takes_file ? "files=yes" : "return";
}

std::string bash_command(const std::string& name, const std::vector<OptionText>& options) {
  std::string text;
  for (const OptionText& option : options) {
    if (option.names.empty() || option.value.empty()) continue;
    std::vector<std::string> patterns;
    for (const std::string& n : option.names) patterns.push_back(name + "/" + n);
    text += fmt::format("    {}) {} ;;\n", fmt::join(patterns, "|"), bash_values(option));
  }
  // What has no name of its own comes last: its words, or files, stand where no option fits.
  std::string words;
  bool files = false;
  for (const OptionText& option : options) {
    if (!option.names.empty()) continue;
    words += fmt::format("{}{}", words.empty() ? "" : " ", fmt::join(option.choices, " "));
    files = files || option.takes_file;
  }
  text += fmt::format("    {}/*) options=\"{}\" words=\"{}\"{} ;;\n", name,
                      fmt::join(names_of(options), " "), words, files ? " files=yes" : "");
  return text;
}

// In single quotes for zsh, with the characters that its _arguments reads as marks.
std::string zsh_text(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '\'') {
      result += "'\\''";
      continue;
    }
    if (c == '[' || c == ']' || c == ':' || c == '\\') result += '\\';
    result += c;
  }
  return result;
}

std::string zsh_values(const OptionText& option) {
  if (option.value.empty()) return "";
  std::string action = " ";
  if (!option.choices.empty()) action = fmt::format("({})", fmt::join(option.choices, " "));
  if (option.takes_file) action = "_files";
  return fmt::format(":{}:{}", zsh_text(option.value), action);
}

std::string zsh_arguments(const std::vector<OptionText>& options, const std::string& indent) {
  std::string text;
  for (const OptionText& option : options) {
    const std::string about = zsh_text(option.description), values = zsh_values(option);
    if (option.names.empty()) {
      text += fmt::format(" \\\n{}'{}{}'", indent, option.repeats ? "*" : "", values);
    } else if (option.repeats) {
      for (const std::string& name : option.names) {
        text += fmt::format(" \\\n{}'*{}[{}]{}'", indent, name, about, values);
      }
    } else if (option.names.size() == 1) {
      text += fmt::format(" \\\n{}'{}[{}]{}'", indent, option.names[0], about, values);
    } else {
      text += fmt::format(" \\\n{}'({})'{{{}}}'[{}]{}'", indent, fmt::join(option.names, " "),
                          fmt::join(option.names, ","), about, values);
    }
  }
  return text;
}

}  // namespace

std::string bash_completion(const CLI::App& app) {
  std::string cases;
  std::vector<std::string> commands;
  for (const CLI::App* command : commands_of(app)) {
    commands.push_back(command->get_name());
    cases += bash_command(command->get_name(), options_of(*command));
  }
  return fmt::format(R"(# Completion for bash, made by `apothem completion bash`.
_apothem() {{
  local current=${{COMP_WORDS[COMP_CWORD]}} previous=${{COMP_WORDS[COMP_CWORD - 1]}}
  local command="" options="" words="" files="" i
  COMPREPLY=()
  for ((i = 1; i < COMP_CWORD; i++)); do
    case ${{COMP_WORDS[i]}} in
    {}) command=${{COMP_WORDS[i]}}; break ;;
    esac
  done
  case $command/$previous in
{}    *) options="{}" words="{}" ;;
  esac
  [[ $current == -* ]] && words=$options files=""
  [[ -n $words ]] && COMPREPLY=($(compgen -W "$words" -- "$current"))
  if [[ -n $files ]]; then
    compopt -o filenames 2> /dev/null
    COMPREPLY+=($(compgen -f -- "$current"))
  fi
}}
complete -F _apothem apothem
)",
                     fmt::join(commands, "|"), cases, fmt::join(names_of(options_of(app)), " "),
                     fmt::join(commands, " "));
}

std::string zsh_completion(const CLI::App& app) {
  std::string commands, cases;
  for (const CLI::App* command : commands_of(app)) {
    commands +=
        fmt::format("        '{}:{}'\n", command->get_name(), zsh_text(command->get_description()));
    cases += fmt::format("        {})\n          _arguments{}\n          ;;\n", command->get_name(),
                         zsh_arguments(options_of(*command), "            "));
  }
  return fmt::format(R"(#compdef apothem
# Completion for zsh, made by `apothem completion zsh`.
_apothem() {{
  local context state line
  typeset -A opt_args
  _arguments -C{} \
    '1: :->command' \
    '*:: :->argument'
  case $state in
    command)
      local -a commands
      commands=(
{}      )
      _describe -t commands command commands
      ;;
    argument)
      case $line[1] in
{}      esac
      ;;
  esac
}}
if [[ $funcstack[1] == _apothem ]]; then
  _apothem "$@"
else
  compdef _apothem apothem
fi
)",
                     zsh_arguments(options_of(app), "    "), commands, cases);
}

}  // namespace apothem
