// Whole files as text. Every file that is read as input goes through here, so that devices, files
// that are too large and foreign encodings are refused everywhere or nowhere.
#pragma once

#include <cstddef>
#include <fstream>
#include <string>

#include "lib/text/error.hpp"

namespace apothem {

/// Bytes of the largest files that are read: as text, and as JSON, whose values take up to forty
/// times as much memory.
inline constexpr size_t kLargestText = size_t{1} << 30, kLargestJson = size_t{1} << 27;

/// The contents of a file, without a byte order mark. Throws SceneError if it cannot be read or is
/// larger than `limit` (bytes).
std::string read_text(const std::string& file, size_t limit = kLargestText);

/// The same, or an empty text where read_text() would throw.
std::string find_text(const std::string& file);

/// Opens a file to read it as text. Throws SceneError if it is a directory or cannot be opened.
std::ifstream open_text(const std::string& file);

/// Takes the byte order mark of UTF-8 from the start of a text. Throws SceneError if the text is
/// UTF-16.
void strip_byte_order_mark(std::string& text, const std::string& file);

/// The bytes of a file that this program or a child of it has written. Empty if it cannot be read.
std::string read_bytes(const std::string& file);

}  // namespace apothem
