#include "lib/scene/text_encoding.hpp"

#include <iconv.h>

#include <array>

namespace apothem {

std::optional<std::string> to_utf8(std::string_view text, const std::string& encoding) {
  const iconv_t converter = iconv_open("UTF-8", encoding.c_str());
  if (converter == reinterpret_cast<iconv_t>(-1)) return {};
  std::string input(text), result;
  char* from = input.data();
  size_t left = input.size();
  bool good = true;
  while (good && left > 0) {
    std::array<char, 4096> part{};
    char* to = part.data();
    size_t room = part.size();
    const size_t before = left;
    const bool whole = iconv(converter, &from, &left, &to, &room) != static_cast<size_t>(-1);
    result.append(part.data(), part.size() - room);
    // It also stops where the part is full.
    good = whole || (left < before && room < 8);
  }
  iconv_close(converter);
  if (!good) return {};
  return result;
}

bool is_utf8(std::string_view text) { return to_utf8(text, "UTF-8").has_value(); }

}  // namespace apothem
