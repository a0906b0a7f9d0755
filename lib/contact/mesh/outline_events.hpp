// Contact events of deformable bodies, see event_impulse.hpp. The force of a pair of bodies is the
// set of forces on the vertices of both outlines, all at the same samples.
#pragma once

#include <span>
#include <vector>

#include "lib/archive/archive.hpp"
#include "lib/contact/law/event_detector.hpp"
#include "lib/contact/law/event_impulse.hpp"
#include "lib/contact/law/kinematics.hpp"
#include "lib/contact/mesh/edge_face_blocks.hpp"
#include "lib/contact/mesh/outline_path.hpp"
#include "lib/contact/mesh/outline_slopes.hpp"
#include "lib/contact/mesh/saturated_regions.hpp"
#include "lib/contact/surface/outline_surfaces.hpp"
#include "lib/execution/worker_lists.hpp"

namespace apothem {

class OutlineEvents {
 public:
  /// Both arguments must outlive this object.
  OutlineEvents(const OutlineSurfaces& outlines, const OutlineSlopes& slopes, int threads)
      : outlines_(outlines),
        threads_(threads),
        workers_(static_cast<size_t>(threads_.count()), {{outlines, slopes}, {}, {}}) {}

  /// Finds the missing impulse J of the pairs of bodies with a contact event, at the end of the
  /// drift of a step of dt (s), with half-step velocities. A pair has an event if its vertices
  /// inside each other are not those of the step before, or if much more or less boundary is
  /// inside. `blocks` holds the present contacts, and `candidates` ascend. Returns true if there is
  /// an impulse. With dt = 0, at the start, there is none, and pairs that touch then are new in the
  /// first step. Pairs that reach into saturated regions get no correction.
  bool find(std::span<const EdgeFace> candidates, const EdgeFaceBlocks& blocks,
            const SaturatedRegions& saturated, const Kinematics& now, const Dynamics& dynamics,
            double dt);
  /// Adds J / dt of the last `find`, multiplied by `scale`.
  void add(double scale, const ForceViews& forces) const;

  void fields(Archive& archive) { watch_.fields(archive); }

 private:
  struct ChangedPair {
    BodyIndex a, b;
    int panels;
  };
  /// Memory and results of a thread.
  struct PathWorkspace {
    OutlinePath path;
    std::vector<OutlinePath::Impulse> on_nodes, on_rigid;
  };

  void find_touching(const EdgeFaceBlocks& blocks, const SaturatedRegions& saturated,
                     bool at_first);

  const OutlineSurfaces& outlines_;
  Threads threads_;
  EventDetector watch_;
  WorkerLists<TouchingPair> sequences_;
  std::vector<ChangedPair> changed_;
  std::vector<PathWorkspace> workers_;
};

}  // namespace apothem
