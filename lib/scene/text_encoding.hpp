// Text of files that are not in UTF-8.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace apothem {

/// Whether all bytes of a text are valid UTF-8.
bool is_utf8(std::string_view text);

/// A text in UTF-8, by an encoding that iconv knows by this name. Nothing if there is no such
/// encoding, or if the text is not in it.
std::optional<std::string> to_utf8(std::string_view text, const std::string& encoding);

}  // namespace apothem
