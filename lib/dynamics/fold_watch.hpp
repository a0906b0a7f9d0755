// Notices a body with a mesh whose boundary crosses itself, where no contact does so: contact of a
// body with itself is not supported yet.
#pragma once

#include "apothem/contact/outlines.hpp"
#include "apothem/dynamics/term.hpp"
#include "apothem/model/model.hpp"

namespace apothem {

class FoldWatch final : public Term {
 public:
  /// True if contact itself does not notice.
  static bool needed(const Model& model);
  explicit FoldWatch(const Model& model);

  [[nodiscard]] std::string describe() const override {
    return "a look at boundaries that cross themselves";
  }
  /// Throws Unstable where a boundary crosses itself. Nothing to do while no node has moved far.
  void watch(const State& state) override;

 private:
  const Model& model_;
  Outlines outlines_;
};

/// Throws Unstable: a body touches itself at a place.
[[noreturn]] void refuse_fold(const Model& model, const State& state, BodyIndex body,
                              const Vec2& place);

}  // namespace apothem
