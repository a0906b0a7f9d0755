// Contacts of rigid bodies that begin or end within a step: see onset_rule.hpp.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "apothem/archive/archive.hpp"
#include "apothem/contact/onset_rule.hpp"
#include "apothem/contact/onset_watch.hpp"
#include "apothem/contact/pair_integrals.hpp"
#include "apothem/contact/pair_table.hpp"

namespace apothem {

class Onset {
 public:
  /// `thickness` in m. All must outlive this object.
  Onset(const Surfaces& surfaces, const PairTable& table, double thickness)
      : surfaces_(surfaces), table_(table), thickness_(thickness) {}

  /// At the end of the drift of a step of dt (s), with the half-step velocities: finds J of the
  /// pairs whose vertices inside each other are not those of the step before, or of which much more
  /// or less boundary is inside. True if there is a J. With dt = 0, at the start, there is none,
  /// and what only just touches then is new in the first step.
  bool find(const PairIntegrals& pairs, const Kinematics& now, const Dynamics& dynamics, double dt);
  /// Adds J / dt of the last `find`, times `scale`, to the forces on rigid bodies.
  void add(double scale, std::span<double> forces) const;

  void fields(Archive& archive) { watch_.fields(archive); }

 private:
  struct Impulse {
    int a, b;
    std::array<double, 4> mean;  ///< J / dt, as `load`
  };
  /// Where the two polygons of a pair are within a step.
  struct Path;

  void find_pair(RigidIndex a, RigidIndex b, int panels, const Kinematics& now,
                 const Dynamics& dynamics, double dt);
  void find_events(const Path& path);
  void find_crossings(const PlacedPotential& x0, const PlacedPotential& x1,
                      const PlacedPotential& y0, const PlacedPotential& y1, const Vec2& offset0,
                      const Vec2& offset1);
  /// Force on a, and the moments on a and b about their mass centres.
  std::array<double, 4> load(const Path& path, double theta);

  const Surfaces& surfaces_;
  const PairTable& table_;
  double thickness_;
  OnsetWatch watch_;
  std::vector<Impulse> impulses_;
  // Memory.
  std::vector<double> events_;
  std::vector<OnsetSample> samples_;
  PlacedShapes::Turned turned_a_, turned_b_, start_a_, start_b_;
  EdgeWorkspace workspace_;
};

}  // namespace apothem
