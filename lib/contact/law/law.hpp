// The contact law of a scene: potential, stiffness, friction and damping.
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "geometry/potential/potential.hpp"

namespace apothem {

/// The default ratio of the tangential to the normal stiffness of a contact. R. D. Mindlin (J.
/// Appl. Mech. 16 (1949), 259) finds 2 (1 - nu)/(2 - nu) for elastic bodies; this is its value at
/// nu = 1/3.
inline constexpr double kTangentialRatio = 0.8;

struct Friction {
  double coefficient = 0;  ///< mu; 0 means no friction
  /// k_s, Pa: the paper's constant stiffness of a friction spring, independent of the size of its
  /// contact (Eq. 12). With 0 the stiffness follows from the ratio below.
  double tangential_stiffness = 0;
  /// Stiffness of the spring over the normal stiffness dN/dd of its contact.
  double stiffness_ratio = kTangentialRatio;
};

/// Viscous damping of contacts; 0 means none.
struct ContactDamping {
  double normal = 0;  ///< ratio of critical damping, or time constant in s
  /// The same for the dashpot beside the friction spring, within Coulomb's limit.
  double tangential = 0;
  double bulk = 0;  ///< ratio for the strains of bodies with a mesh; one value for the whole scene
  /// True if the first two are time constants, which are coefficients over stiffnesses.
  bool are_times = false;
};

/// The contact law between two bodies.
struct PairLaw {
  double normal_stiffness = 0;  ///< k_n, Pa
  Friction friction = {};
  ContactDamping damping = {};

  [[nodiscard]] bool rough() const { return friction.coefficient > 0; }
  [[nodiscard]] bool damped() const { return damping.normal > 0 || damping.tangential > 0; }
  /// Ratio of the stiffness of friction springs that are spread over a boundary to the normal
  /// stiffness, which is spread over it as well.
  [[nodiscard]] double spread_ratio() const {
    const double k = friction.tangential_stiffness;
    return k > 0 ? k / normal_stiffness : friction.stiffness_ratio;
  }
  /// The stiffness of friction springs that all have the same stiffness (Eq. 9), Pa.
  [[nodiscard]] double one_stiffness() const { return spread_ratio() * normal_stiffness; }
};

/// resultant: one spring per contact patch (the paper); per_edge: one per edge of the overlap.
enum class FrictionLaw { resultant, per_edge };

/// The potential by which deformable bodies touch: that of the body near its surface, or that of
/// each of its outermost elements (the paper).
enum class ContactSurface { body, element };

/// How the contact force on deformable bodies becomes nodal forces: as the gradient of the energy;
/// by distributing the tractions of each boundary segment of the overlap with the shape functions;
/// or by distributing the resultant of a pair of elements with the shape functions at its action
/// point (Eq. 15).
enum class ForceDistribution { variational, integrated, resultant };

/// A contact law that applies only between two parties. A party is one body, or all bodies of a
/// material.
struct ContactRule {
  struct Party {
    bool is_body;
    int index;
  };
  std::array<Party, 2> between;
  std::optional<Friction> friction = {};
  std::optional<ContactDamping> damping = {};
  std::optional<double> normal_stiffness = {};  ///< Pa
};

struct ContactLaw {
  PotentialChoice potential;
  double normal_stiffness = 0;  ///< k_n, Pa; there is no default, the scene must say it
  /// The penetration over the smallest inradius of the scene that k_n follows from, if the scene
  /// gives this in place of k_n.
  std::optional<double> penetration = {};
  Friction friction = {};
  FrictionLaw friction_law = FrictionLaw::resultant;
  ContactSurface surface = ContactSurface::body;
  ForceDistribution distribution = ForceDistribution::variational;
  ContactDamping damping = {};
  std::vector<ContactRule> rules = {};  ///< rules for pairs; later rules override earlier ones
  double mass_damping = 0;              ///< alpha of C = alpha M, 1/s; 0 means none
  bool self = false;                    ///< true if bodies with a mesh may touch themselves
  bool accepts_overlaps = false;        ///< true if bodies may overlap deeply at the start
  /// The run warns if the penetration over the inradius of a body exceeds this value.
  double penetration_warning = 0.01;
};

/// What makes contacts stiffer, as advice to the user: the key that the scene has.
std::string_view stiffening(const ContactLaw& law);

/// The law between two bodies, given with their materials. Each part of it comes from the last rule
/// that applies, or else from the law of the scene.
PairLaw law_between(const ContactLaw& law, int a, int material_a, int b, int material_b);

/// The friction laws a scene can name.
struct NamedFrictionLaw {
  std::string_view name;
  FrictionLaw law;
};
inline constexpr std::array kFrictionLaws{
    NamedFrictionLaw{"resultant", FrictionLaw::resultant},  // Eqs. 10-14
    NamedFrictionLaw{"per_edge", FrictionLaw::per_edge},    // Eq. 9
};

/// The surfaces of deformable bodies a scene can name.
struct NamedSurface {
  std::string_view name;
  ContactSurface surface;
};
inline constexpr std::array kSurfaces{
    NamedSurface{"body", ContactSurface::body},
    NamedSurface{"element", ContactSurface::element},
};

/// The distributions of contact forces that a scene can name, each with the surface that it belongs
/// to. The first one of a surface is its default.
struct NamedDistribution {
  std::string_view name;
  ForceDistribution distribution;
  ContactSurface surface;
};
inline constexpr std::array kDistributions{
    NamedDistribution{"variational", ForceDistribution::variational, ContactSurface::body},
    NamedDistribution{"resultant", ForceDistribution::resultant, ContactSurface::element},
    NamedDistribution{"integrated", ForceDistribution::integrated, ContactSurface::element},
};

}  // namespace apothem
