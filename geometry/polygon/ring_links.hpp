// The neighbours of vertices in a list that has several rings, one after the other.
#pragma once

#include <vector>

#include "geometry/polygon/cyclic.hpp"

namespace apothem {

/// A list of the vertices of several rings, one ring after the other.
struct RingLinks {
  std::vector<int> after, before;  ///< for every vertex the next one in its ring, the one before
  std::vector<int> starts{0};      ///< the first vertices of the rings, and the end of the list

  /// Adds a ring of n vertices at the end of the list.
  void add(int n) {
    const int first = starts.back();
    for (int i = 0; i < n; ++i) {
      after.push_back(first + next(i, n));
      before.push_back(first + previous(i, n));
    }
    starts.push_back(first + n);
  }
  /// Number of rings.
  [[nodiscard]] int rings() const { return static_cast<int>(starts.size()) - 1; }
};

/// The vertex after vertex i, or before it, in a list of n vertices. It is one ring if there are no
/// links.
inline int next(const RingLinks* links, int i, int n) {
  return links ? links->after[static_cast<size_t>(i)] : next(i, n);
}
inline int previous(const RingLinks* links, int i, int n) {
  return links ? links->before[static_cast<size_t>(i)] : previous(i, n);
}

/// Calls f(first, last) for every ring of a list of n vertices, which consists of the vertices from
/// `first` to `last` - 1.
template <class F>
void for_each_ring(const RingLinks* links, int n, const F& f) {
  if (!links) return f(0, n);
  for (int k = 0; k < links->rings(); ++k) {
    f(links->starts[static_cast<size_t>(k)], links->starts[static_cast<size_t>(k) + 1]);
  }
}

}  // namespace apothem
