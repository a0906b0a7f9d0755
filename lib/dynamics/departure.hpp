// What a body does that finds no equilibrium: it slides, tips over or falls. The static solver asks
// when a body first leaves the neighbourhood of where it was, so that its contacts tell.
#pragma once

#include <span>
#include <string>

#include "lib/contact/law/contact.hpp"
#include "lib/model/model.hpp"
#include "lib/model/state.hpp"

namespace apothem {

/// How a body has moved between two states, as a rigid body.
struct BodyShift {
  Vec2 shift;   ///< of its centre, m
  double turn;  ///< rad
  double size;  ///< distance of its farthest point from its centre, m
  /// An upper bound of the motion of any point, m.
  [[nodiscard]] double most() const { return shift.norm() + size * std::abs(turn); }
};
BodyShift motion_of(const Model& model, const State& state, const State& before, BodyIndex body);

struct Departure {
  std::string words;     ///< as in `"block" slides on "slope", with friction at its limit`
  bool is_lost = false;  ///< whether nothing holds it: it falls, or slides
};
/// `contacts` are those of `state`.
Departure describe_departure(const Model& model, const State& state, const State& before,
                             BodyIndex body, std::span<const ContactRecord> contacts);

}  // namespace apothem
