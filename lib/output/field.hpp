// Values over the plane: of a frame's bodies or of a table, one per cell or per node.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "output/frames.hpp"
#include "output/history.hpp"

namespace apothem {

/// What there is to show: of a cell its stress, of a node how it moved.
struct FieldSample {
  CauchyStress stress = {};
  Vec2 displacement = Vec2::Zero(), velocity = Vec2::Zero();
};

struct FieldQuantity {
  const char* name;     ///< as the columns of points in histories
  const char* meaning;  ///< in words
  const char* symbol;
  const char* unit;
  bool nodal;
  double (*value)(const FieldSample&);
};
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

struct Field {
  Mesh mesh;  ///< where it is now, m
  bool nodal = false;
  std::vector<double> values;  ///< of the nodes if `nodal`, else of the cells
  std::vector<bool> blank;     ///< cells without a value: rigid bodies
};

/// The first `rigid` bodies of the frame are blank.
Field field_of(const Frame& frame, const FieldQuantity& quantity, int rigid);

/// Rectangles of one size, one per row of a table.
struct CellTable {
  Vec2 size;                  ///< m
  std::vector<Vec2> centres;  ///< m
  std::vector<double> values;
};

/// Columns x and y are the centres. Throws std::runtime_error if two rows are of the same cell, or
/// a cell is not within 1e9 cells of the first.
CellTable cell_table(const HistoryTable& table, const std::string& column, const Vec2& size);

Field field_of(const CellTable& cells);

/// How far a frame is from a table, as parts of the table's largest absolute value.
struct FieldError {
  double rms;
  double largest;
};
/// Compared are the values of mean stresses (displacements, velocities): over the elements whose
/// centroid lay in the table's cell before the run, by their area then. Throws std::runtime_error
/// if a cell holds none.
FieldError field_error(const Frame& frame, const FieldQuantity& quantity, int rigid,
                       const CellTable& reference);

}  // namespace apothem
