// Contacts of rigid bodies that begin or end within a step: see onset_rule.hpp.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "lib/archive/archive.hpp"
#include "lib/contact/law/onset_damping.hpp"
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
  /// and what only just touches then is new in the first step. `tangential`: null if there is
  /// neither friction nor damping; both are followed along the path of these pairs, as a part of J.
  bool find(const PairIntegrals& pairs, const PatchTangential* tangential, const Kinematics& now,
            const Dynamics& dynamics, double dt);
  /// What friction and damping in the last J take from the bodies, J.
  [[nodiscard]] const PairBook& losses() const { return losses_; }
  /// Adds J / dt of the last `find`, times `scale`, to the forces on rigid bodies.
  void add(double scale, std::span<double> forces) const;

  void fields(Archive& archive) {
    watch_.fields(archive);
    if (table_.damped() || table_.rough()) archive("beside", beside_);
  }

 private:
  /// Force on a, and the moments on a and b about their mass centres, N and N m.
  using Load = std::array<double, 4>;
  struct Impulse {
    int a, b;
    Load mean;    ///< J / dt
    bool beside;  ///< friction and damping are a part of it, these:
    Load friction, damping;
    double damping_loss;  ///< beside the work of that part, J
  };
  using Beside = PatchTangential::Beside;
  /// Where the two polygons of a pair are within a step.
  struct Path;
  /// What a thread needs.
  struct Worker {
    std::vector<double> events;
    std::vector<OnsetSample> samples;
    std::vector<Load> loads;           // of the samples
    std::vector<DampedSample> damped;  // the same, where damping is needed
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
  void find_loads(const Path& path, bool damped, Worker& worker) const;
  void note_beside(const PatchTangential& tangential, const PairInTouch& pair,
                   const PairIntegral& integral, TouchingPair& touching);
  /// At the start and at the end of the step; false if it is not known what acts.
  bool find_beside(const PairChange& pair, Beside& first, Beside& last) const;
  void book_losses(const Kinematics& now, const Dynamics& dynamics, double dt);
  static void find_friction(const PairLaw& law, const Beside& first, const Beside& last,
                            const PathDamping& damping, const Worker& worker, size_t inside,
                            Load& friction, Load& drag);

  const Surfaces& surfaces_;
  const PairTable& table_;
  double thickness_;
  Threads threads_;
  OnsetWatch watch_;
  std::vector<Beside> beside_, beside_before_;  // of the pairs of the watch
  std::vector<PairChange> changed_;
  std::vector<Impulse> impulses_;  // of these
  PairBook losses_;
  // Of each coordinate: the forces of all impulses, and their parts of friction and damping; 0 but
  // while losses are booked.
  std::vector<double> all_, parts_;
  std::vector<Worker> workers_;
};

}  // namespace apothem
