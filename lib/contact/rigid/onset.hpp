// Contacts of rigid bodies that begin or end within a step: see onset_rule.hpp.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "lib/archive/archive.hpp"
#include "lib/contact/law/onset_rule.hpp"
#include "lib/contact/law/onset_watch.hpp"
#include "lib/contact/law/pair_table.hpp"
#include "lib/contact/rigid/pair_integrals.hpp"
#include "lib/contact/rigid/patch_tangential.hpp"
#include "lib/execution/parallel.hpp"

namespace apothem {

class Onset {
 public:
  /// `thickness` in m. All must outlive this object.
  Onset(const Surfaces& surfaces, const PairTable& table, double thickness, int threads)
      : surfaces_(surfaces),
        table_(table),
        thickness_(thickness),
        threads_(threads),
        workers_(static_cast<size_t>(threads_.count())) {}

  /// At the end of the drift of a step of dt (s), with the half-step velocities: finds J of the
  /// pairs whose vertices inside each other are not those of the step before, or of which much more
  /// or less boundary is inside. True if there is a J. With dt = 0, at the start, there is none,
  /// and what only just touches then is new in the first step. `tangential`: null if there is no
  /// friction, which is followed along the path of these pairs, as a part of J.
  bool find(const PairIntegrals& pairs, const PatchTangential* tangential, const Kinematics& now,
            const Dynamics& dynamics, double dt);
  /// What friction in the last J takes from the bodies, J.
  [[nodiscard]] double loss() const { return loss_; }
  /// Adds J / dt of the last `find`, times `scale`, to the forces on rigid bodies.
  void add(double scale, std::span<double> forces) const;

  void fields(Archive& archive) { watch_.fields(archive); }

 private:
  /// Force on a, and the moments on a and b about their mass centres, N and N m.
  using Load = std::array<double, 4>;
  struct Impulse {
    int a, b;
    Load mean;      ///< J / dt
    Load friction;  ///< of it
  };
  /// Where the two polygons of a pair are within a step.
  struct Path;
  /// What a thread needs.
  struct Worker {
    std::vector<double> events;
    std::vector<OnsetSample> samples;
    std::vector<Load> loads;  // of the samples
    PlacedShapes::Turned start_a, start_b;
    std::array<PlacedShapes::Turned, 2 * ConvexPairs::kAtOnce> turned;
    std::array<NearEdges, ConvexPairs::kAtOnce> near;
    EdgeWorkspace edges;
  };

  [[nodiscard]] Impulse find_pair(const PairChange& pair, const Kinematics& now,
                                  const Dynamics& dynamics, double dt, Worker& worker) const;
  bool find_events(const Path& path, Worker& worker) const;
  static void find_crossings(const PlacedPotential& x0, const PlacedPotential& x1,
                             const PlacedPotential& y0, const PlacedPotential& y1,
                             const Vec2& offset0, const Vec2& offset1, std::vector<double>& events);
  void find_loads(const Path& path, Worker& worker) const;
  /// Of a pair of one patch, N and N m.
  [[nodiscard]] Load find_friction(const PairChange& pair, const Worker& worker,
                                   size_t inside) const;
  void book_loss(const Kinematics& now, const Dynamics& dynamics, double dt);

  const Surfaces& surfaces_;
  const PairTable& table_;
  double thickness_;
  Threads threads_;
  OnsetWatch watch_;
  const PatchTangential* tangential_ = nullptr;  // of the last call
  std::vector<PairChange> changed_;
  std::vector<Impulse> impulses_;  // of these
  double loss_ = 0;
  // Of each coordinate: the forces of all impulses, and their parts of friction; 0 but while losses
  // are booked.
  std::vector<double> all_, parts_;
  std::vector<Worker> workers_;
};

}  // namespace apothem
