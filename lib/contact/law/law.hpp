// The contact law of a scene: which potential, how stiff, how rough, how much is damped.
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "geometry/potential/potential.hpp"

namespace apothem {

/// k_t over the normal stiffness of a contact by default: what R. D. Mindlin (J. Appl. Mech. 16
/// (1949), 259) finds for elastic bodies, 2 (1 - nu)/(2 - nu), at nu = 1/3.
inline constexpr double kTangentialShare = 0.8;

struct Friction {
  double coefficient = 0;  ///< mu; 0: none
  /// k_s, Pa: the paper's constant stiffness of a spring, whatever the size of its contact (Eq.
  /// 12). 0: by the ratio.
  double tangential_stiffness = 0;
  /// Stiffness of the spring over the normal stiffness dN/dd of its contact.
  double stiffness_ratio = kTangentialShare;
};

/// Viscous damping of contacts. 0: none.
struct ContactDamping {
  double normal = 0;       ///< ratio of critical damping, or time constant, s
  double tangential = 0;   ///< likewise, beside the friction spring, within Coulomb's limit
  double bulk = 0;         ///< ratio for the strains of bodies with a mesh; of the whole scene
  bool are_times = false;  ///< the first two are time constants: coefficients over stiffnesses
};

/// What acts between two bodies.
struct PairLaw {
  double normal_stiffness = 0;  ///< k_n, Pa
  Friction friction = {};
  ContactDamping damping = {};

  [[nodiscard]] bool rough() const { return friction.coefficient > 0; }
  [[nodiscard]] bool damped() const { return damping.normal > 0 || damping.tangential > 0; }
  /// Stiffness of the springs of boundaries, on which the normal stiffness is spread as well, over
  /// that.
  [[nodiscard]] double spread_ratio() const {
    const double k = friction.tangential_stiffness;
    return k > 0 ? k / normal_stiffness : friction.stiffness_ratio;
  }
  /// Of springs of one stiffness (Eq. 9), Pa.
  [[nodiscard]] double one_stiffness() const { return spread_ratio() * normal_stiffness; }
};

/// resultant: one spring per contact patch (the paper); per_edge: one per edge of the overlap.
enum class FrictionLaw { resultant, per_edge };

/// Whose potential deformable bodies touch with: the body's own near its surface, or that of each
/// of its outermost elements (the paper).
enum class ContactSurface { body, element };

/// How the contact force of deformable bodies becomes nodal forces: as the gradient of the energy;
/// the tractions of each part of the overlap's boundary by the shape functions; or the resultant of
/// a pair of elements by the shape functions at its action point (Eq. 15).
enum class ForceDistribution { variational, integrated, resultant };

/// What is different between two parties, each a body or every body of a material.
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
  Friction friction = {};
  FrictionLaw friction_law = FrictionLaw::resultant;
  ContactSurface surface = ContactSurface::body;
  ForceDistribution distribution = ForceDistribution::variational;
  ContactDamping damping = {};
  std::vector<ContactRule> rules = {};  ///< for pairs; later ones win
  double mass_damping = 0;              ///< alpha of C = alpha M, 1/s; 0: none
  bool self = false;                    ///< bodies with a mesh touch themselves as well
  bool accepts_overlaps = false;        ///< bodies may overlap deeply at the start
  /// Penetration over the inradius of a body above which the run warns.
  double penetration_warning = 0.01;
};

/// Between two bodies, given with their materials: of each part the last rule that fits, or that of
/// the scene.
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

/// The distributions of contact forces a scene can name, each with the one surface it belongs to;
/// the first of a surface is its default.
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
