// The elements by name. A new one is a struct like Tri3 (prepare, force, energy, mean_gradient),
// a line in kElements and one in with_element.
#pragma once

#include <string_view>
#include <utility>

#include "fem/polygon_element.hpp"
#include "fem/quad4.hpp"
#include "fem/tri3.hpp"

namespace apothem {

enum class ElementKind { tri3, quad4, quad4_full, polygon };

struct ElementName {
  ElementKind kind;
  std::string_view name;
  int corners;  ///< 0: any
};
inline constexpr std::array kElements{ElementName{ElementKind::tri3, "T3", 3},
                                      ElementName{ElementKind::quad4, "Q4", 4},
                                      ElementName{ElementKind::quad4_full, "Q4-full", 4},
                                      ElementName{ElementKind::polygon, "polygon", 0}};

/// Calls f with an object of the element's struct.
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
