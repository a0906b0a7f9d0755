// The impulse that velocity Verlet misses in a step with a contact event, which is the begin or end
// of a contact (docs/theory.md, "Contacts that begin or end within a step").
//
// Velocity Verlet sums impulses by the trapezoid rule. Where the force F of a pair of bodies has a
// kink within a step of h, because a vertex enters or leaves the other body, the sum is wrong in
// the order of (omega h)^2 with an arbitrary sign. The missing impulse J follows from the force
// along the straight path of the drift:
//
//   J = h (INT F dtheta - (F0 + F1)/2) + h (D1 - D0)/12,  D = dF/dtheta, 0 <= theta <= 1.
//
// In a smooth step J vanishes except for terms of high order. J preserves the modified energy of
// Verlet, E + h^2/12 v.K v - h^2/24 F.W F with the inverse masses W, to the order h^2. With v the
// velocity of the drift, v + d0 that at the start of the step and v + d1 that at its end, the
// residual is
//
//   R = (d1.d1 - d0.d0)/(2 W) - h (D1.d1 - D0.d0)/6 - h^2/24 (F1.W F1 - F0.W F0)
//       + h^2/12 (d1.K d1 - d0.K d0) - h^4/48 (F1.W K W F1 - F0.W K W F0),
//   d0 = -h W F0/2,  d1 = W (h F1/2 + J),
//
// which an impulse along the mean force compensates. F and D belong to all forces, K to the pair.
// The last two terms make the modified energy exact for one stiff direction, with the stiffness
// along the path K = -D D^T / (h v.D).
#pragma once

#include <array>
#include <cmath>
#include <span>
#include <vector>

namespace apothem {

/// A sample of the force at the fraction `theta` of the drift, with its weights in the mean and in
/// the slopes at the start and at the end of the step.
struct EventSample {
  double theta;
  double mean = 0, start_slope = 0, end_slope = 0;
};

/// The fraction of a step, 0 to 1, at which a height that changes linearly from `h0` to `h1`
/// changes its sign; negative if it does not. A vertex that lies on an edge at the start up to
/// round-off, as where a simulation starts with two bodies that touch, crosses it at the start.
inline double crossing(double h0, double h1) {
  constexpr double kRoundOff = 1e-7;
  if (std::abs(h0) <= kRoundOff * std::abs(h1 - h0)) return h0 == h1 ? -1 : 0;
  return (h0 < 0) == (h1 < 0) ? -1 : h0 / (h0 - h1);
}

/// Boole's rule on a panel of five samples.
inline constexpr std::array kBoole{7. / 90, 32. / 90, 12. / 90, 32. / 90, 7. / 90};

/// Numbers of panels for a part of a step in which the force is smooth, and in which it may bend
/// strongly.
inline constexpr int kFewPanels = 2, kManyPanels = 4;

/// Finds the samples for a force with kinks at the fractions `kinks` of the step, which ascend:
/// Boole's rule with `panels` equal panels between neighbouring kinks, and slopes by differences of
/// order 4 on that side of the nearest kink that has none. The samples of the slopes may lie
/// slightly beyond the step; the others come first, from theta = 0 to 1. Returns the number of the
/// latter.
int find_event_samples(std::span<const double> kinks, int panels,
                       std::vector<EventSample>& samples);

/// The force of a pair on one coordinate in a step.
struct EventForces {
  double first = 0, last = 0;  ///< force at the start and at the end
  double mean = 0;
  double start_slope = 0, end_slope = 0;

  void add(const EventSample& sample, double force) {
    mean += sample.mean * force;
    start_slope += sample.start_slope * force;
    end_slope += sample.end_slope * force;
  }
  /// J / h.
  [[nodiscard]] double missing() const {
    return mean - (first + last) / 2 + (end_slope - start_slope) / 12;
  }
};

/// The forces of everything except the pair on a coordinate, at the start and at the end of the
/// step.
struct OtherForces {
  double first, last;
  /// The part due to friction and damping, including that of the pair. It belongs to no potential.
  double beside_first = 0, beside_last = 0;
};

/// Masses and forces in a step, for every coordinate in the order of a state, rigid bodies first.
struct Dynamics {
  /// 1/kg and 1/(kg m^2); 0 where forces cannot move the coordinate.
  std::span<const double> inverse_mass;
  std::span<const double> before, after;  ///< all forces at the start and at the end, N and N m
  std::span<const double> weight;         ///< weight, in addition to these forces; may be empty
  /// The parts of the forces due to friction and damping, for the first coordinates; the others
  /// have none.
  std::span<const double> beside_before = {}, beside_after = {};

  [[nodiscard]] OtherForces others(size_t coordinate, const EventForces& of_pair) const {
    const double g = weight.empty() ? 0 : weight[coordinate];
    OtherForces f{before[coordinate] - of_pair.first + g, after[coordinate] - of_pair.last + g};
    if (coordinate < beside_after.size()) {
      f.beside_first = beside_before[coordinate], f.beside_last = beside_after[coordinate];
    }
    return f;
  }
  /// The difference, J, between the work of friction and damping in a step of dt along the path of
  /// Verlet's modified energy and their work by the trapezoid rule along the straight path of the
  /// drift.
  [[nodiscard]] double lost_in_bend(double dt) const;
};

/// Contributions to J / h.
struct ImpulseParts {
  double missing;     ///< contribution of the elastic force
  double beside = 0;  ///< contribution of friction and damping, whose work is booked separately
};

/// The residual R and the impulse that removes it, summed over the coordinates.
class EventResidual {
 public:
  explicit EventResidual(double dt) : dt_(dt) {}

  /// Adds a coordinate with the force `f` of the pair on it, its contributions to J / h, the other
  /// forces on it, and the velocity of the drift.
  void add(const EventForces& f, const ImpulseParts& parts, const OtherForces& others,
           double inverse_mass, double velocity);
  /// Adds the coordinates of another body. Summed in this way, the order of two bodies changes no
  /// bit.
  void add(const EventResidual& other);
  /// The residual R, J.
  [[nodiscard]] double energy() const { return energy_ + dt_ * (last_.energy() - first_.energy()); }
  /// The impulse over h that removes the residual, as a multiple of the mean force.
  [[nodiscard]] double correction() const;

 private:
  /// Sums at one end of the step.
  struct End {
    double along = 0;  // D.v, W
    double aside = 0;  // D.d, W
    double pull = 0;   // h D.W F, W

    void add(const End& other);
    [[nodiscard]] double energy() const;
  };

  double dt_;
  double energy_ = 0;  // R without the terms of the stiffness, J
  End first_, last_;
  double mean_ = 0;    // squares of the mean forces over the masses, W/s
  double slopes_ = 0;  // squares of both slopes over the masses, W/s
  double power_ = 0;   // power of the mean force, W
  double gain_ = 0;    // possible change of this power by the forces in a step, W
};

}  // namespace apothem
