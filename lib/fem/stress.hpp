// The stress of an element and its invariants.
#pragma once

#include <array>
#include <cmath>

#include "lib/execution/elementary.hpp"

namespace apothem {

/// Cauchy stress, Pa, in the plane and (`zz`) perpendicular to it.
struct CauchyStress {
  double xx = 0, yy = 0, xy = 0, zz = 0;
  double energy_density = 0;  ///< strain energy per reference volume, J/m^3
};

/// Principal stresses in the plane, Pa: the major (most tensile) one, then the minor one.
inline std::array<double, 2> principal_stresses(const CauchyStress& s) {
  const double middle = (s.xx + s.yy) / 2;
  const double radius = hypotenuse((s.xx - s.yy) / 2, s.xy);
  return {middle + radius, middle - radius};
}

/// Von Mises' equivalent stress, Pa.
inline double von_mises(const CauchyStress& s) {
  const double xy = s.xx - s.yy, yz = s.yy - s.zz, zx = s.zz - s.xx;
  return std::sqrt((xy * xy + yz * yz + zx * zx) / 2 + 3 * s.xy * s.xy);
}

}  // namespace apothem
