// A checksum over bytes as they come: FNV-1a, 64 bits. A single changed byte always changes it,
// other damage but for one case in 2^64.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace apothem {

class Checksum {
 public:
  void add(const void* data, size_t size) {
    const auto* bytes = static_cast<const unsigned char*>(data);
    for (size_t i = 0; i < size; ++i) value_ = (value_ ^ bytes[i]) * 0x100000001b3U;
  }
  void add(std::string_view text) { add(text.data(), text.size()); }
  /// As "fnv1a64:" and 16 hexadecimal digits.
  [[nodiscard]] std::string text() const;
  bool operator==(const Checksum&) const = default;

 private:
  std::uint64_t value_ = 0xcbf29ce484222325U;
};

}  // namespace apothem
