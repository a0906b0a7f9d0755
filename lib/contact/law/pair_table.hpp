// The contact law between any two bodies of a scene.
#pragma once

#include <cmath>
#include <vector>

#include "lib/contact/law/law.hpp"
#include "lib/mesh/indices.hpp"

namespace apothem {

class PairTable {
 public:
  /// `material` has the material of each body; `materials` is the number of materials. Bodies of
  /// one material share a row, unless a rule names them.
  PairTable(const ContactLaw& law, const std::vector<MaterialIndex>& material, int materials);

  [[nodiscard]] const PairLaw& between(BodyIndex a, BodyIndex b) const {
    return table_[static_cast<size_t>(kind_[a]) * kinds_ + kind_[b]];
  }
  /// Bodies of one kind have the same law with every other body.
  [[nodiscard]] int kind(BodyIndex body) const { return kind_[body]; }
  /// True if bodies with a mesh touch themselves as well.
  [[nodiscard]] bool self() const { return self_; }
  /// True if there is friction between any two bodies.
  [[nodiscard]] bool rough() const { return rough_; }
  /// True if there is viscous damping between any two bodies.
  [[nodiscard]] bool damped() const { return damped_; }
  /// The largest and the smallest normal stiffness between any two bodies, Pa.
  [[nodiscard]] double stiffest() const { return stiffest_; }
  [[nodiscard]] double softest() const { return softest_; }
  /// The largest constant stiffness of friction springs between any two bodies with friction, Pa,
  /// and the largest ratio of the other ones to the normal stiffness; 0 if there are none.
  [[nodiscard]] const Friction& stiffest_friction() const { return stiffest_friction_; }

 private:
  std::vector<int> kind_;  // kind of each body
  size_t kinds_ = 0;
  std::vector<PairLaw> table_;  // law between the kinds p and q at the index p kinds_ + q
  bool self_, rough_ = false, damped_ = false;
  double stiffest_ = 0, softest_ = HUGE_VAL;
  Friction stiffest_friction_{0, 0, 0};
};

}  // namespace apothem
