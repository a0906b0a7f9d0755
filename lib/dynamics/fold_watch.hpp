// Notices a body with a mesh whose boundary crosses itself, where no contact does so: contact of a
// body with itself is not computed.
#pragma once

#include "apothem/contact/deformable_contact.hpp"
#include "apothem/model/model.hpp"
#include "apothem/model/state.hpp"

namespace apothem {

class FoldWatch {
 public:
  explicit FoldWatch(const Model& model);

  /// True if contact itself does not notice.
  static bool needed(const Model& model);

  /// Throws Unstable where a boundary crosses itself. Nothing to do while no node has moved far.
  void look(const State& state);

 private:
  const Model& model_;
  DeformableContact outlines_;
};

/// Throws Unstable if there is such a place in one of the bodies.
void refuse_fold(const Model& model, const State& state, int body, const Vec2& place);

}  // namespace apothem
