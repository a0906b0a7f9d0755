#include "lib/output/html.hpp"

#include "lib/text/words.hpp"

namespace apothem {

std::string escaped(std::string_view text) {
  std::string result = replaced(std::string(text), "&", "&amp;");  // first: the others hold one
  result = replaced(replaced(std::move(result), "<", "&lt;"), ">", "&gt;");
  return replaced(std::move(result), "\"", "&quot;");
}

std::string base64(std::string_view bytes) {
  constexpr const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (size_t i = 0; i < bytes.size(); i += 3) {
    unsigned block = 0;
    for (size_t k = i; k < i + 3; ++k) {
      block = block << 8U | (k < bytes.size() ? static_cast<unsigned char>(bytes[k]) : 0U);
    }
    for (size_t k = 0; k < 4; ++k) {
      text += i + k > bytes.size() ? '=' : digits[block >> (18 - 6 * k) & 63U];
    }
  }
  return text;
}

}  // namespace apothem
