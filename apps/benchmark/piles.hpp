// Private header: piles of bodies at rest.
//
// A pile settles in a trough of its own, with strong damping. Larger piles are copies of it side by
// side, so that all sizes are equally deep and equally dense.
#pragma once

#include <vector>

#include "lib/model/model.hpp"
#include "lib/model/settings.hpp"

namespace apothem {

/// Bodies that have come to rest between walls at x = 0 and x = width, on a floor at y = 0.
struct Pile {
  std::vector<RigidBody> bodies;
  std::vector<DeformableBody> deformables;
  double width = 0;   ///< m
  double height = 0;  ///< of the highest point, m
};

/// Area of each block of a pile, m^2.
inline constexpr double kBlockArea = .01;

/// 300 random quadrilaterals, about 20 on top of each other; 100 crosses; 30 squares of 5 x 5 Q4.
const Pile& pile_of_quadrilaterals();
const Pile& pile_of_crosses();
const Pile& pile_of_meshes();

/// So many copies of a pile in troughs side by side, under gravity. The bodies are numbered along a
/// curve, as those of a fill are. Walls are `wall` m high.
Model troughs(const Pile& pile, int copies, double wall);

/// A model with our material, contact law and gravity, and nothing in it.
Model empty_model();
void add_wall(Model& model, double x0, double y0, double x1, double y1);

/// Steps as dense systems of blocks take them.
TimeSettings time_of_piles();

}  // namespace apothem
