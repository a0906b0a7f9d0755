// Private header: panels of a figure that show contact potentials over polygons.
#pragma once

#include <string>
#include <vector>

#include "apps/reproduce/text.hpp"
#include "lib/output/potential_figure.hpp"

namespace apothem {

/// A number that a figure states of a potential.
struct PotentialNumber {
  enum class Quantity {
    phi,             ///< at a point
    gradient,        ///< size, in the part of an edge, 1/m
    steepness,       ///< largest size of the gradient over the smallest
    largest,         ///< largest phi
    jump,            ///< largest difference of phi in a border between parts
    parts,           ///< number of parts in which phi is linear
    reference,       ///< reference length r, m
    singular_area,   ///< m^2
    singular_length  ///< of segments, m
  };
  Quantity quantity = Quantity::phi;
  Vec2 at = Vec2::Zero();  ///< of phi, m
  int edge = 0;            ///< of gradient
  std::string label;       ///< what it is in words
  ExpectedNumber expected;
};

/// A polygon with a potential, and the numbers that are stated of it.
struct PotentialShape {
  ShownMap shown;
  std::vector<PotentialNumber> numbers;
};

/// A panel of potentials as its file describes it.
struct PotentialPanelSource {
  std::string title;
  std::vector<PotentialShape> shapes;
};

/// Reads a panel with the key "shapes". Throws SceneError.
PotentialPanelSource read_potential_panel(const JsonReader& in, const JsonValue& value);

/// The panels as a picture.
PotentialFigure potential_figure(const std::string& title,
                                 const std::vector<PotentialPanelSource>& panels);
/// The numbers of all panels beside their references.
std::vector<ReportNumber> potential_numbers(const std::vector<PotentialPanelSource>& panels);

}  // namespace apothem
