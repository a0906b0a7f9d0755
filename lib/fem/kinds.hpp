// The finite-element types and the elastic materials by name, without what computes them
// (element.hpp and material.hpp).
#pragma once

#include <array>
#include <string_view>

namespace apothem {

/// The finite-element types. `tri3`: triangle with constant strain. `quad4`: quadrilateral with one
/// integration point and hourglass stabilisation, which does not lock in bending. `quad4_full`:
/// quadrilateral with 2 x 2 Gauss points, as in the paper. `polygon`: any number of corners.
enum class ElementKind { tri3, quad4, quad4_full, polygon };

/// An element type, the name that the user sees, and the number of its corners.
struct ElementName {
  ElementKind kind;
  std::string_view name;
  int corners;  ///< number of corners; 0 if any number is allowed
};
/// All element types, in the order of ElementKind.
inline constexpr std::array kElements{ElementName{ElementKind::tri3, "T3", 3},
                                      ElementName{ElementKind::quad4, "Q4", 4},
                                      ElementName{ElementKind::quad4_full, "Q4-full", 4},
                                      ElementName{ElementKind::polygon, "polygon", 0}};

/// The elastic laws.
enum class ElasticLaw { st_venant_kirchhoff, neo_hookean };
/// Names of the laws, in the order of ElasticLaw.
inline constexpr std::array kElasticLaws{"st_venant_kirchhoff", "neo_hookean"};

/// Plane stress or plane strain.
enum class Plane { stress, strain };
/// Names of the plane states, in the order of Plane.
inline constexpr std::array kPlanes{"stress", "strain"};

/// An isotropic elastic material. All moduli are in Pa.
struct Elastic {
  ElasticLaw law = ElasticLaw::st_venant_kirchhoff;
  Plane plane = Plane::stress;
  double young = 0;    ///< Young's modulus, Pa
  double poisson = 0;  ///< Poisson's ratio

  /// Shear modulus, Pa.
  [[nodiscard]] double shear() const { return young / (2 * (1 + poisson)); }
  /// Lame's first constant, Pa.
  [[nodiscard]] double lame() const {
    return young * poisson / ((1 + poisson) * (1 - 2 * poisson));
  }
  /// Stress per strain, Pa, if the stress in the plane acts in one direction only (for plane strain
  /// the strain across the plane is zero).
  [[nodiscard]] double uniaxial() const {
    return plane == Plane::stress ? young : young / (1 - poisson * poisson);
  }
  /// Stress per strain in the same direction, Pa, if the other strain in the plane is zero.
  [[nodiscard]] double constrained() const {
    return plane == Plane::stress ? young / (1 - poisson * poisson) : lame() + 2 * shear();
  }
  /// Stress per strain in the perpendicular direction of the plane, Pa.
  [[nodiscard]] double coupled() const {
    return plane == Plane::stress ? young * poisson / (1 - poisson * poisson) : lame();
  }
};

}  // namespace apothem
