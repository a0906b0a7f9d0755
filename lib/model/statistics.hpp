// What is counted and averaged over many bodies: of each body how many it touches and its mean
// stress; of each region how much is in it, how it moves and what it carries.
#pragma once

#include <array>
#include <vector>

#include "lib/contact/law/contact.hpp"
#include "lib/model/model.hpp"
#include "lib/model/state.hpp"

namespace apothem {

/// True if a body counts where free bodies are counted: neither its motion is prescribed, nor does
/// `fix`, or do supports, hold it in both directions.
bool is_free(const Model& model, BodyIndex body);

struct BodyStatistics {
  int coordination = 0;  ///< number of bodies that it touches
  /// Mean stress, Pa, tension positive. Of a rigid body 1/V SUM f (x) l over its contacts, with the
  /// force f on it and the arm l of the contact from its mass centre, the symmetric part (A. E. H.
  /// Love; J. Christoffersen, M. M. Mehrabadi, S. Nemat-Nasser, J. Appl. Mech. 48 (1981) 339-344).
  /// Of a body with a mesh the mean Cauchy stress of its elements, weighted with their areas.
  CauchyStress stress;
};

/// Of all bodies, rigid ones first. `contacts` where the bodies are; `stresses` of all elements.
std::vector<BodyStatistics> body_statistics(const Model& model, const State& state,
                                            const std::vector<ContactRecord>& contacts,
                                            const std::vector<CauchyStress>& stresses);

/// A symmetric tensor of the plane.
struct SymmetricTensor {
  double xx = 0, yy = 0, xy = 0;
};

/// Sums over the free bodies whose mass centre is in a region, and over the contacts with such
/// bodies whose point is in it.
struct RegionSums {
  int count = 0;
  double mass = 0;                ///< kg
  Vec2 momentum = Vec2::Zero();   ///< kg m/s
  double translation = 0;         ///< kinetic energy, J; of a body with a mesh all of it
  double rotation = 0;            ///< kinetic energy, J
  double coordination = 0;        ///< sum over the bodies
  SymmetricTensor stress;         ///< sum of V stress, J
  double solid_area = 0;          ///< of all bodies, as far as it is in the region, m^2
  double volume = 0;              ///< of the region, m^3
  double area = 0;                ///< of the region, m^2
  int contacts = 0;               ///< number of contact patches
  SymmetricTensor fabric;         ///< sum of n (x) n of the contact normals n
  double force = 0, force_2 = 0;  ///< sums of the normal forces, N, and of their squares
  double largest_force = 0;       ///< N
};

/// A quantity of a region. A new one is a line here: it becomes a column REGION.quantity of
/// history.csv. Means over nothing are 0.
struct RegionQuantity {
  const char* name;
  const char* unit;
  double (*value)(const RegionSums&);
  /// It changes at once where a body enters the region or leaves it, or a contact begins or ends.
  bool jumps = true;
};
constexpr double share_of(double part, double whole) { return whole > 0 ? part / whole : 0; }
inline double spread(const RegionSums& s) {
  const double mean = share_of(s.force, s.contacts);
  return std::sqrt(std::max(0., share_of(s.force_2, s.contacts) - mean * mean));
}
inline constexpr std::array kRegionQuantities{
    RegionQuantity{"count", "1", [](const RegionSums& s) { return double(s.count); }},
    RegionQuantity{"mass", "kg", [](const RegionSums& s) { return s.mass; }},
    RegionQuantity{"vx", "m/s",
                   [](const RegionSums& s) { return share_of(1, s.mass) * s.momentum.x(); }},
    RegionQuantity{"vy", "m/s",
                   [](const RegionSums& s) { return share_of(1, s.mass) * s.momentum.y(); }},
    RegionQuantity{"translation", "J",
                   [](const RegionSums& s) { return share_of(s.translation, s.count); }},
    RegionQuantity{"rotation", "J",
                   [](const RegionSums& s) { return share_of(s.rotation, s.count); }},
    RegionQuantity{"solid_fraction", "1", [](const RegionSums& s) { return s.solid_area / s.area; },
                   false},
    RegionQuantity{"coordination", "1",
                   [](const RegionSums& s) { return share_of(s.coordination, s.count); }},
    RegionQuantity{"sxx", "Pa", [](const RegionSums& s) { return s.stress.xx / s.volume; }},
    RegionQuantity{"syy", "Pa", [](const RegionSums& s) { return s.stress.yy / s.volume; }},
    RegionQuantity{"sxy", "Pa", [](const RegionSums& s) { return s.stress.xy / s.volume; }},
    RegionQuantity{"fabric_xx", "1",
                   [](const RegionSums& s) { return share_of(s.fabric.xx, s.contacts); }},
    RegionQuantity{"fabric_yy", "1",
                   [](const RegionSums& s) { return share_of(s.fabric.yy, s.contacts); }},
    RegionQuantity{"fabric_xy", "1",
                   [](const RegionSums& s) { return share_of(s.fabric.xy, s.contacts); }},
    RegionQuantity{"contacts", "1", [](const RegionSums& s) { return double(s.contacts); }},
    RegionQuantity{"force", "N", [](const RegionSums& s) { return share_of(s.force, s.contacts); }},
    RegionQuantity{"force_spread", "N", spread},
    RegionQuantity{"force_max", "N", [](const RegionSums& s) { return s.largest_force; }}};

/// Of every region of the model. `node_mass` in kg; `bodies` from body_statistics. `statics`: in a
/// static run supports are what bears a body, so the stress is that of all bodies with a mesh.
std::vector<RegionSums> region_sums(const Model& model, const State& state,
                                    const std::vector<double>& node_mass,
                                    const std::vector<ContactRecord>& contacts,
                                    const std::vector<BodyStatistics>& bodies,
                                    bool statics = false);

/// How many free bodies there are in a region of the model (-1: anywhere), and their kinetic
/// energy, J. Cheap enough for every few steps.
struct Crowd {
  std::vector<BodyIndex> members;
  double kinetic = 0;
};
Crowd crowd_in(const Model& model, const State& state, const std::vector<double>& node_mass,
               int region);

}  // namespace apothem
