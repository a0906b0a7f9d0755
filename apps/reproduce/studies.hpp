// Private header: commands of this program whose tables figures show: sweeps, benchmarks.
#pragma once

#include <string>
#include <vector>

#include "lib/scene/json.hpp"

namespace apothem {

/// Commands of this program that make tables. {data} and {out} in their words stand for the folder
/// of data and for the study's own.
struct FigureStudy {
  using Commands = std::vector<std::vector<std::string>>;
  std::string name;  ///< of the folder; a study of the same name is the same in all figures
  Commands commands, quick;

  [[nodiscard]] const Commands& of(bool is_quick) const {
    return is_quick && !quick.empty() ? quick : commands;
  }
};

/// Reads an element of "studies". Throws SceneError.
FigureStudy read_study(const JsonReader& in, const JsonValue& value);

/// The words of a command with the folders in place.
std::vector<std::string> words_of(const std::vector<std::string>& command, const std::string& data,
                                  const std::string& out);

/// A command as one types it.
std::string command_line(const std::vector<std::string>& command);

}  // namespace apothem
