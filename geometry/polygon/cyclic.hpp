// Neighbours in rings and other cyclic lists, in which the first entry follows the last one.
#pragma once

#include <cstddef>

namespace apothem {

/// The number after i, or before it, in a ring of n.
inline int next(int i, int n) { return i + 1 == n ? 0 : i + 1; }
inline int previous(int i, int n) { return i == 0 ? n - 1 : i - 1; }

/// The entry after entry i of a ring, or before it.
template <class Ring>
decltype(auto) after(const Ring& ring, size_t i) {
  return ring[i + 1 == ring.size() ? 0 : i + 1];
}
template <class Ring>
decltype(auto) before(const Ring& ring, size_t i) {
  return ring[i == 0 ? ring.size() - 1 : i - 1];
}

}  // namespace apothem
