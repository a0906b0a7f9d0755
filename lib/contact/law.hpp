// The normal contact law of a scene: which potential, how stiff.
#pragma once

#include <array>
#include <string_view>

#include "geometry/potential.hpp"

namespace apothem {

struct ContactLaw {
  PotentialChoice potential;
  double normal_stiffness = 0;  ///< k_n, Pa; there is no default, the scene must say it
};

/// The potentials a scene can name. A new one is one line here and its edge list in geometry.
struct NamedPotential {
  std::string_view name;
  PotentialChoice::Kind kind;
};
inline constexpr std::array kPotentials{
    NamedPotential{"distance", PotentialChoice::Kind::distance},  // Eq. 6
    NamedPotential{"area", PotentialChoice::Kind::area},          // Eq. 2, triangles only
};

/// What measures the depth in a polygon that is not convex; convex ones have one field only.
struct NamedField {
  std::string_view name;
  PotentialChoice::Field field;
};
inline constexpr std::array kFields{
    NamedField{"roof", PotentialChoice::Field::roof},
    NamedField{"distance", PotentialChoice::Field::distance},
};

/// The reference lengths a scene can name (a number is a length in m).
struct NamedReference {
  std::string_view name;
  PotentialChoice::Reference reference;
};
inline constexpr std::array kReferences{
    NamedReference{"roof", PotentialChoice::Reference::roof},
    NamedReference{"inscribed_circle", PotentialChoice::Reference::inscribed_circle},
};

}  // namespace apothem
