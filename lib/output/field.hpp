// Fields over the plane, one value per cell or per node, from a frame of a run or from a table.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "lib/output/history.hpp"
#include "lib/output/run_folder.hpp"

namespace apothem {

/// The values from which a quantity is computed: those of an element, a node or a body.
struct FieldSample {
  CauchyStress stress = {};  ///< of an element, or mean of a body, Pa
  Vec2 displacement = Vec2::Zero(), velocity = Vec2::Zero();  ///< of a node, m and m/s
  const FrameBody* body = nullptr;                            ///< of an element
  int material = 0;                                           ///< of an element
};

/// What has one value of a quantity each: nodes; elements and, where all bodies are rigid, bodies;
/// elements only; bodies. A category is a number of an element that is a name, not a size.
enum class FieldKind { node, stress, stress_of_elements, body, category };

/// A quantity that can be shown as a field.
struct FieldQuantity {
  const char* name;     ///< also the name of the column of tracked points in histories
  const char* meaning;  ///< description in words
  const char* symbol;   ///< symbol in pictures
  const char* unit;     ///< empty for a plain number
  FieldKind kind;
  std::function<double(const FieldSample&)> value;
};
/// All quantities: those of nodes, those of kBodyQuantities that pictures show, and the others.
const std::vector<FieldQuantity>& field_quantities();

/// The quantity of that name, or null.
const FieldQuantity* field_quantity(const std::string& name);

/// A field: a mesh with one value per node or per cell.
struct Field {
  Mesh mesh;                   ///< deformed mesh, m
  bool nodal = false;          ///< whether values belong to nodes, not to cells
  std::vector<double> values;  ///< one per node if `nodal`, otherwise one per cell
  std::vector<bool> blank;     ///< one per cell: no value, like the stress of a rigid body
  /// Of the values 0, 1 and so on of a category; empty: the values are numbers.
  std::vector<std::string> names = {};
  ElementHoles holes = {};  ///< of cells
};

/// Whether a body has values of that kind in a scene where, if `rigid_only`, no body is of finite
/// elements. Bodies that are fixed have none, except of a category; and rigid bodies have no
/// stress, unless all bodies are rigid: then each has its mean stress.
bool has_value(const FrameBody& body, FieldKind kind, bool rigid_only);

/// The field of a quantity in a frame. What has no value is blank.
Field field_of(const Frame& frame, const FieldQuantity& quantity);

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
/// their areas before the run. Rigid bodies are left out. Throws std::runtime_error if a cell
/// contains no element.
FieldError field_error(const Frame& frame, const FieldQuantity& quantity,
                       const CellTable& reference);

}  // namespace apothem
