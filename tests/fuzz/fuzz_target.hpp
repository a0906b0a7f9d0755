// The fuzzer's target: bytes -> two rings -> everything the geometry can be asked about them.
#pragma once

#include <cstddef>
#include <cstdint>

namespace apothem::test {

/// Throws std::logic_error with the polygons in its message when something does not hold that must.
void fuzz_pair(const std::uint8_t* data, std::size_t size);

}  // namespace apothem::test
