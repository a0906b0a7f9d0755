// The neighbours of vertices in a list that has several rings, one after the other.
#pragma once

#include <vector>

#include "geometry/polygon/cyclic.hpp"

namespace apothem {

/// For every vertex of a list of several rings: the next one in its ring, and the one before.
struct RingLinks {
  std::vector<int> after, before;

  RingLinks() = default;
  /// Adds a ring of n vertices at the end of the list.
  void add(int n) {
    const int first = static_cast<int>(after.size());
    for (int i = 0; i < n; ++i) {
      after.push_back(first + next(i, n));
      before.push_back(first + previous(i, n));
    }
  }
};

/// The vertex after vertex i, or before it, in a list of n vertices. It is one ring if there are no
/// links.
inline int next(const RingLinks* links, int i, int n) {
  return links ? links->after[static_cast<size_t>(i)] : next(i, n);
}
inline int previous(const RingLinks* links, int i, int n) {
  return links ? links->before[static_cast<size_t>(i)] : previous(i, n);
}

}  // namespace apothem
