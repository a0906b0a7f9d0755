#include "lib/scene/dxf_names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>

#include "lib/scene/json.hpp"
#include "lib/scene/text_encoding.hpp"
#include "lib/text/words.hpp"

namespace apothem {
namespace {

// The code page of a header, by the name that iconv has for it.
std::string encoding_of(const std::string& page) {
  std::string name = upper_case(page);
  const auto behind = [&](std::string_view start) { return name.substr(start.size()); };
  if (name == "ANSI_1361") return "JOHAB";
  if (name.starts_with("ANSI_")) return "CP" + behind("ANSI_");
  if (name.starts_with("DOS")) return "CP" + behind("DOS");
  if (name.starts_with("ISO8859")) return "ISO-8859-" + behind("ISO8859-");
  if (name == "MACINTOSH" || name == "MAC-ROMAN") return "MACINTOSH";
  if (name.empty() || name == "ASCII" || name == "US_ASCII") return "CP1252";
  return name;
}

// The two bytes that four hexadecimal digits stand for.
std::optional<std::string> two_bytes(std::string_view text) {
  const std::string digits(text.substr(0, 4));
  const bool good = digits.size() == 4 && std::ranges::all_of(digits, [](unsigned char c) {
                      return std::isxdigit(c) != 0;
                    });
  if (!good) return {};
  const unsigned long code = std::stoul(digits, nullptr, 16);
  return std::string{static_cast<char>(code >> 8), static_cast<char>(code & 0xFF)};
}

// An escape at the start of a text.
struct Escape {
  std::string character;  // in UTF-8
  size_t size;            // of the escape
};

constexpr size_t kUnit = 7;  // characters of \U+hhhh

// The unit of UTF-16 at the start of a text.
std::optional<std::string> utf16_at(std::string_view text) {
  if (!text.starts_with("\\U+") && !text.starts_with("\\u+")) return {};
  return two_bytes(text.substr(3));
}

std::optional<Escape> escape_at(std::string_view text) {
  if (const auto unit = utf16_at(text)) {
    if (auto character = to_utf8(*unit, "UTF-16BE")) return Escape{*character, kUnit};
    const auto second = utf16_at(text.substr(kUnit));  // of a surrogate pair
    if (!second) return {};
    if (auto character = to_utf8(*unit + *second, "UTF-16BE")) {
      return Escape{*character, 2 * kUnit};
    }
    return {};
  }
  constexpr std::array kPages{"CP932", "CP950", "CP949", "JOHAB", "CP936"};
  if (!text.starts_with("\\M+") || text.size() < 8 || text[3] < '1' || text[3] > '5') return {};
  const auto bytes = two_bytes(text.substr(4));
  if (!bytes) return {};
  const auto character = to_utf8(*bytes, kPages[static_cast<size_t>(text[3] - '1')]);
  if (!character) return {};
  return Escape{*character, 8};
}

}  // namespace

std::string unescaped(std::string_view text) {
  std::string result;
  while (!text.empty()) {
    const auto escape = text.front() == '\\' ? escape_at(text) : std::nullopt;
    result += escape ? escape->character : std::string(1, text.front());
    text.remove_prefix(escape ? escape->size : 1);
  }
  return result;
}

std::string decoded(const std::string& file, std::string text, const std::string& version,
                    const std::string& page) {
  const bool is_ascii =
      std::ranges::all_of(text, [](char c) { return static_cast<unsigned char>(c) < 0x80; });
  if (is_ascii) return text;
  if ((version >= "AC1021" || page.empty()) && is_utf8(text)) return text;
  if (auto result = to_utf8(text, encoding_of(page))) return std::move(*result);
  throw SceneError(file,
                   fmt::format("its names are not in the code page \"{}\" that its header states; "
                               "save it as DXF of 2007 or later, which is in UTF-8",
                               page.empty() ? "ANSI_1252" : page));
}

}  // namespace apothem
