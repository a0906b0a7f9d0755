// The friction between any two bodies of a scene.
#pragma once

#include <vector>

#include "apothem/contact/law.hpp"
#include "apothem/mesh/indices.hpp"

namespace apothem {

class FrictionTable {
 public:
  /// `material` of each body, `materials` how many there are. Bodies of one material share a row,
  /// unless a rule names them.
  FrictionTable(const ContactLaw& law, const std::vector<MaterialIndex>& material, int materials);

  [[nodiscard]] const Friction& between(BodyIndex a, BodyIndex b) const {
    return table_[static_cast<size_t>(kind_[a]) * kinds_ + kind_[b]];
  }
  /// True if there is friction between any two bodies.
  [[nodiscard]] bool rough() const { return rough_; }

 private:
  std::vector<int> kind_;  // of each body
  size_t kinds_ = 0;
  std::vector<Friction> table_;  // between kinds p and q at p kinds_ + q
  bool rough_ = false;
};

}  // namespace apothem
