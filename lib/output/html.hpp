// Text and bytes in HTML and XML.
#pragma once

#include <string>
#include <string_view>

namespace apothem {

/// The text with the characters that HTML reads as marks replaced.
std::string escaped(std::string_view text);

/// The bytes in base64 (RFC 4648), padded, without line breaks.
std::string base64(std::string_view bytes);
/// Appends them to a text.
void add_base64(std::string& text, std::string_view bytes);

}  // namespace apothem
