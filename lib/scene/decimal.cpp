#include "lib/scene/decimal.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdlib>

namespace apothem {
namespace {

constexpr size_t kShown = 40;  // characters of a word that a message quotes

std::string quoted(std::string_view word) {
  return fmt::format("\"{}{}\"", word.substr(0, kShown), word.size() > kShown ? "..." : "");
}

bool is_one_of(std::string_view word, std::initializer_list<std::string_view> names) {
  if (!word.empty() && (word[0] == '+' || word[0] == '-')) word.remove_prefix(1);
  return std::any_of(names.begin(), names.end(), [&](std::string_view name) {
    return std::equal(word.begin(), word.end(), name.begin(), name.end(), [](char a, char b) {
      return std::tolower(static_cast<unsigned char>(a)) == b;
    });
  });
}

[[noreturn]] void refuse(std::string_view word) {
  if (is_one_of(word, {"nan", "inf", "infinity"})) {
    throw BadNumber(quoted(word) + " is not finite");
  }
  throw BadNumber(quoted(word) + " is not a decimal number");
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
  int value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size() || value < 0) {
    throw BadNumber(quoted(word) + " is not a whole number");
  }
  return value;
}

}  // namespace apothem
