// Judges whether a run makes energy: whether the energy that no term accounts for is small against
// the energy in play, and whether losses, which nothing gives back, only grow. What a run writes,
// and when, does not change the verdict.
//
// The energy of contacts and elements costs two to ten steps, so it is looked at from time to time:
// at regular steps, and more often while bodies touch, as far as that costs little beside the steps
// so far. In a collision of few bodies this is nearly every step. Losses are known in every step.
#pragma once

#include <cstdint>

#include "lib/dynamics/results.hpp"
#include "lib/model/model.hpp"
#include "lib/model/state.hpp"

namespace apothem {

class EnergyGuard {
 public:
  /// Steps between two looks, at most.
  static constexpr std::int64_t kEvery = 128;
  /// Steps that an excess must last: the error of a contact that is passing, which the step
  /// integrates too coarsely, is gone with it.
  static constexpr std::int64_t kLasting = 8;
  /// The same while energy is only just arriving, as at the start of a load or of a first contact:
  /// the first steps resolve neither the energy nor its error.
  static constexpr std::int64_t kArrival = 3 * kEvery;

  enum class Verdict : unsigned char { good, unaccounted, friction, damping, numerical };

  explicit EnergyGuard(const Model& model);

  /// Before the first step, with the energies then.
  void start(const Energies& energies);
  /// After each step: `losses` holds those of friction and damping so far, `touching` pairs touch
  /// now. True if energies have to be looked at.
  [[nodiscard]] bool due(std::int64_t step, const Energies& losses, std::int64_t touching);
  /// Takes the energies of a step, after `due`. Not good if more than a tenth of the energy in play
  /// is unaccounted for, or losses have fallen too far, and that lasts. `last`: the run ends here.
  [[nodiscard]] Verdict judge(std::int64_t step, const Energies& energies, bool last = false);
  /// Takes energies that are recorded: the largest error is no smaller than any that is written.
  void record(const Energies& energies);

  /// Largest |total_error| of all looks and records, J.
  [[nodiscard]] double largest_error() const { return largest_error_; }
  /// Largest energy present, or work done by gravity and from outside, of all looks, J.
  [[nodiscard]] double in_play() const { return in_play_; }
  /// What of it may be unaccounted for, J.
  [[nodiscard]] double allowed() const;
  /// How far the losses are below their largest values so far, J.
  [[nodiscard]] double friction_fall() const { return friction_.fall; }
  [[nodiscard]] double damping_fall() const { return damping_.fall; }
  [[nodiscard]] double numerical_fall() const { return numerical_.fall; }

  void fields(Archive& archive) {
    archive("in_play", in_play_)("in_play_before", before_)("in_play_lately", lately_)(
        "largest_error", largest_error_)("excess_since", excess_since_)("credit", credit_);
    archive("friction", friction_)("damping", damping_)("numerical", numerical_);
  }

 private:
  // What has been dissipated, also by implicit steps, J.
  struct Loss {
    double largest = 0;
    double fall = 0;  // from there
    void follow(double loss);
    void fields(Archive& archive) { archive("largest", largest)("fall", fall); }
  };
  [[nodiscard]] Verdict excess(double error) const;
  [[nodiscard]] bool arriving() const;

  double noise_;                    // energy that round-off alone may move, J
  std::int64_t coordinates_;        // of the model
  double in_play_ = 0;              // J
  double lately_ = 0;               // the same at the last regular look
  double before_ = 0;               // the same one look earlier, or now at a regular one
  double largest_error_ = 0;        // J
  std::int64_t excess_since_ = -1;  // step of the first look with it, or -1
  std::int64_t credit_ = 0;         // of work: see due()
  Loss friction_, damping_, numerical_;
};

}  // namespace apothem
