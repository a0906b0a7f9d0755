// What an element's stress is told by.
#pragma once

namespace apothem {

/// Cauchy stress, Pa, with the one across the plane.
struct CauchyStress {
  double xx = 0, yy = 0, xy = 0, zz = 0;
  double energy_density = 0;  ///< strain energy per reference volume, J/m^3
};

}  // namespace apothem
