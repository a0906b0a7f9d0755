// Friction between outlines, and their dashpots (docs/theory.md, Friction and damping). For every
// edge and every body that it touches there is a spring across the common normal of its
// neighbourhood (common_normals.hpp), which obeys Coulomb's limit, and dashpots beside it and along
// this normal. They act on the edge and on the feet of its points on the faces, where the pressure
// is.
#pragma once

#include <span>
#include <vector>

#include "lib/contact/law/dashpots.hpp"
#include "lib/contact/law/friction_memory.hpp"
#include "lib/contact/law/kinematics.hpp"
#include "lib/contact/law/pair_table.hpp"
#include "lib/contact/mesh/common_normals.hpp"
#include "lib/contact/mesh/edge_face_blocks.hpp"
#include "lib/contact/mesh/outline_slip.hpp"
#include "lib/contact/surface/surfaces.hpp"
#include "lib/execution/parallel.hpp"

namespace apothem {

class OutlineFriction {
 public:
  /// Both must outlive this object.
  OutlineFriction(const Surfaces& surfaces, const PairTable& table, int threads);

  /// After a search: so many pairs of bodies may touch.
  void take(size_t pairs) {
    pairs_.resize(pairs);
    everywhere_ = kBothVectors;
  }

  /// One step further: see Kernel::slide. Slip that is spread over more contact keeps its force,
  /// and springs of contact that has ended are lost: friction never adds energy.
  double slide(const EdgeFaceBlocks& blocks, const Kinematics& now, double dt,
               FrictionMemory& memory);

  /// Takes back the last slide of a scene without damping.
  void undo_slide() {
    std::swap(drags_, drags_before_);
    everywhere_ = kBothVectors;
  }
  /// The dashpots of the contacts of the last slide: see Kernel.
  void add_dashpots(const EdgeFaceBlocks& blocks, const Kinematics& now, Dashpots& to);
  void keep_pushes(const EdgeFaceBlocks& blocks, const Dashpots& from, size_t& next,
                   FrictionMemory& memory);

  /// Of springs on a vertex, N.
  [[nodiscard]] Vec2 force(int vertex) const {
    if (drags_.empty()) return {0, 0};
    const VertexDrag& d = drags_[static_cast<size_t>(vertex)];
    return {d[0], d[1]};
  }
  /// Adds to the contacts, which ascend, what acts in them beside the normal force.
  void add_to(const EdgeFaceBlocks& blocks, std::span<EdgeFaceContact> contacts) const;

 private:
  struct Step {
    const EdgeFaceBlocks& blocks;
    double dt;
    bool finite;   ///< see Kinematics
    bool limited;  ///< false: springs keep forces above their limits
  };
  /// What has been found of a unit.
  struct Unit {
    double power = 0;   ///< of its springs on the bodies, W
    double energy = 0;  ///< J
  };
  /// What a thread needs.
  struct Worker {
    std::vector<SlipPull> pulls;  // of the blocks of a unit
    std::vector<Spring> springs;  // of all units, ascending
    /// On vertices that other threads have forces for as well.
    std::vector<std::pair<std::int32_t, VertexDrag>> late;
  };

  [[nodiscard]] double begin(BodyIndex body, const Kinematics& now, const Step& step);
  void find_contacts(const Step& step, const EdgeFaceUnit& unit);
  void find_before(const Step& step, ContactWalk<const Spring> walk);
  void slide_unit(const Step& step, size_t index, Worker& worker, bool divided);
  [[nodiscard]] static double closed_share(const Step& step, const EdgeFaceUnit& unit,
                                           const EdgeFaceGroup& group,
                                           const SpringContact& contact);
  [[nodiscard]] double follow(const Step& step, const EdgeFaceUnit& unit, Worker& worker);
  [[nodiscard]] double pull(const Step& step, const EdgeFaceUnit& unit, Worker& worker,
                            bool divided);
  void find_pairs(const EdgeFaceBlocks& blocks, const Kinematics& now);
  void add_coordinates(const EdgeFaceBlocks& blocks, const EdgeFaceUnit& unit,
                       const EdgeFaceGroup& group, const SpringContact& contact,
                       Dashpots& to) const;
  template <class F>
  void each_dashpot(const EdgeFaceBlocks& blocks, const F& f);

  const Surfaces& surfaces_;
  const PairTable& table_;
  const Outlines& outlines_;
  Threads threads_;
  CommonNormals normals_;
  // For so many steps more bodies that have become inactive may have forces, now or before.
  static constexpr int kBothVectors = 2;
  int everywhere_ = kBothVectors;
  std::vector<BodyIndex> all_;                    // bodies
  std::vector<double> velocities_;                // of the vertices, interleaved
  std::vector<VertexDrag> drags_, drags_before_;  // of the vertices
  std::vector<OutlineSlip> slips_;                // of the blocks
  std::vector<SpringContact> contacts_;           // of the springs: of all groups
  std::vector<double> body_powers_;               // of the forces of the step before, W
  std::vector<Unit> units_;
  /// Two bodies: all that touches, as if they were rigid, for their dashpots.
  struct PairSum {
    BodyIndex a = -1, b = -1;
    Vec2 force = Vec2::Zero();                    // on a, N
    double moment = 0;                            // about the origin, N m
    Vec2 places = Vec2::Zero();                   // of the forces, times their sizes, N m
    double sizes = 0;                             // N
    double resistance = 0, stiffness = 0;         // N/m
    double normal_time = 0, tangential_time = 0;  // s
  };
  std::vector<PairSum> pairs_;
  std::vector<Worker> workers_;
};

}  // namespace apothem
