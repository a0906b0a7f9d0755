#include "lib/output/checksum.hpp"

#include <fmt/format.h>

namespace apothem {

std::string Checksum::text() const { return fmt::format("fnv1a64:{:016x}", value_); }

}  // namespace apothem
