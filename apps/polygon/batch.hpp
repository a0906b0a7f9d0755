// Private header: files with a polygon or a pair per line.
#pragma once

#include <functional>
#include <string>

#include "lib/scene/ring_line.hpp"

namespace apothem {

/// What is printed for a line, and whether the line was refused.
struct BatchAnswer {
  std::string text;
  bool refused = false;
};

/// Prints an answer for each line of a file, in the order of the lines, as for_each_line() finds
/// them. Several are found at the same time, on all processors, so evaluate() must not change
/// anything. If it throws, the answers before are printed. Returns the exit code.
int print_answers(const std::string& file, const char* form,
                  const std::function<BatchAnswer(const BatchLine&)>& evaluate);

}  // namespace apothem
