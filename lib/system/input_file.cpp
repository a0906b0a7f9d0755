#include "lib/system/input_file.hpp"

#include <sys/stat.h>

#include <cerrno>
#include <charconv>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <string_view>
#include <system_error>

namespace apothem {
namespace {

// Whether the name leads to a descriptor of this process, as /dev/stdin and /dev/fd/63 do.
bool is_own_descriptor(const std::string& file) {
  return file == "/dev/stdin" || file.starts_with("/dev/fd/") || file.starts_with("/proc/self/fd/");
}

std::string refusal_of(const std::string& file, const struct stat& status) {
  if (S_ISDIR(status.st_mode)) return "is a directory; give a file";
  if (S_ISREG(status.st_mode)) return "";
  if (S_ISFIFO(status.st_mode)) {
    if (is_own_descriptor(file)) return "";
    return "is a named pipe, which may never end; write its content to a file, and give that";
  }
  return "is a device or a socket, which may never end; give a file";
}

}  // namespace

std::string refusal_of_input(const std::string& file) {
  return refusal_of_input(file, std::numeric_limits<size_t>::max());
}

std::string refusal_of_input(const std::string& file, size_t limit) {
  struct stat status {};
  if (stat(file.c_str(), &status) != 0) {
    return cannot_open(file, errno);
  }
  std::string refusal = refusal_of(file, status);
  if (!refusal.empty() || limit == std::numeric_limits<size_t>::max()) return refusal;
  limit = input_limit(limit);
  return static_cast<std::uintmax_t>(status.st_size) > limit ? too_large(limit) : "";
}

std::string cannot_open(const std::string& file, int error) {
  if (file == "-") return "is no file; the standard input has the name /dev/stdin";
  const bool forbidden = error == EACCES || error == EPERM;
  return "cannot be opened: " + std::generic_category().message(error) +
         (forbidden ? "; give yourself the right to read it" : "; check the name");
}

size_t input_limit(size_t usual) {
  const char* const text = std::getenv("APOTHEM_INPUT_LIMIT");
  if (text == nullptr) return usual;
  const std::string_view word(text);
  size_t number = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
  const bool is_number = error == std::errc() && end == word.data() + word.size();
  if (!is_number || number > (std::numeric_limits<size_t>::max() >> 21)) return usual;
  return number << 20;
}

std::string too_large(size_t limit) {
  return "is larger than " + std::to_string(limit >> 20) +
         " MiB; give a smaller file, or raise the limit: the environment variable "
         "APOTHEM_INPUT_LIMIT holds a number of MiB";
}

}  // namespace apothem
