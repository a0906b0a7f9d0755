// The quantities of bodies, which histories, frames and pictures show, and the columns of
// histories. Those of regions are in statistics.hpp.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "lib/model/model.hpp"
#include "lib/model/settings.hpp"
#include "lib/model/state.hpp"
#include "lib/model/statistics.hpp"

namespace apothem {

/// How a body moves and what acts on it from contacts. A deformable body moves as its mass centre,
/// its mean rotation, its momentum and its angular momentum say.
struct BodyMotion {
  Vec2 place = Vec2::Zero();     ///< of the mass centre, world coordinates, m
  double angle = 0;              ///< rad
  double rotation = 0;           ///< since the start, rad
  Vec2 velocity = Vec2::Zero();  ///< m/s
  double spin = 0;               ///< rad/s
  BodyForce contact;
};

/// `contact`: what acts on the body (only the friction is needed of a rigid one); `node_mass` of
/// all nodes, kg.
BodyMotion motion_of(const Model& model, const State& state, BodyIndex body,
                     const BodyForce& contact, const std::vector<double>& node_mass);

/// Looks how far the bodies with a mesh have turned. The angle of motion_of() is right as long as
/// no body turns by half a turn more or less than its spin says between two looks.
void note_turns(const Model& model, const std::vector<double>& node_mass, State& state);

/// What is known of a body at a moment.
struct ObservedBody {
  BodyMotion motion;
  BodyStatistics statistics;
};

/// A number, which stands first, the components x and y of a vector, or xx, yy and xy of a tensor.
using Components = std::array<double, 3>;

/// A quantity of a body. A new one is a line here.
struct BodyQuantity {
  enum class Kind { number, count, vector, tensor };
  enum class Shown { in_histories, in_frames, in_both };

  const char* name;
  const char* unit;
  Kind kind;
  Shown shown;
  Components (*value)(const ObservedBody&);
  /// Description in words and symbol, for pictures and the player, which show the numbers and
  /// counts of frames that have these.
  const char* meaning = nullptr;
  const char* symbol = nullptr;

  /// It is a column NAME.quantity of history.csv, as a number or a count only.
  [[nodiscard]] constexpr bool in_histories() const { return shown != Shown::in_frames; }
  /// It is an array of the cells in frames.
  [[nodiscard]] constexpr bool in_frames() const { return shown != Shown::in_histories; }
  [[nodiscard]] constexpr int components() const {
    return kind == Kind::number || kind == Kind::count ? 1 : 3;
  }
  [[nodiscard]] constexpr bool in_pictures() const { return in_frames() && meaning; }
};
namespace body_quantities {
using enum BodyQuantity::Kind;
using enum BodyQuantity::Shown;
using Body = ObservedBody;
inline constexpr std::array kBodyQuantities{
    BodyQuantity{"x", "m", number, in_histories,
                 [](const Body& b) { return Components{b.motion.place.x()}; }},
    BodyQuantity{"y", "m", number, in_histories,
                 [](const Body& b) { return Components{b.motion.place.y()}; }},
    BodyQuantity{"angle", "rad", number, in_histories,
                 [](const Body& b) { return Components{b.motion.angle}; }},
    BodyQuantity{"rotation", "rad", number, in_frames,
                 [](const Body& b) { return Components{b.motion.rotation}; },
                 "rotation since the start", "θ"},
    BodyQuantity{"vx", "m/s", number, in_histories,
                 [](const Body& b) { return Components{b.motion.velocity.x()}; }},
    BodyQuantity{"vy", "m/s", number, in_histories,
                 [](const Body& b) { return Components{b.motion.velocity.y()}; }},
    BodyQuantity{"spin", "rad/s", number, in_both,
                 [](const Body& b) { return Components{b.motion.spin}; }, "angular velocity", "ω"},
    BodyQuantity{"fx", "N", number, in_histories,
                 [](const Body& b) { return Components{b.motion.contact.fx}; }},
    BodyQuantity{"fy", "N", number, in_histories,
                 [](const Body& b) { return Components{b.motion.contact.fy}; }},
    BodyQuantity{"contact_force", "N", vector, in_frames,
                 [](const Body& b) {
                   return Components{b.motion.contact.fx, b.motion.contact.fy};
                 }},
    BodyQuantity{"coordination", "1", count, in_both,
                 [](const Body& b) { return Components{1. * b.statistics.coordination}; },
                 "number of bodies in contact with a body", "Z"},
    BodyQuantity{"mean_stress", "Pa", tensor, in_frames,
                 [](const Body& b) {
                   const CauchyStress& s = b.statistics.stress;
                   return Components{s.xx, s.yy, s.xy};
                 }},
    BodyQuantity{"friction", "N", number, in_both,
                 [](const Body& b) { return Components{b.motion.contact.friction}; }}};
}  // namespace body_quantities
using body_quantities::kBodyQuantities;

/// The place of the quantity of that name in kBodyQuantities.
consteval size_t body_quantity(std::string_view name) {
  size_t place = 0;
  while (kBodyQuantities[place].name != name) ++place;
  return place;
}

/// A column of a history file: name and unit.
struct Column {
  const char* name;
  const char* unit;
};
/// Columns of a tracked point of a deformable body.
inline constexpr std::array kPointColumns{
    Column{"ux", "m"},   Column{"uy", "m"},   Column{"vx", "m/s"},
    Column{"vy", "m/s"}, Column{"sxx", "Pa"}, Column{"syy", "Pa"},
    Column{"sxy", "Pa"}, Column{"s1", "Pa"},  Column{"s2", "Pa"}};
/// Columns of the contact of a deformable body.
inline constexpr std::array kSurfaceColumns{Column{"pressure", "Pa"}, Column{"half_width", "m"}};
/// Columns of the ledgers, energy.csv and momentum.csv, after the time.
inline constexpr std::array kEnergyColumns{
    Column{"kinetic", "J"},        Column{"strain", "J"},        Column{"contact", "J"},
    Column{"gravity", "J"},        Column{"friction_loss", "J"}, Column{"damping_loss", "J"},
    Column{"numerical_loss", "J"}, Column{"external_work", "J"}, Column{"total_error", "J"}};
inline constexpr std::array kMomentumColumns{
    Column{"px", "kg m/s"},        Column{"py", "kg m/s"},
    Column{"angular", "kg m^2/s"}, Column{"px_error", "kg m/s"},
    Column{"py_error", "kg m/s"},  Column{"angular_error", "kg m^2/s"}};

/// A column of history.csv.
struct HistoryColumn {
  std::string name;  ///< as in "beam.ux"
  const char* unit;
  bool jumps = false;  ///< it changes at once, as where a body enters a region
};

/// After the time: rigid bodies, deformable ones, surfaces, points, regions.
std::vector<HistoryColumn> history_columns(const Model& model, const OutputSettings& settings);

}  // namespace apothem
