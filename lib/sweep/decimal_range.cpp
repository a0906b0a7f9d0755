#include "lib/sweep/decimal_range.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>

#include "lib/text/decimal.hpp"

namespace apothem {
namespace {

constexpr int kDigits = 15;  // so many decimal digits are told apart by doubles

// digits * 10^exponent
struct Decimal {
  std::int64_t digits = 0;
  int exponent = 0;
};

[[noreturn]] void refuse_digits(std::string_view word) {
  throw BadNumber(fmt::format("\"{}\" has more than {} digits in this range", word, kDigits));
}

Decimal parse_digits(std::string_view word) {
  parse_decimal(word);  // throws unless it is a number
  const size_t end_of_digits = std::min(word.find_first_of("eE"), word.size());
  std::string digits(word.substr(0, end_of_digits));
  Decimal result;
  if (end_of_digits < word.size()) {
    result.exponent = std::atoi(std::string(word.substr(end_of_digits + 1)).c_str());
  }
  if (const size_t point = digits.find('.'); point != std::string::npos) {
    result.exponent -= static_cast<int>(digits.size() - point - 1);
    digits.erase(point, 1);
  }
  if (digits[0] == '+') digits.erase(0, 1);
  const auto whole = find_integer<std::int64_t>(digits);
  if (!whole) refuse_digits(word);
  result.digits = *whole;
  while (result.digits != 0 && result.digits % 10 == 0) {
    result.digits /= 10;
    ++result.exponent;
  }
  if (result.digits == 0) result.exponent = 0;
  return result;
}

// The digits of a number as a multiple of 10^exponent.
std::int64_t digits_at(const Decimal& number, int exponent, std::string_view word) {
  constexpr std::int64_t kMost = 1'000'000'000'000'000;
  std::int64_t digits = number.digits;
  for (int e = number.exponent; e > exponent; --e) {
    if (std::abs(digits) >= kMost / 10) refuse_digits(word);
    digits *= 10;
  }
  if (std::abs(digits) >= kMost) refuse_digits(word);
  return digits;
}

}  // namespace

std::vector<std::string> decimal_range(std::string_view from, std::string_view to,
                                       std::optional<std::string_view> step, size_t most) {
  const Decimal first = parse_digits(from), last = parse_digits(to);
  if (!step && (first.exponent < 0 || last.exponent < 0)) {
    throw BadNumber("a range between numbers that are not whole needs a step, like 0.1..0.5:0.1");
  }
  const std::string_view by = step.value_or("1");
  const Decimal width = parse_digits(by);
  const int exponent = std::min({first.exponent, last.exponent, width.exponent});
  const std::int64_t a = digits_at(first, exponent, from), b = digits_at(last, exponent, to),
                     d = digits_at(width, exponent, by);
  if (d == 0) throw BadNumber("the step of a range must not be 0");
  if ((b - a) / d < 0 || (a != b && (b > a) != (d > 0))) {
    throw BadNumber(fmt::format("a step of {} does not lead from {} to {}", by, from, to));
  }
  const auto steps = static_cast<size_t>((b - a) / d);
  if (steps >= most) {
    throw BadNumber(
        fmt::format("the range has {} values; at most {} are allowed", steps + 1, most));
  }
  std::vector<std::string> values;
  values.reserve(steps + 1);
  for (size_t i = 0; i <= steps; ++i) {
    const std::int64_t digits = a + static_cast<std::int64_t>(i) * d;
    values.push_back(fmt::format("{}", parse_decimal(fmt::format("{}e{}", digits, exponent))));
  }
  return values;
}

}  // namespace apothem
