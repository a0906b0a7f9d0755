// Judges at regular steps whether the energy that no term accounts for is small against the energy
// in play. What a run writes, and when, does not change the verdict.
#pragma once

#include "apothem/dynamics/results.hpp"
#include "apothem/model/model.hpp"
#include "apothem/model/state.hpp"

namespace apothem {

class EnergyGuard {
 public:
  /// Steps between two looks. A look costs about as much as a step.
  static constexpr std::int64_t kEvery = 128;

  explicit EnergyGuard(const Model& model);

  /// Takes the energies of a step. True if more than a tenth of the energy in play is unaccounted
  /// for. While energy is only just arriving, as at the start of a load or of a first contact, the
  /// excess must last: the first steps resolve neither the energy nor its error.
  [[nodiscard]] bool exceeded(const Energies& energies);

  /// Largest |total_error| of all looks, J.
  [[nodiscard]] double largest_error() const { return largest_error_; }
  /// Largest energy present, or work done by gravity and from outside, of all looks, J.
  [[nodiscard]] double in_play() const { return in_play_; }

  void fields(Archive& archive) {
    archive("in_play", in_play_)("largest_error", largest_error_)("looks_in_excess",
                                                                  looks_in_excess_);
  }

 private:
  double noise_;                      // energy that round-off alone may move, J
  double in_play_ = 0;                // J
  double largest_error_ = 0;          // J
  std::int64_t looks_in_excess_ = 0;  // in a row, until now
};

}  // namespace apothem
