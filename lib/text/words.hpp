// Words of input and of messages.
#pragma once

#include <iterator>
#include <string>
#include <string_view>
#include <vector>

namespace apothem {

/// The text with the letters of ASCII in lower or in upper case.
std::string lower_case(std::string_view text);
std::string upper_case(std::string_view text);

/// The text without blanks at its ends; `blanks` are the characters that count as such.
std::string_view trimmed(std::string_view text, std::string_view blanks = " \t\r");

/// The text with `by` in place of each `mark`.
std::string replaced(std::string text, std::string_view mark, std::string_view by);

/// The names of things that have one.
template <class Things>
std::vector<std::string> names_of(const Things& things) {
  std::vector<std::string> names;
  names.reserve(std::size(things));
  for (const auto& thing : things) names.emplace_back(thing.name);
  return names;
}

/// The candidate that `word` was most likely meant to be, or null if none is similar.
const std::string* nearest_word(std::string_view word, const std::vector<std::string>& candidates);

/// `word` in quotes, followed by "did you mean ...?" if a candidate looks like it.
std::string suggest(std::string_view word, const std::vector<std::string>& candidates);

}  // namespace apothem
