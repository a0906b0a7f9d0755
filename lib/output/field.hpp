// Fields over the plane, one value per cell or per node, from a frame of a run or from a table.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "apothem/output/frames.hpp"
#include "apothem/output/history.hpp"

namespace apothem {

/// The values from which a quantity is computed: those of a cell or of a node.
struct FieldSample {
  CauchyStress stress = {};                                   ///< of a cell, Pa
  Vec2 displacement = Vec2::Zero(), velocity = Vec2::Zero();  ///< of a node, m and m/s
};

/// A quantity that can be shown as a field.
struct FieldQuantity {
  const char* name;     ///< also the name of the column of tracked points in histories
  const char* meaning;  ///< description in words
  const char* symbol;   ///< symbol in pictures
  const char* unit;
  bool nodal;  ///< whether values belong to nodes, not to cells
  double (*value)(const FieldSample&);
};
/// All quantities.
inline constexpr std::array kFieldQuantities{
    FieldQuantity{"s1", "major principal stress", "σ₁", "Pa", false,
                  [](const FieldSample& s) { return principal_stresses(s.stress)[0]; }},
    FieldQuantity{"s2", "minor principal stress", "σ₂", "Pa", false,
                  [](const FieldSample& s) { return principal_stresses(s.stress)[1]; }},
    FieldQuantity{"sxx", "stress xx", "σxx", "Pa", false,
                  [](const FieldSample& s) { return s.stress.xx; }},
    FieldQuantity{"syy", "stress yy", "σyy", "Pa", false,
                  [](const FieldSample& s) { return s.stress.yy; }},
    FieldQuantity{"sxy", "stress xy", "σxy", "Pa", false,
                  [](const FieldSample& s) { return s.stress.xy; }},
    FieldQuantity{"szz", "stress zz", "σzz", "Pa", false,
                  [](const FieldSample& s) { return s.stress.zz; }},
    FieldQuantity{"von_mises", "von Mises stress", "σᵥ", "Pa", false,
                  [](const FieldSample& s) { return von_mises(s.stress); }},
    FieldQuantity{"ux", "displacement along x", "ux", "m", true,
                  [](const FieldSample& s) { return s.displacement.x(); }},
    FieldQuantity{"uy", "displacement along y", "uy", "m", true,
                  [](const FieldSample& s) { return s.displacement.y(); }},
    FieldQuantity{"u", "displacement", "|u|", "m", true,
                  [](const FieldSample& s) { return s.displacement.norm(); }},
    FieldQuantity{"vx", "velocity along x", "vx", "m/s", true,
                  [](const FieldSample& s) { return s.velocity.x(); }},
    FieldQuantity{"vy", "velocity along y", "vy", "m/s", true,
                  [](const FieldSample& s) { return s.velocity.y(); }},
    FieldQuantity{"v", "speed", "|v|", "m/s", true,
                  [](const FieldSample& s) { return s.velocity.norm(); }}};

/// A field: a mesh with one value per node or per cell.
struct Field {
  Mesh mesh;                   ///< deformed mesh, m
  bool nodal = false;          ///< whether values belong to nodes, not to cells
  std::vector<double> values;  ///< one per node if `nodal`, otherwise one per cell
  std::vector<bool> blank;     ///< one per cell: no value, like the stress of a rigid body
};

/// The field of a quantity in a frame. The first `rigid` bodies of the frame are rigid and have no
/// stress.
Field field_of(const Frame& frame, const FieldQuantity& quantity, int rigid);

/// A table of values in rectangular cells of the same size, one per row.
struct CellTable {
  Vec2 size;                   ///< width and height of a cell, m
  std::vector<Vec2> centres;   ///< m
  std::vector<double> values;  ///< one per cell
};

/// The cells of a table that has the columns x and y (centres of the cells, m) and `column`
/// (values). Throws std::runtime_error if two rows belong to the same cell, or if a cell is 1e9
/// cells or more away from the first one.
CellTable cell_table(const HistoryTable& table, const std::string& column, const Vec2& size);

/// The table as a field with one value per cell.
Field field_of(const CellTable& cells);

/// The deviation of a frame from a table, over the table's largest absolute value.
struct FieldError {
  double rms;      ///< root of the mean square
  double largest;  ///< largest absolute deviation
};
/// Compares the quantity of each cell's mean stress, displacement and velocity with the table. The
/// means are taken over the elements whose centroid lay in the cell before the run, weighted with
/// their areas before the run. The first `rigid` bodies are left out. Throws std::runtime_error if
/// a cell contains no element.
FieldError field_error(const Frame& frame, const FieldQuantity& quantity, int rigid,
                       const CellTable& reference);

}  // namespace apothem
