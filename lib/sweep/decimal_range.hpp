// Ranges of decimal numbers without a drift from rounding.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace apothem {

/// The numbers from + i step up to `to`, each in the shortest form that reads back to the same
/// double. They are computed with the decimal digits as written: 0.1, 0.2, 0.3 where doubles would
/// give 0.30000000000000004. Without a step it is 1, and both ends must be whole numbers. Throws
/// BadNumber (decimal.hpp) with what is wrong, also if there are more than `most` numbers.
std::vector<std::string> decimal_range(std::string_view from, std::string_view to,
                                       std::optional<std::string_view> step, size_t most);

}  // namespace apothem
