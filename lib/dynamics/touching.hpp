// Pairs of bodies whose outlines touch.
#pragma once

#include <vector>

#include "lib/model/model.hpp"
#include "lib/model/state.hpp"

namespace apothem {

/// Two bodies, a < b.
struct TouchingBodies {
  BodyIndex a, b;
};

/// The pairs of bodies, of which one can move, whose outlines are no farther apart than kTouching
/// times the smaller inradius, in ascending order. Bodies that overlap are among them.
std::vector<TouchingBodies> touching_bodies(const Model& model, const State& state);

inline constexpr double kTouching = 1e-6;

}  // namespace apothem
