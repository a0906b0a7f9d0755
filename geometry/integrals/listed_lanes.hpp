// Masks from bits. This header is private to the integrals.
#pragma once

#include "geometry/integrals/cell_parts.hpp"

namespace apothem::edge_detail {

/// True in lane k if bit k is set, of the four lowest bits.
APOTHEM_INLINE CellPack::Mask listed_lanes(unsigned bits) {
  static constexpr double kListed[16][4] = {
      {-1, -1, -1, -1}, {1, -1, -1, -1}, {-1, 1, -1, -1}, {1, 1, -1, -1},
      {-1, -1, 1, -1},  {1, -1, 1, -1},  {-1, 1, 1, -1},  {1, 1, 1, -1},
      {-1, -1, -1, 1},  {1, -1, -1, 1},  {-1, 1, -1, 1},  {1, 1, -1, 1},
      {-1, -1, 1, 1},   {1, -1, 1, 1},   {-1, 1, 1, 1},   {1, 1, 1, 1}};
  return CellPack::load(kListed[bits & 15]) > CellPack(0.);
}

}  // namespace apothem::edge_detail
