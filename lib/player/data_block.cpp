#include "lib/player/data_block.hpp"

#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <new>

#include "lib/output/html.hpp"

namespace apothem {

void DataBlock::add_plane(std::span<const std::uint32_t> words, int byte) {
  for (const std::uint32_t word : words) bytes_ += static_cast<char>(word >> (8 * byte) & 0xffU);
}

void DataBlock::add(std::string name, std::span<const std::int32_t> values, size_t period) {
  std::vector<std::uint32_t> words(values.size());
  std::uint32_t all = 0;
  for (size_t i = 0; i < values.size(); ++i) {
    const auto value = static_cast<std::uint32_t>(values[i]);
    const bool differs = period > 0 && i >= period;
    const auto change = static_cast<std::int32_t>(
        differs ? value - static_cast<std::uint32_t>(values[i - period]) : value);
    words[i] = static_cast<std::uint32_t>(change) << 1U ^ (change < 0 ? ~0U : 0U);
    all |= words[i];
  }
  const int planes = (std::bit_width(all) + 7) / 8;
  for (int byte = 0; byte < planes; ++byte) add_plane(words, byte);
  arrays_.push_back({std::move(name), false, values.size(), planes, period});
}

void DataBlock::add(std::string name, std::span<const float> values) {
  std::vector<std::uint32_t> words(values.size());
  std::uint32_t all = 0;
  for (size_t i = 0; i < values.size(); ++i) {
    words[i] = std::bit_cast<std::uint32_t>(values[i]);
    all |= words[i];
  }
  const int planes = all == 0 ? 0 : 4 - std::countr_zero(all) / 8;
  for (int plane = 0; plane < planes; ++plane) add_plane(words, 3 - plane);
  arrays_.push_back({std::move(name), true, values.size(), planes, 0});
}

std::string DataBlock::text() const {
  uLongf size = compressBound(bytes_.size());
  std::string packed(size, '\0');
  if (compress2(reinterpret_cast<Bytef*>(packed.data()), &size,
                reinterpret_cast<const Bytef*>(bytes_.data()), bytes_.size(), 6) != Z_OK) {
    throw std::bad_alloc();
  }
  packed.resize(size);
  return base64(packed);
}

float rounded(double value, double largest) {
  if (value == 0 || !(largest > 0)) return 0;
  const int digits = std::max(std::ilogb(value) - 10, std::ilogb(largest) - 17);
  return static_cast<float>(std::ldexp(std::nearbyint(std::ldexp(value, -digits)), digits));
}

}  // namespace apothem
