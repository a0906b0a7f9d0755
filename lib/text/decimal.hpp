// Numbers in text that is not JSON: tables, meshes, lines of batch files, WKT, arguments of the
// command line. All of them are read here, so that a word is a number everywhere or nowhere.
#pragma once

#include <charconv>
#include <optional>
#include <stdexcept>
#include <string_view>

namespace apothem {

/// The error for a word that is not a number. It says what the word is instead.
class BadNumber : public std::invalid_argument {
 public:
  using std::invalid_argument::invalid_argument;
};

/// The number that a whole word holds in decimal notation: digits with a point, a sign and an
/// exponent if need be. Hexadecimal numbers, infinity and NaN are no numbers here. A value too
/// small for double precision becomes 0. Throws BadNumber.
double parse_decimal(std::string_view word);

/// The whole number that a whole word holds, or nothing if `Integer` cannot hold it.
template <class Integer>
std::optional<Integer> find_integer(std::string_view word) {
  Integer value{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size()) return {};
  return value;
}

/// The whole number, 0 or more, that a whole word holds. Throws BadNumber.
int parse_count(std::string_view word);

/// The number that parse_decimal() or parse_count() would return, or nothing where it would throw.
std::optional<double> find_decimal(std::string_view word);
std::optional<int> find_count(std::string_view word);

}  // namespace apothem
