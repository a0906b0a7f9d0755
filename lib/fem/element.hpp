// The finite-element types by name. To add a type, write a struct with the functions of Tri3
// (stored, prepare, force, energy, mean_gradient) and add one line to kElements and one to
// with_element.
#pragma once

#include <string_view>
#include <utility>

#include "apothem/fem/polygon_element.hpp"
#include "apothem/fem/quad4.hpp"
#include "apothem/fem/tri3.hpp"

namespace apothem {

/// The finite-element types. `tri3`: triangle with constant strain. `quad4`: quadrilateral with one
/// integration point and hourglass stabilisation, which does not lock in bending. `quad4_full`:
/// quadrilateral with 2 x 2 Gauss points, as in the paper. `polygon`: any number of corners.
enum class ElementKind { tri3, quad4, quad4_full, polygon };

/// An element type, the name that the user sees, and the number of its corners.
struct ElementName {
  ElementKind kind;
  std::string_view name;
  int corners;  ///< number of corners; 0 if any number is allowed
};
/// All element types, in the order of ElementKind.
inline constexpr std::array kElements{ElementName{ElementKind::tri3, "T3", 3},
                                      ElementName{ElementKind::quad4, "Q4", 4},
                                      ElementName{ElementKind::quad4_full, "Q4-full", 4},
                                      ElementName{ElementKind::polygon, "polygon", 0}};

/// Calls `f` with a default-constructed object of the struct that implements the element type
/// `kind`, and returns what `f` returns.
template <class F>
decltype(auto) with_element(ElementKind kind, F&& f) {
  switch (kind) {
    case ElementKind::tri3:
      return std::forward<F>(f)(Tri3{});
    case ElementKind::quad4:
      return std::forward<F>(f)(Quad4{});
    case ElementKind::quad4_full:
      return std::forward<F>(f)(Quad4Full{});
    default:
      return std::forward<F>(f)(PolygonElement{});
  }
}

}  // namespace apothem
