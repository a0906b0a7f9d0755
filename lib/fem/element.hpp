// From the name of a finite-element type to the struct that computes it. To add a type, write a
// struct with the functions of Tri3 (stored, prepare, force, energy, mean_gradient) and add one
// line to kElements (kinds.hpp) and one to with_element.
#pragma once

#include <utility>

#include "lib/fem/kinds.hpp"
#include "lib/fem/polygon_element.hpp"
#include "lib/fem/quad4.hpp"
#include "lib/fem/tri3.hpp"

namespace apothem {

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
