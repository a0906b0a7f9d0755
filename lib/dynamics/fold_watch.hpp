// Notices a body with a mesh whose boundary crosses itself, where contact does not look for that.
#pragma once

#include "lib/contact/surface/outline_surfaces.hpp"
#include "lib/dynamics/term.hpp"
#include "lib/model/model.hpp"

namespace apothem {

class FoldWatch final : public Term {
 public:
  /// True if a body may cross itself and does not feel it.
  static bool needed(const Model& model);
  explicit FoldWatch(const Model& model);

  [[nodiscard]] std::string describe() const override {
    return "a look at boundaries that cross themselves";
  }
  /// Throws Unstable where a boundary crosses itself. Nothing to do while no node has moved far.
  void watch(const State& state) override;
  void fields(Archive& archive) override;

 private:
  [[nodiscard]] std::optional<Vec2> crossing(const OutlineSurfaces::Body& body);

  const Model& model_;
  OutlineSurfaces outlines_;
  BoxGrid grid_;
  std::vector<Box> boxes_;
  std::vector<BoxPair> pairs_;
};

}  // namespace apothem
