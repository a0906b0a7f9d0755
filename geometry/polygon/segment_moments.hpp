// The integrals of a potential phi along a segment, summed over the linear pieces of phi, for any
// number type.
#pragma once

#include "lib/execution/pack.hpp"

namespace apothem {

/// Integrals of phi along one segment. The parameter u runs from 0 at its start to 1 at its end.
/// phi has no unit, and neither have its integrals over u.
template <class Real>
struct SegmentMoments {
  Real sum = 0;      ///< integral of phi du
  Real first = 0;    ///< integral of phi u du
  Real largest = 0;  ///< largest phi at an end of a piece

  /// Adds the piece between u1 and u2, on which phi is linear with the end values v1 and v2.
  void add(const Real& u1, const Real& v1, const Real& u2, const Real& v2) {
    add(true, u1, v1, u2, v2);
  }
  /// The same in those lanes of packs that are `there`.
  APOTHEM_INLINE void add(const Truth<Real>& there, const Real& u1, const Real& v1, const Real& u2,
                          const Real& v2) {
    const Real h = u2 - u1;
    sum = select(there, Real(sum + h * (v1 + v2) / 2), sum);
    first = select(there, Real(first + h * (v1 * (2 * u1 + u2) + v2 * (u1 + 2 * u2)) / 6), first);
    const Real larger = select(v1 < v2, v2, v1);
    largest = select(there & (largest < larger), larger, largest);
  }
};

}  // namespace apothem
