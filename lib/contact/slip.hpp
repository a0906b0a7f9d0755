// What friction of deformable bodies remembers, whatever it is a spring of.
#pragma once

#include <utility>
#include <vector>

#include "apothem/contact/law.hpp"

namespace apothem {

/// The spring of two partners in contact, a pair of numbers that says which.
/// DeformableFriction: an edge on another body; edges of rigid bodies are long: they have one per
/// face of the deformable body, which the face takes with it. ElementFriction: two polygons.
struct EdgeSlip {
  int edge;       ///< or the first polygon
  int partner;    ///< the other body, for edges of rigid bodies the face; or the second polygon
  double spring;  ///< friction force along the face, N; or on the first polygon, along tangent_of
  double stiffness;  ///< N/m

  [[nodiscard]] std::pair<int, int> key() const { return {edge, partner}; }
  [[nodiscard]] double energy() const {
    return stiffness > 0 ? spring * spring / (2 * stiffness) : 0;
  }
};

/// Everything that friction carries from one step to the next.
struct SlipMemory {
  std::vector<EdgeSlip> slips;  ///< ascending by edge and partner
  double energy = 0;            ///< of the springs, J
  double friction_loss = 0;     ///< J since time 0
};

/// The friction between any two bodies of a contact.
class FrictionTable {
 public:
  /// Bodies, in the order of the contact, belong to one of `kinds` kinds; `table` has the friction
  /// between kinds p and q at p kinds + q, and is symmetric.
  FrictionTable(std::vector<int> kind, int kinds, std::vector<Friction> table)
      : kind_(std::move(kind)), kinds_(kinds), table_(std::move(table)) {}

  [[nodiscard]] const Friction& between(int a, int b) const {
    return table_[static_cast<size_t>(kind_[a]) * kinds_ + kind_[b]];
  }

 private:
  std::vector<int> kind_;
  int kinds_;
  std::vector<Friction> table_;
};

}  // namespace apothem
