// Private header: arrays of numbers as one block of text, which the page of the player unpacks
// (page/data.js).
//
// The bytes of an array that stand at the same place of their numbers stand together, because such
// bytes are alike and compress well. All arrays together are compressed by zlib and written in
// base64.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace apothem {

/// How an array stands in the block.
struct BlockArray {
  std::string name;
  bool real = false;  ///< 32-bit floating-point numbers; otherwise 32-bit integers
  size_t count = 0;   ///< of numbers
  /// Bytes of a number that are stored, at most 4. Those left out are zero in all of them: the
  /// highest of integers, the lowest of floating-point numbers.
  int planes = 0;
  /// If not 0: an integer is stored as its difference from the one so many places before.
  size_t period = 0;
};

/// Arrays that grow to a block.
class DataBlock {
 public:
  /// Adds integers. They, or their differences, are stored as 0, -1, 1, -2, 2, ... = 0, 1, 2, ...
  void add(std::string name, std::span<const std::int32_t> values, size_t period = 0);
  void add(std::string name, std::span<const float> values);

  [[nodiscard]] const std::vector<BlockArray>& arrays() const { return arrays_; }
  /// Bytes of all arrays before their compression.
  [[nodiscard]] size_t size() const { return bytes_.size(); }
  /// The block as text.
  [[nodiscard]] std::string text() const;

 private:
  void add_plane(std::span<const std::uint32_t> words, int byte);

  std::vector<BlockArray> arrays_;
  std::string bytes_;
};

/// The value with 11 significant binary digits, or fewer where these would be finer than 2^-18 of
/// the largest size of all values, so that the digits of numbers near zero do not fill the block.
/// The error is at most 0.05 % of the value, or 4e-6 of the largest size.
float rounded(double value, double largest);

}  // namespace apothem
