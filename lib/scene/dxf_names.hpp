// Names in DXF files: of layers and blocks, in the encodings of many years.
#pragma once

#include <string>
#include <string_view>

namespace apothem {

/// A name without escapes: \U+hhhh stands for a unit of UTF-16, \M+Nhhhh for a character of the
/// East Asian code page N. What is no character stays as it is.
std::string unescaped(std::string_view text);

/// The text of a DXF file in UTF-8. Files of 2007 (`version` AC1021) and later are in UTF-8
/// whatever the code page `page` of their header says. Throws SceneError if the text is not in its
/// encoding.
std::string decoded(const std::string& file, std::string text, const std::string& version,
                    const std::string& page);

}  // namespace apothem
