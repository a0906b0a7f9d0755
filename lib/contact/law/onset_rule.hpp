// The impulse that velocity Verlet misses in a step in which a contact begins or ends
// (docs/theory.md, "Contacts that begin or end within a step").
//
// Velocity Verlet sums impulses by the trapezoid rule. Where the force F of a pair of bodies has a
// kink within a step of h, because a vertex enters or leaves the other body, the sum is wrong in
// the order of (omega h)^2 with an accidental sign. What is missing follows from the force along
// the straight path of the drift:
//
//   J = h (INT F dtheta - (F0 + F1)/2) + h (D1 - D0)/12,  D = dF/dtheta, 0 <= theta <= 1.
//
// In a smooth step J vanishes but for terms of high order. It keeps the modified energy of Verlet,
// E + h^2/12 v.K v - h^2/24 F.W F with the inverse masses W, to the order h^2. With v the velocity
// of the drift, v + d0 the one at the start of the step, v + d1 at its end, what is left over is
//
//   R = (d1.d1 - d0.d0)/(2 W) - h (D1.d1 - D0.d0)/6 - h^2/24 (F1.W F1 - F0.W F0)
//       + h^2/12 (d1.K d1 - d0.K d0) - h^4/48 (F1.W K W F1 - F0.W K W F0),
//   d0 = -h W F0/2,  d1 = W (h F1/2 + J),
//
// which an impulse along the mean force takes up. F and D are those of all forces, K that of the
// pair. The last two terms make the modified energy exact for one stiff direction: K is taken as -D
// D^T / (h v.D), the stiffness along the path.
#pragma once

#include <array>
#include <cmath>
#include <span>
#include <vector>

namespace apothem {

/// How often the force at `theta` of the drift counts in its mean and in its slopes at the start
/// and at the end of the step.
struct OnsetSample {
  double theta;
  double mean = 0, start_slope = 0, end_slope = 0;
};

/// Where in a step, 0 to 1, a height that is `h0` at its start and `h1` at its end changes its
/// sign; negative if it does not. A vertex that is on an edge at the start but for round-off, as
/// where a run starts with two bodies that touch, crosses it there.
inline double crossing(double h0, double h1) {
  constexpr double kRoundOff = 1e-7;
  if (std::abs(h0) <= kRoundOff * std::abs(h1 - h0)) return h0 == h1 ? -1 : 0;
  return (h0 < 0) == (h1 < 0) ? -1 : h0 / (h0 - h1);
}

/// Boole's rule on a panel of five samples.
inline constexpr std::array kBoole{7. / 90, 32. / 90, 12. / 90, 32. / 90, 7. / 90};

/// Panels of a part of a step in which the force is smooth, and in which it may bend at once.
inline constexpr int kFewPanels = 2, kManyPanels = 4;

/// Finds the samples for kinks at `events`, ascending and within the step: Boole's rule on `panels`
/// equal parts between them, and slopes by differences of order 4 on the side of the nearest event
/// that has no kink. Samples may lie a little beyond the step; the others come first, from theta =
/// 0 to 1. Returns how many these are.
int find_onset_samples(std::span<const double> events, int panels,
                       std::vector<OnsetSample>& samples);

/// The forces of a pair in a step, coordinate by coordinate.
struct OnsetForces {
  double first = 0, last = 0;  ///< at the start and at the end
  double mean = 0;
  double start_slope = 0, end_slope = 0;

  void add(const OnsetSample& sample, double force) {
    mean += sample.mean * force;
    start_slope += sample.start_slope * force;
    end_slope += sample.end_slope * force;
  }
  /// J / h.
  [[nodiscard]] double missing() const {
    return mean - (first + last) / 2 + (end_slope - start_slope) / 12;
  }
};

/// Forces of all but the pair on a coordinate, at the start and at the end of the step.
struct OtherForces {
  double first, last;
  /// What friction and damping do, of these and of the pair: it belongs to no potential.
  double beside_first = 0, beside_last = 0;
};

/// What moves the bodies in a step: of every coordinate in the order of a state, rigid bodies
/// first.
struct Dynamics {
  std::span<const double> inverse_mass;   ///< 1/kg and 1/(kg m^2); 0 where forces cannot move it
  std::span<const double> before, after;  ///< all forces at the start and at the end, N and N m
  std::span<const double> weight;         ///< of gravity, besides these; may be empty
  /// Of the forces of the first coordinates, what friction and damping do; of the others nothing.
  std::span<const double> beside_before = {}, beside_after = {};

  [[nodiscard]] OtherForces others(size_t coordinate, const OnsetForces& of_pair) const {
    const double g = weight.empty() ? 0 : weight[coordinate];
    OtherForces f{before[coordinate] - of_pair.first + g, after[coordinate] - of_pair.last + g};
    if (coordinate < beside_after.size()) {
      f.beside_first = beside_before[coordinate], f.beside_last = beside_after[coordinate];
    }
    return f;
  }
  /// What the work of friction and damping, as the trapezoid rule sums it along the straight path
  /// of the drift, lacks of that along the path of Verlet's modified energy, J, in a step of dt.
  [[nodiscard]] double lost_in_bend(double dt) const;
};

/// Parts of J / h.
struct OnsetParts {
  double missing;     ///< of the elastic force
  double beside = 0;  ///< of friction and damping, whose work is booked by itself
};

/// R and what it takes to remove it, summed over the coordinates.
class OnsetRest {
 public:
  explicit OnsetRest(double dt) : dt_(dt) {}

  /// A coordinate: the force `f` of the pair on it, its parts of J / h, and `others`, which are the
  /// other forces on it at the start and at the end. `velocity` of the drift.
  void add(const OnsetForces& f, const OnsetParts& parts, const OtherForces& others,
           double inverse_mass, double velocity);
  /// The coordinates of another body. In this way the order of two bodies changes no bit.
  void add(const OnsetRest& other);
  /// R, J.
  [[nodiscard]] double energy() const { return energy_ + dt_ * (last_.energy() - first_.energy()); }
  /// The impulse over h along the mean force, as a multiple of it.
  [[nodiscard]] double share() const;

 private:
  /// At one end of the step.
  struct End {
    double along = 0;  // D.v, W
    double aside = 0;  // D.d, W
    double pull = 0;   // h D.W F, W

    void add(const End& other);
    [[nodiscard]] double energy() const;
  };

  double dt_;
  double energy_ = 0;  // R without what follows from the stiffness, J
  End first_, last_;
  double mean_ = 0;    // square of the mean force over the masses, W/s
  double slopes_ = 0;  // squares of both slopes over the masses, W/s
  double power_ = 0;   // of the mean force, W
  double gain_ = 0;    // what the forces may change of this power in a step, W
};

}  // namespace apothem
