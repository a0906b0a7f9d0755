#include "apps/reproduce/studies.hpp"

#include <algorithm>
#include <cctype>

#include "lib/text/words.hpp"

namespace apothem {
namespace {

FigureStudy::Commands read_commands(const JsonReader& in, const JsonValue& value) {
  FigureStudy::Commands commands;
  for (const JsonValue& item : in.array(value)) {
    std::vector<std::string>& words = commands.emplace_back();
    for (const JsonValue& word : in.array(item)) words.push_back(in.string(word));
    if (words.empty() ||
        (words[0] != "sweep" && words[0] != "accuracy" && words[0] != "benchmark")) {
      in.fail(item, "must be a command: sweep, accuracy or benchmark and its arguments");
    }
  }
  if (commands.empty()) in.fail(value, "must hold at least one command");
  return commands;
}

}  // namespace

FigureStudy read_study(const JsonReader& in, const JsonValue& value) {
  JsonObject object(in, value);
  FigureStudy study;
  const JsonValue& name = object.required("name", "name of the folder of results");
  study.name = in.string(name);
  const auto plain = [](unsigned char c) { return std::isalnum(c) || c == '-'; };
  if (study.name.empty() || !std::ranges::all_of(study.name, plain)) {
    in.fail(name, "must consist of letters, digits and hyphens");
  }
  study.commands = read_commands(in, object.required("commands", "array of commands"));
  if (const JsonValue* v = object.optional("quick")) study.quick = read_commands(in, *v);
  object.finish();
  return study;
}

std::vector<std::string> words_of(const std::vector<std::string>& command, const std::string& data,
                                  const std::string& out) {
  std::vector<std::string> words;
  words.reserve(command.size());
  for (const std::string& word : command) {
    words.push_back(replaced(replaced(word, "{data}", data), "{out}", out));
  }
  return words;
}

std::string command_line(const std::vector<std::string>& command) {
  std::string line = "apothem";
  for (const std::string& word : command) {
    const bool plain = word.find_first_of(" \"'[]{}()*?;&|<>$#") == std::string::npos;
    line += plain ? " " + word : " '" + word + "'";
  }
  return line;
}

}  // namespace apothem
