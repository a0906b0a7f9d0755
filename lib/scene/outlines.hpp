// Outlines of bodies, from the shapes of a drawing.
#pragma once

#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "lib/scene/drawing.hpp"
#include "lib/scene/import_report.hpp"

namespace apothem {

/// A drawing that cannot be turned into bodies: the shape, what is wrong with it, and a remedy.
class BadOutline : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct OutlineRules {
  double scale = 1;            ///< m per unit of the drawing
  Vec2 offset = Vec2::Zero();  ///< m, added to the scaled coordinates
  bool polygonize = false;     ///< take the faces between lines
  /// Ends of lines that are closer than this meet, and vertices that follow each other are one, m.
  /// A millionth of the drawing's extent if it is not given.
  std::optional<double> tolerance;
  std::set<std::string> ignored;  ///< layers that are left out
  bool repair = false;            ///< repair outlines, see repair(); simplify by a given tolerance
  bool skip_faults = false;       ///< leave out what is faulty, and count it
  /// An outline directly inside of another one of its layer is a hole of it; one inside of that is
  /// an outline again.
  bool nested_holes = false;
};

struct Outline {
  std::vector<std::vector<Vec2>> rings;  ///< m; the outer one, then holes; not closed by a vertex
  std::string layer, name;               ///< may be empty
  std::string place;                     ///< in the drawing
  std::string entity;                    ///< what the format calls it
};

/// The simple polygons of a drawing. Equal coordinates stay equal to the bit. A line is an outline
/// if its ends meet; with `polygonize` the faces between lines are outlines, and a label inside of
/// a face gives it its layer and name. A hatch over an outline is left out, and so is what the
/// drawing does not show. `report` counts what is read and left out. Throws BadOutline for open
/// lines, rings that are no polygons, outlines that cover each other, entities that
/// cannot be read, and drawings without any outline. With `repair` rings become simple polygons, of
/// which an outline may give several, and with `skip_faults` only a drawing without any outline is
/// refused; `report` lists the faults.
std::vector<Outline> outlines_of(const std::vector<DrawnShape>& shapes, const OutlineRules& rules,
                                 ImportReport& report);

}  // namespace apothem
