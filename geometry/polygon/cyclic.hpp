// Numbers of the vertices and edges of a ring.
#pragma once

namespace apothem {

/// The number after i in a ring of n.
inline int next(int i, int n) { return i + 1 == n ? 0 : i + 1; }

}  // namespace apothem
