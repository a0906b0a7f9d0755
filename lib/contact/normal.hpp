// Normal contact of rigid bodies: the edge kernel on all candidate pairs.
#pragma once

#include <vector>

#include "apothem/contact/placed_shapes.hpp"
#include "apothem/geometry/spatial/boxes.hpp"

namespace apothem {

class NormalContact {
 public:
  explicit NormalContact(int threads) : workspaces_(threads) {}

  /// Evaluates all pairs (positions: x, y, angle per body). The result of a pair depends on that
  /// pair alone, so it has the same bits for any number of threads.
  void evaluate(const PlacedShapes& shapes, const std::vector<double>& position,
                const std::vector<BoxPair>& pairs);

  /// Energy of all pairs for unit stiffness and thickness, m^2. Not for every step.
  [[nodiscard]] double energy(const PlacedShapes& shapes, const std::vector<double>& position,
                              const std::vector<BoxPair>& pairs) const;

  /// One entry per pair, for unit stiffness; force on the first body, moments about mass centres.
  [[nodiscard]] const std::vector<PairIntegral>& integrals() const { return integrals_; }

  [[nodiscard]] int threads() const { return static_cast<int>(workspaces_.size()); }

 private:
  std::vector<EdgeWorkspace> workspaces_;
  std::vector<PairIntegral> integrals_;
};

}  // namespace apothem
