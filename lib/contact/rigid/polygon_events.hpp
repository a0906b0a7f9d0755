// Contact events of rigid bodies, see event_impulse.hpp.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "lib/archive/archive.hpp"
#include "lib/contact/law/event_detector.hpp"
#include "lib/contact/law/event_impulse.hpp"
#include "lib/contact/law/pair_table.hpp"
#include "lib/contact/rigid/pair_integrals.hpp"
#include "lib/contact/rigid/patch_tangential.hpp"
#include "lib/execution/parallel.hpp"

namespace apothem {

class PolygonEvents {
 public:
  /// `thickness` is in m. All arguments must outlive this object.
  PolygonEvents(const Surfaces& surfaces, const PairTable& table, double thickness, int threads)
      : surfaces_(surfaces),
        table_(table),
        thickness_(thickness),
        threads_(threads),
        workers_(static_cast<size_t>(threads_.count())) {}

  /// Finds the missing impulse J of the pairs with a contact event, at the end of the drift of a
  /// step of dt (s), with half-step velocities. A pair has an event if its vertices inside each
  /// other are not those of the step before, or if much more or less boundary is inside. Returns
  /// true if there is an impulse. With dt = 0, at the start, there is none, and pairs that only
  /// just touch then are new in the first step. `tangential` is null without friction; otherwise J
  /// includes the friction along the path.
  bool find(const PairIntegrals& pairs, const PatchTangential* tangential, const Kinematics& now,
            const Dynamics& dynamics, double dt);
  /// The energy that the friction in the last impulses takes from the bodies, J.
  [[nodiscard]] double loss() const { return loss_; }
  /// Adds J / dt of the last `find`, multiplied by `scale`, to the forces on rigid bodies.
  void add(double scale, std::span<double> forces) const;

  void fields(Archive& archive) { watch_.fields(archive); }

 private:
  /// Force on a, and the moments on a and b about their mass centres, N and N m.
  using Load = std::array<double, 4>;
  struct Impulse {
    int a, b;
    Load mean;      ///< J / dt
    Load friction;  ///< the part of friction in `mean`
  };
  /// The positions of the two polygons of a pair within a step.
  struct Path;
  /// Memory of a thread.
  struct SampleWorkspace {
    std::vector<double> kinks;
    std::vector<EventSample> samples;
    std::vector<Load> loads;  // loads at the samples
    PlacedShapes::Turned start_a, start_b;
    std::array<PlacedShapes::Turned, 2 * ConvexPairs::kAtOnce> turned;
    std::array<NearEdges, ConvexPairs::kAtOnce> near;
    EdgeWorkspace edges;
  };

  [[nodiscard]] Impulse find_pair(const PairChange& pair, const Kinematics& now,
                                  const Dynamics& dynamics, double dt,
                                  SampleWorkspace& worker) const;
  bool find_kinks(const Path& path, SampleWorkspace& worker) const;
  static void find_crossings(const PlacedPotential& x0, const PlacedPotential& x1,
                             const PlacedPotential& y0, const PlacedPotential& y1,
                             const Vec2& offset0, const Vec2& offset1, std::vector<double>& kinks);
  void find_loads(const Path& path, SampleWorkspace& worker) const;
  /// The missing friction of a pair with one patch, N and N m.
  [[nodiscard]] Load find_friction(const PairChange& pair, const SampleWorkspace& worker,
                                   size_t inside) const;
  void find_friction_loss(const Kinematics& now, const Dynamics& dynamics, double dt);

  const Surfaces& surfaces_;
  const PairTable& table_;
  double thickness_;
  Threads threads_;
  EventDetector watch_;
  const PatchTangential* tangential_ = nullptr;  // argument of the last call of find
  std::vector<PairChange> changed_;
  std::vector<Impulse> impulses_;  // impulses of the changed pairs
  double loss_ = 0;
  // Forces of all impulses on each coordinate, and their parts of friction. Both are 0 except while
  // find_friction_loss works.
  std::vector<double> all_, parts_;
  std::vector<SampleWorkspace> workers_;
};

}  // namespace apothem
