#include "lib/text/file.hpp"

#include <cerrno>
#include <iterator>
#include <vector>

#include "lib/system/input_file.hpp"

namespace apothem {

std::ifstream open_text(const std::string& file) {
  const std::string refusal = refusal_of_input(file, kLargestText);
  if (!refusal.empty()) throw SceneError(file, refusal);
  errno = 0;
  std::ifstream stream(file, std::ios::binary);
  if (!stream) {
    throw SceneError(file, cannot_open(file, errno));
  }
  return stream;
}

void strip_byte_order_mark(std::string& text, const std::string& file) {
  if (text.starts_with("\xEF\xBB\xBF")) text.erase(0, 3);
  if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF")) {
    throw SceneError(file, "is UTF-16 text; save it as UTF-8");
  }
}

std::string read_text(const std::string& file, size_t limit) {
  const std::string refusal = refusal_of_input(file, limit);
  if (!refusal.empty()) throw SceneError(file, refusal);
  std::ifstream stream = open_text(file);
  limit = input_limit(limit);
  std::string text;
  std::vector<char> block(1 << 16);
  while (stream.read(block.data(), static_cast<std::streamsize>(block.size())),
         stream.gcount() > 0) {
    text.append(block.data(), static_cast<size_t>(stream.gcount()));
    if (text.size() > limit) {
      throw SceneError(file, too_large(limit));
    }
  }
  if (stream.bad()) throw SceneError(file, "cannot be read");
  strip_byte_order_mark(text, file);
  return text;
}

std::string find_text(const std::string& file) {
  try {
    return read_text(file);
  } catch (const SceneError&) {
    return {};
  }
}

std::string read_bytes(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

}  // namespace apothem
