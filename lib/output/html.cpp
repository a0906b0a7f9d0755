#include "lib/output/html.hpp"

#include "lib/text/words.hpp"

namespace apothem {

std::string escaped(std::string_view text) {
  std::string result = replaced(std::string(text), "&", "&amp;");  // first: the others hold one
  result = replaced(replaced(std::move(result), "<", "&lt;"), ">", "&gt;");
  return replaced(std::move(result), "\"", "&quot;");
}

void add_base64(std::string& text, std::string_view bytes) {
  constexpr std::string_view kLetters =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  const auto byte = [&](size_t i) -> unsigned {
    return i < bytes.size() ? static_cast<unsigned char>(bytes[i]) : 0U;
  };
  size_t at = text.size();
  text.resize(at + (bytes.size() + 2) / 3 * 4);
  for (size_t i = 0; i < bytes.size(); i += 3) {
    const unsigned three = byte(i) << 16U | byte(i + 1) << 8U | byte(i + 2);
    for (const unsigned shift : {18U, 12U, 6U, 0U}) text[at++] = kLetters[three >> shift & 63U];
  }
  for (size_t i = bytes.size(); i % 3 != 0; ++i) text[text.size() - (3 - i % 3)] = '=';
}

std::string base64(std::string_view bytes) {
  std::string text;
  add_base64(text, bytes);
  return text;
}

}  // namespace apothem
