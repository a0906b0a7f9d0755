// Friction and damping between outlines (docs/theory.md, Friction and damping). For every edge and
// every body that it touches there is a spring across the common normal of its neighbourhood
// (common_normals.hpp), with a dashpot beside it, which together obey Coulomb's limit, and a
// dashpot along this normal, which never pulls. They act on the edge and on the feet of its points
// on the faces, where the pressure is.
#pragma once

#include <span>
#include <vector>

#include "lib/contact/law/damping_times.hpp"
#include "lib/contact/law/friction_memory.hpp"
#include "lib/contact/law/kinematics.hpp"
#include "lib/contact/law/pair_table.hpp"
#include "lib/contact/mesh/common_normals.hpp"
#include "lib/contact/mesh/edge_face_blocks.hpp"
#include "lib/contact/mesh/outline_slip.hpp"
#include "lib/contact/surface/outlines.hpp"
#include "lib/execution/parallel.hpp"

namespace apothem {

class OutlineFriction {
 public:
  /// `inverse_mass` of each body, 1/kg. All must outlive this object.
  OutlineFriction(const Outlines& outlines, const PairTable& table,
                  const std::vector<double>& inverse_mass, int threads);

  /// See Kernel.
  void limit_damping(std::span<const double> node_mass, double thickness);
  /// After a search: the pairs of bodies that may touch.
  void take(std::span<const BoxPair> pairs) {
    times_.take(pairs);
    everywhere_ = kBothVectors;
    block_drags_.clear();
  }
  /// Index of two of them: see EdgeFaceLaw.
  [[nodiscard]] int bodies(BodyIndex a, BodyIndex b) const { return times_.index(a, b); }

  /// One step further: see Kernel::slide. Slip that is spread over more contact keeps its force,
  /// and springs of contact that has ended are lost: friction never adds energy.
  double slide(const EdgeFaceBlocks& blocks, const Kinematics& now, double dt,
               FrictionMemory& memory);

  void fields(Archive& archive);
  /// Takes back the last slide of a scene without damping.
  void undo_slide() {
    std::swap(drags_, drags_before_);
    everywhere_ = kBothVectors;
  }

  /// Of springs and dashpots on a vertex, N.
  [[nodiscard]] Vec2 force(int vertex) const {
    if (drags_.empty()) return {0, 0};
    const VertexDrag& d = drags_[static_cast<size_t>(vertex)];
    return {d[0] + d[2], d[1] + d[3]};
  }
  /// In the contacts of a block: friction with the dashpot beside it, and the dashpot along the
  /// normal, on the body of the edge, N.
  struct BlockDrag {
    EdgeFaceBlock::Numbers drag_x, drag_y, push_x, push_y;
  };
  [[nodiscard]] const std::vector<BlockDrag>& drags() const { return block_drags_; }

 private:
  struct Step {
    const EdgeFaceBlocks& blocks;
    std::span<const Spring> before;  ///< the springs of the step before
    double dt;
    bool finite;    ///< see Kinematics
    bool dashpots;  ///< whether there are any
    bool limited;   ///< false: springs keep forces above their limits
  };
  /// Of the forces of springs and dashpots on the bodies, W.
  struct Powers {
    double friction = 0, damping = 0;
  };
  /// What has been found of a unit.
  struct Unit {
    Powers powers;
    double energy = 0;  ///< of its springs, J
  };
  /// What a thread needs.
  struct Worker {
    std::vector<SlipPull> pulls;   // of the blocks of a unit
    std::vector<SlipPush> pushes;  // likewise
    std::vector<Spring> springs;   // of all units, ascending
    /// On vertices that other threads have forces for as well.
    std::vector<std::pair<std::int32_t, VertexDrag>> late;
  };

  Powers begin(BodyIndex body, const Kinematics& now, const Step& step);
  void find_contacts(const Step& step, const EdgeFaceUnit& unit);
  void find_before(const Step& step);
  void find_times(const Step& step);
  void slide_unit(const Step& step, size_t index, Worker& worker, bool divided);
  [[nodiscard]] double resistance(const Step& step, const EdgeFaceUnit& unit,
                                  const EdgeFaceGroup& group, const SpringContact& contact) const;
  [[nodiscard]] static double closed_share(const Step& step, const EdgeFaceUnit& unit,
                                           const EdgeFaceGroup& group,
                                           const SpringContact& contact);
  [[nodiscard]] double follow(const Step& step, const EdgeFaceUnit& unit, Worker& worker) const;
  [[nodiscard]] Powers pull(const Step& step, const EdgeFaceUnit& unit, Worker& worker,
                            bool divided);

  const Outlines& outlines_;
  bool damped_;
  Threads threads_;
  DampingTimes times_;
  CommonNormals normals_;
  // For so many steps more bodies that have become inactive may have forces, now or before.
  static constexpr int kBothVectors = 2;
  int everywhere_ = kBothVectors;
  std::vector<BodyIndex> all_;                    // bodies
  std::vector<double> velocities_;                // of the vertices, interleaved
  std::vector<VertexDrag> drags_, drags_before_;  // of the vertices
  std::vector<BlockDrag> block_drags_;
  struct LawTimes {
    double normal, tangential;  // s
  };
  std::vector<LawTimes> law_times_;
  std::vector<OutlineSlip> slips_;       // of the blocks
  std::vector<SpringContact> contacts_;  // of the springs: of all groups
  std::vector<double> resistances_;      // likewise: stiffness along the normal, N/m
  std::vector<Powers> body_powers_;      // of the forces of the step before
  std::vector<Unit> units_;
  std::vector<Worker> workers_;
};

}  // namespace apothem
