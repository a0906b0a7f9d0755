// What is recorded: the columns of the histories, and the quantities of bodies for histories and
// frames, each of which stands here once.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "lib/model/model.hpp"
#include "lib/model/settings.hpp"
#include "lib/model/state.hpp"

namespace apothem {

/// How a body moves and what acts on it from contacts. A deformable body moves as its mass centre,
/// its mean rotation, its momentum and its angular momentum say.
struct BodyMotion {
  Vec2 place = Vec2::Zero();     ///< of the mass centre, world coordinates, m
  double angle = 0;              ///< rad
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

/// A quantity of a body. A new one is a line here: it becomes a column NAME.quantity of
/// history.csv, and with `in_frames` an array of the cells in the frames.
struct BodyQuantity {
  const char* name;
  const char* unit;
  bool in_frames;
  double (*value)(const BodyMotion&);
};
inline constexpr std::array kBodyQuantities{
    BodyQuantity{"x", "m", false, [](const BodyMotion& b) { return b.place.x(); }},
    BodyQuantity{"y", "m", false, [](const BodyMotion& b) { return b.place.y(); }},
    BodyQuantity{"angle", "rad", false, [](const BodyMotion& b) { return b.angle; }},
    BodyQuantity{"vx", "m/s", false, [](const BodyMotion& b) { return b.velocity.x(); }},
    BodyQuantity{"vy", "m/s", false, [](const BodyMotion& b) { return b.velocity.y(); }},
    BodyQuantity{"spin", "rad/s", false, [](const BodyMotion& b) { return b.spin; }},
    BodyQuantity{"fx", "N", false, [](const BodyMotion& b) { return b.contact.fx; }},
    BodyQuantity{"fy", "N", false, [](const BodyMotion& b) { return b.contact.fy; }},
    BodyQuantity{"friction", "N", true, [](const BodyMotion& b) { return b.contact.friction; }}};

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
    Column{"kinetic", "J"},       Column{"strain", "J"},        Column{"contact", "J"},
    Column{"gravity", "J"},       Column{"friction_loss", "J"}, Column{"damping_loss", "J"},
    Column{"external_work", "J"}, Column{"total_error", "J"}};
inline constexpr std::array kMomentumColumns{
    Column{"px", "kg m/s"},        Column{"py", "kg m/s"},
    Column{"angular", "kg m^2/s"}, Column{"px_error", "kg m/s"},
    Column{"py_error", "kg m/s"},  Column{"angular_error", "kg m^2/s"}};

/// The names of a table of columns.
template <class Columns>
std::vector<std::string> names_of(const Columns& columns) {
  std::vector<std::string> names;
  names.reserve(columns.size());
  for (const auto& column : columns) names.emplace_back(column.name);
  return names;
}

/// A column of history.csv.
struct HistoryColumn {
  std::string name;  ///< as in "beam.ux"
  const char* unit;
  bool jumps = false;  ///< it changes at once, as where a body enters a region
};

/// After the time: rigid bodies, deformable ones, surfaces, points, regions.
std::vector<HistoryColumn> history_columns(const Model& model, const OutputSettings& settings);

}  // namespace apothem
