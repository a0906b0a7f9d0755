#include "lib/text/decimal.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>

#include "lib/text/words.hpp"

namespace apothem {
namespace {

constexpr size_t kShown = 40;  // characters of a word that a message quotes

std::string quoted(std::string_view word) {
  return fmt::format("\"{}{}\"", word.substr(0, kShown), word.size() > kShown ? "..." : "");
}

[[noreturn]] void refuse(std::string_view word) {
  std::string name = lower_case(word);
  if (name.starts_with('+') || name.starts_with('-')) name.erase(0, 1);
  const bool infinite = name == "nan" || name == "inf" || name == "infinity";
  throw BadNumber(quoted(word) + (infinite ? " is not finite" : " is not a decimal number"));
}

}  // namespace

double parse_decimal(std::string_view word) {
  if (word.empty() || word.find_first_not_of("0123456789.eE+-") != std::string_view::npos) {
    refuse(word);
  }
  // from_chars() knows no plus sign in front.
  std::string_view digits = word;
  if (digits[0] == '+') digits.remove_prefix(1);
  if (digits.empty() || digits[0] == '+' || (digits[0] == '-' && word[0] == '+')) refuse(word);
  double value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (end != digits.data() + digits.size() || error == std::errc::invalid_argument) refuse(word);
  if (error == std::errc::result_out_of_range) {
    value = std::strtod(std::string(digits).c_str(), nullptr);  // which tells large from small
  }
  if (!std::isfinite(value)) {
    throw BadNumber(quoted(word) + " is out of the range of double precision");
  }
  return value;
}

int parse_count(std::string_view word) {
  const std::optional<int> value = find_integer<int>(word);
  if (!value || *value < 0) throw BadNumber(quoted(word) + " is not a whole number");
  return *value;
}

std::optional<double> find_decimal(std::string_view word) {
  try {
    return parse_decimal(word);
  } catch (const BadNumber&) {
    return {};
  }
}

std::optional<int> find_count(std::string_view word) {
  try {
    return parse_count(word);
  } catch (const BadNumber&) {
    return {};
  }
}

}  // namespace apothem
